"""What compiled worlds with trackers compile together at the first use: sweeps, and who reads them."""

import numpy as np

from ...slam.processes.turns import turns
from .episodes import BEGIN_AGAIN, REST, judge_worlds, sweep_worlds
from .pool import EpisodePool
from .rules import compiled_config, make_rules
from .state import nothing_told, scratch, state_with_room
from .trackers import Trackers


def sweep() -> None:
    """Begin an episode in a world, take a sweep that nobody reads, and judge it."""
    config = compiled_config({"scene": "office", "people": "tracker"})
    pool, rules = EpisodePool(config, 1, 1, 0, [{}]), make_rules(config, 0, 1)
    pool.draw_ahead()
    people, beams = pool.plans.radius.shape[1], config.sensors.lidar.beams
    state, what = state_with_room(1, people, pool.plans.leaves.shape[1]), np.array([BEGIN_AGAIN], np.int8)
    told = nothing_told(1, beams, config.observation.people_slots, 2, read=True)
    sweep_worlds(turns(1), what, np.zeros((1, 2)), rules, pool.plans, state, told, scratch(rules.ticks, beams, people))
    judge_worlds(turns(1), what, rules, pool.plans, state, told)


def read_sweep() -> None:
    """Let a world's robot read its sweep; it rests, and there is none."""
    config = compiled_config({"people": "tracker"})
    told = nothing_told(1, config.sensors.lidar.beams, config.observation.people_slots, 2, read=True)
    Trackers(config, 1).read(turns(1), np.array([REST], np.int8), state_with_room(1, 1, 0), told)
