"""Between an environment and a network: features before it; what keeps it from harm behind it; one episode long."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ..protocol.follower import Observation
from ..scripted.scan_points import as_action
from .detour import Detour, DetourConfig, NoDetour
from .features import FeatureConfig, Features
from .guard import Guard, GuardConfig, NoGuard
from .keep_up import KeepUp, KeepUpConfig, NoKeepUp
from .situation import Situation
from .steering import REST, SteeringConfig, steer
from .swerve import NoSwerve, Swerve, SwerveConfig

Floats = NDArray[np.float32]


@dataclass(frozen=True, kw_only=True)
class PilotConfig:
    """What the network is told and how its wishes are driven.

    Attributes:
        features: What it is told.
        steering: How its wishes are driven.
        guard: What is not driven whatever is wished; None for no guard.
        keep_up: What is wished at least while the leader gets away; None for no such thing. Like the next two it
            needs a guard.
        detour: When the network is relieved; None for never.
        swerve: How wishes that would touch something are changed in time; None for not before the guard does.
    """

    features: FeatureConfig = field(default_factory=FeatureConfig)
    steering: SteeringConfig = field(default_factory=SteeringConfig)
    guard: GuardConfig | None = field(default_factory=GuardConfig)
    keep_up: KeepUpConfig | None = field(default_factory=KeepUpConfig)
    detour: DetourConfig | None = field(default_factory=DetourConfig)
    swerve: SwerveConfig | None = field(default_factory=SwerveConfig)


class Pilot:
    """Features, guard, steering and the like of one episode; training and driving use the same.

    Args:
        config: All of them.
        interface: Scales of the environment.
    """

    def __init__(self, config: PilotConfig, interface: FollowInterface) -> None:
        self.config, self._interface = config, interface
        self._features = Features(config.features, interface)
        self._guard = Guard(config.guard, config.steering, interface) if config.guard is not None else NoGuard()
        self._keep_up: KeepUp | NoKeepUp = NoKeepUp()
        self._detour: Detour | NoDetour = NoDetour()
        self._swerve: Swerve | NoSwerve = NoSwerve()
        if config.guard is not None:
            self._make_escape(config, config.guard)
        self.reset()

    def _make_escape(self, config: PilotConfig, guard: GuardConfig) -> None:
        """Take what is only safe with a guard."""
        if config.keep_up is not None:
            self._keep_up = KeepUp(config.keep_up)
        if config.detour is not None:
            self._detour = Detour(config.detour, config.steering, self._interface)
        if config.swerve is not None:
            self._swerve = Swerve(config.swerve, guard, config.steering, self._interface)

    def reset(self) -> None:
        """Forget the last episode; stand."""
        self._features.reset()
        self._guard.reset()
        self._detour.reset()
        self._people = np.zeros((0, 6))
        self.commanded = REST
        self._wish = (0.0, 0.0)

    def inputs(self, observation: Observation) -> dict[str, Floats]:
        """Return the inputs of the network for an observation; once a step."""
        self._guard.observe(observation)
        self._people = observation["people"].astype(np.float64)
        return self._features.update(observation, self.commanded)

    def drive(self, output: Sequence[float] | Floats) -> Floats:
        """Return the environment's action for an output (2,) of the network in [-1, 1]; once a step."""
        steering, step_s = self.config.steering, 1.0 / self._interface.control_hz
        situation = self._situation()
        wish = steering.wish((float(output[0]), float(output[1])))
        wish = steering.clipped(*self._keep_up.keep_pace(wish, situation))
        part = step_s / (step_s + steering.wish_s)
        self._wish = (
            self._wish[0] + part * (wish[0] - self._wish[0]),
            self._wish[1] + part * (wish[1] - self._wish[1]),
        )
        wish = self._swerve.avoid(self._wish, situation)
        wish = self._detour.escape(wish, situation)
        speed, turn = self._guard.limit(self.commanded, wish)
        self.commanded = steer(self.commanded, speed, turn, step_s, steering)
        return as_action(self.commanded[0], self.commanded[2], self._interface)

    def _situation(self) -> Situation:
        f, guard = self._features, self._guard
        return Situation(self.commanded, f.goal, f.search_turn, f.trail, guard.things, self._people, guard.room_behind)
