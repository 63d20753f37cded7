"""One safety filter for every follower: what could not be stopped in time, and would touch something, is not driven."""

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.errors import InputError
from ..protocol.follower import Follower, Observation
from ..scripted.scan_points import as_action, leader_row
from .guard import Guard, GuardConfig
from .steering import SteeringConfig

STEERING = SteeringConfig(
    max_speed=1.3, reverse_speed=1.3, max_turn_rate=2.0, settle_s=0.1, turn_settle_s=0.1, acceleration=2.0,
    braking=2.0, turn_acceleration=8.0, jerk=1e3, brake_jerk=1e3, turn_jerk=1e3, wish_s=0.0,
)  # fmt: skip
"""How commands are driven by the robot itself: its limits of acceleration, none of jerk."""


class Guarded:
    """A follower whose actions pass the guard of `agents.learned.guard`; else they are its own, to the bit.

    Args:
        follower: Who drives.
        interface: Scales of the environment.
        config: What is guarded.
    """

    def __init__(self, follower: Follower, interface: FollowInterface, config: GuardConfig | None = None) -> None:
        self.follower, self._interface = follower, interface
        self._guard = Guard(config or GuardConfig(), STEERING, interface)
        self.reset()

    def reset(self) -> None:
        """Forget everything; call it before each episode."""
        self.follower.reset()
        self._guard.reset()
        self._driven = (0.0, 0.0)

    def act(self, observation: Observation) -> NDArray[np.float32]:
        """Return the follower's action, or the nearest that can be stopped in time.

        Raises:
            InputError: If the follower drives sideways, which the filter cannot judge, or nobody leads.
        """
        leader_row(observation)
        self._guard.observe(observation)
        action = self.follower.act(observation)
        if len(action) == 3 and action[1] != 0.0:
            raise InputError("the safety filter cannot judge this follower: it drives sideways")
        speed, turn = float(action[0]) * self._interface.max_speed, float(action[-1]) * self._interface.max_turn_rate
        limited = self._guard.limit((self._driven[0], 0.0, self._driven[1], 0.0), (speed, turn))
        self._driven = limited
        return action if limited == (speed, turn) else as_action(*limited, self._interface)
