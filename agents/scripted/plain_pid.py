"""The follower of the paper and nothing else: two PID controllers that know nothing of each other (Ye et al., II-C)."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.errors import InputError
from ..protocol.follower import Observation
from .pid_axis import Axis, AxisConfig
from .scan_points import as_action, leader_row


@dataclass(frozen=True, kw_only=True)
class PlainPIDConfig:
    """Gains; those of `PIDConfig`, so that the two differ by what surrounds them alone.

    Attributes:
        distance: Distance kept from the leader, centre to centre [m].
        linear: Gains from the error of the distance [m] to forward speed [m/s].
        angular: Gains from the bearing [rad] to turn rate [rad/s].
    """

    distance: float = 1.3
    linear: AxisConfig = field(default_factory=lambda: AxisConfig(proportional=1.2, integral=0.1, derivative=0.1))
    angular: AxisConfig = field(default_factory=lambda: AxisConfig(proportional=1.8, derivative=0.1))

    def __post_init__(self) -> None:
        if not self.distance > 0.0:
            raise InputError(f"`distance` must be positive [m], got {self.distance}")


class PlainPIDFollower:
    """Keeps a fixed distance; angular and linear velocity are controlled independently.

    It sees no obstacles, limits no acceleration and remembers no leader: out of sight, it goes by where the tracker
    takes the leader to be. `PIDFollower` is the same with avoidance, memory, feed-forward and limits.
    """

    def __init__(self, interface: FollowInterface | None = None, config: PlainPIDConfig | None = None) -> None:
        self._interface = interface or FollowInterface()
        self.config = config or PlainPIDConfig()
        step_s = 1.0 / self._interface.control_hz
        self._linear, self._angular = Axis(self.config.linear, step_s), Axis(self.config.angular, step_s)

    def reset(self) -> None:
        """Forget everything; call it before each episode."""
        self._linear.reset()
        self._angular.reset()

    def act(self, observation: Observation) -> NDArray[np.float32]:
        """Return the action (forward, turn), or (forward, 0, turn) for a holonomic robot, each in [-1, 1]."""
        x, y, *_ = leader_row(observation)
        if x == 0.0 and y == 0.0:  # nobody was chosen yet
            return as_action(0.0, 0.0, self._interface)
        speed = self._linear.update(float(np.hypot(x, y)) - self.config.distance)
        return as_action(speed, self._angular.update(float(np.arctan2(y, x))), self._interface)
