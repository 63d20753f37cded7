"""A building of one's own: a hall with a row of pillars, drawn anew in each episode."""

import gymnasium as gym
import numpy as np
import tagalong  # noqa: F401 (registers the environments)
from tagalong.envs.scenes import Scene, post, room, rounded


def hall(rng, request):
    """A hall of 16 to 20 x 5 m with pillars along one side, and a tour in a gentle bend."""
    long = rng.uniform(16.0, 20.0)
    pillars = [post("pillar", x, -1.7, radius=0.25, top=2.5) for x in np.arange(3.0, long - 2.0, 3.0)]
    return Scene(
        name="hall",
        solids=(*room((0.0, -2.5), (long, 2.5)), *pillars),
        floor=np.array([(0.0, -2.5), (long, -2.5), (long, 2.5), (0.0, 2.5)]),
        routes={"along": rounded([(1.0, 0.0), (0.5 * long, 0.8), (long - 1.0, 0.0)], radius=2.0)},
        route_name="along",
        half_width=1.0,  # so much room is there on both sides of the tour [m]
    )


env = gym.make("tagalong/Corridor-v0", scene=hall, slam=None, people="truth")
for seed in range(2):
    env.reset(seed=seed)
    for _ in range(20):
        *_, info = env.step([0.3, 0.0])
    tour = env.unwrapped.world.scene.tour_length
    print(f"hall {seed}: a tour of {tour:.1f} m; the leader is {info['leader_distance']:.2f} m away after 2 s")
env.close()
