"""People taken out of scans, one after the other, as of any recorded drive; here of a simulated one."""

import numpy as np
from tagalong.envs import World, WorldConfig
from tagalong.perception import PeopleFilter, PeopleFilterConfig

world = World(WorldConfig(scene="meeting_room", people=3), np.random.default_rng(0))
people_filter = PeopleFilter(PeopleFilterConfig(forest="simulation"))  # "real", the default, for real lasers
for step in range(60):
    world.step((0.3, 0.0))
    filtered = people_filter.update(world.scan(), world.odometry)
    if step % 20 == 19:
        removed = int(filtered.removed.sum())
        print(f"{world.time_s:4.1f} s: {len(filtered.people)} people tracked, {removed} returns removed")
