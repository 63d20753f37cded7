"""The real onboard stack behind compiled worlds: leg detector, tracker and choice of the leader, world by world.

The very classes of the single environment. They are Python between kernels: a scan takes ten times as long as all
else of a step, and threads share little of it.
"""

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ...slam.scan import LaserScan
from ..episode_setup import OnboardStackFactory
from ..follow_config import FollowConfig
from ..onboard.stack import OnboardStack
from ..task.observation import leader_entry, people_entry
from .episodes import REST, STEP
from .state import Told, WorldsState

_DRAWS = 0x7AC8  # sets the draws of the leaders' clouds apart from those of episodes


class Trackers:
    """One onboard stack for each world, fresh in each episode.

    Args:
        config: Of the environment; people are known by "tracker", nothing maps, there is no camera.
        worlds: How many.
    """

    def __init__(self, config: FollowConfig, worlds: int) -> None:
        self._stacks = OnboardStackFactory(config)
        self._lidar, self._slots = config.sensors.lidar, config.observation.people_slots
        self._of: list[OnboardStack | None] = [None] * worlds

    def update(self, what: NDArray[np.int8], state: WorldsState, told: Told) -> None:
        """Let the robots of all worlds that did `what` (w,) read their sweeps; write what they know into `told`."""
        for w in np.flatnonzero(what != REST).tolist():
            stack = self._of[w]
            if stack is None or what[w] != STEP:
                stack = self._of[w] = self._fresh(int(state.seed[w]), int(state.episode[w]))
            self._read(w, stack, state, told)

    def _fresh(self, seed: int, episode: int) -> OnboardStack:
        nothing_true = cast(Any, None)  # the stack asks the world for the truth only, which this one does without
        return self._stacks.make(nothing_true, np.random.default_rng([_DRAWS, seed, episode]))

    def _read(self, w: int, stack: OnboardStack, state: WorldsState, told: Told) -> None:
        lidar = self._lidar
        scan = LaserScan(
            told.ranges[w].copy(), lidar.bearings, lidar.range_min, lidar.range_max, float(told.time_s[w]), lidar.mount
        )
        belief = stack.update(scan, state.odometry[w].copy())
        told.leader[w] = leader_entry(belief)
        told.people[w] = people_entry(belief.people_robot, belief.leader_id, self._slots)
        told.tracked[w], told.track[w] = len(belief.people), belief.leader_id
