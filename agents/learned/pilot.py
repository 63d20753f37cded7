"""Between an environment and a network: features before it; detour, guard and steering behind; one episode long."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...envs.interface import FollowInterface
from ..follower import Observation
from ..scan_points import as_action
from .detour import Detour, DetourConfig, NoDetour
from .features import FeatureConfig, Features
from .guard import Guard, GuardConfig, NoGuard
from .steering import REST, SteeringConfig, steer

Floats = NDArray[np.float32]


@dataclass(frozen=True, kw_only=True)
class PilotConfig:
    """What the network is told and how its wishes are driven.

    Attributes:
        features: What it is told.
        steering: How its wishes are driven.
        guard: What is not driven whatever is wished; None for no guard.
        detour: When the network is relieved; None for never. It needs a guard.
    """

    features: FeatureConfig = field(default_factory=FeatureConfig)
    steering: SteeringConfig = field(default_factory=SteeringConfig)
    guard: GuardConfig | None = field(default_factory=GuardConfig)
    detour: DetourConfig | None = field(default_factory=DetourConfig)


class Pilot:
    """Features, guard and steering of one episode; training and driving use the same.

    Args:
        config: All three.
        interface: Scales of the environment.
    """

    def __init__(self, config: PilotConfig, interface: FollowInterface) -> None:
        self.config, self._interface = config, interface
        self._features = Features(config.features, interface)
        self._guard = Guard(config.guard, config.steering, interface) if config.guard is not None else NoGuard()
        self._detour: Detour | NoDetour = NoDetour()
        if config.guard is not None and config.detour is not None:
            self._detour = Detour(config.detour, config.guard, config.steering, 1.0 / interface.control_hz)
        self.reset()

    def reset(self) -> None:
        """Forget the last episode; stand."""
        self._features.reset()
        self._guard.reset()
        self._detour.reset()
        self.commanded = REST
        self._wish = (0.0, 0.0)

    def inputs(self, observation: Observation) -> dict[str, Floats]:
        """Return the inputs of the network for an observation; once a step."""
        self._guard.look(observation)
        return self._features.update(observation, self.commanded)

    def drive(self, output: Sequence[float] | Floats) -> Floats:
        """Return the environment's action for an output (2,) of the network in [-1, 1]; once a step."""
        steering, step_s = self.config.steering, 1.0 / self._interface.control_hz
        wish = steering.wish((float(output[0]), float(output[1])))
        part = step_s / (step_s + steering.wish_s)
        self._wish = (
            self._wish[0] + part * (wish[0] - self._wish[0]),
            self._wish[1] + part * (wish[1] - self._wish[1]),
        )
        f, things = self._features, self._guard.things
        wish = self._detour.relieve(self.commanded, self._wish, f.goal, f.search_turn, f.trail, things)
        speed, turn = self._guard.allow(self.commanded, wish)
        self.commanded = steer(self.commanded, speed, turn, step_s, steering)
        return as_action(self.commanded[0], self.commanded[2], self._interface)
