"""A network that drives: pooled observation in, wish out, past the safety filter, with limited jerk."""

import os
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...envs.wrappers.pooled_features import PooledFeatures
from ..learned.guard import Guard, GuardConfig, NoGuard
from ..learned.known_beams import KnownBeams
from ..learned.steering import REST, steer
from ..protocol.follower import Observation
from ..scripted.scan_points import as_action
from .policy import DenseNetwork, load_reinforced


class ReinforcedFollower:
    """Drives by a reinforced network's wishes; sees only what the robot perceives.

    Args:
        interface: Scales of the environment.
        policy: Name of a shipped policy, or a folder that `tagalong train follower` wrote.
        guarded: Whether its wishes pass the safety filter, which stops before a certain contact; None: as in training.

    Raises:
        InputError: If there is no such policy, or it does not fit this program.
    """

    def __init__(
        self,
        interface: FollowInterface | None = None,
        policy: str | os.PathLike[str] = "reinforced",
        guarded: bool | None = None,
    ) -> None:
        arrays, config = load_reinforced(policy)
        self._interface = interface or FollowInterface()
        self._beams = KnownBeams(self._interface, config.field_of_view, config.pooled.sectors)
        self._steering, self._network = config.steering, DenseNetwork(arrays)
        self._features = PooledFeatures(config.pooled, replace(self._beams.interface, holonomic=False))
        self._scales = np.array((config.max_speed, config.max_turn_rate))
        wears = config.guard is not None if guarded is None else guarded
        guard = config.guard or GuardConfig()
        self._guard = Guard(guard, config.steering, self._interface) if wears else NoGuard()
        self.reset()

    def reset(self) -> None:
        """Forget everything; call it before each episode."""
        self._guard.reset()
        self._commanded, self._begun = REST, False

    def act(self, observation: Observation) -> NDArray[np.float32]:
        """Return the action (forward, turn), or (forward, 0, turn) for a holonomic robot, each in [-1, 1]."""
        self._guard.observe(observation)
        wish = self._steering.wish(tuple(self._network(self._told(observation)).tolist()))
        speed, turn = self._guard.limit(self._commanded, wish)
        self._commanded = steer(self._commanded, speed, turn, 1.0 / self._interface.control_hz, self._steering)
        return as_action(self._commanded[0], self._commanded[2], self._interface)

    def _told(self, observation: Observation) -> NDArray[np.float32]:
        """Return the network's inputs; a holonomic robot is told as one that does not drive sideways."""
        batch = {name: observation[name][None] for name in ("leader", "people")}
        batch["scan"] = self._beams.scan(observation)[None]
        batch["velocity"] = observation["velocity"][None, [0, -1]]
        if not self._begun:
            self._begun = True
            return self._features.begin(batch)[0]
        action = np.array((self._commanded[0], self._commanded[2])) / self._scales
        return self._features.update(batch, action.astype(np.float32)[None])[0]
