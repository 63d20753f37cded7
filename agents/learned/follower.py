"""A follower that was learned: a shipped policy, or one from a folder that `tagalong train follower` wrote."""

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.errors import InputError
from ...slam.files.input import named
from ...slam.files.output import read_arrays, read_json
from ..protocol.follower import Observation
from .network import Network
from .network_shapes import check_arrays
from .pilot import Pilot, PilotConfig
from .policy_card import pilot_config

SHIPPED = Path(__file__).parents[1] / "models"
"""Where the shipped policies are."""


class LearnedFollower:
    """Drives by a network's wishes; sees only what the robot perceives.

    Args:
        interface: Scales of the environment.
        policy: Name of a shipped policy, or a folder with `policy.npz` and `policy.json`.

    Raises:
        InputError: If there is no such policy, or it does not fit this program.
    """

    def __init__(self, interface: FollowInterface | None = None, policy: str | Path = "follower") -> None:
        arrays, config = load_policy(policy)
        self._network = Network(arrays)
        self._pilot = Pilot(config, interface or FollowInterface())

    def reset(self) -> None:
        """Forget everything; call it before each episode."""
        self._network.reset()
        self._pilot.reset()

    def act(self, observation: Observation) -> NDArray[np.float32]:
        """Return the action (forward, turn), or (forward, 0, turn) for a holonomic robot, each in [-1, 1]."""
        return self._pilot.drive(self._network(self._pilot.inputs(observation)))


def load_policy(policy: str | Path) -> tuple[dict[str, NDArray[np.float32]], PilotConfig]:
    """Return the arrays of a policy and what surrounds it.

    Args:
        policy: As of `LearnedFollower`.

    Raises:
        InputError: If a file is missing or does not fit.
    """
    stem = Path(policy) / "policy" if os.path.isdir(policy) else SHIPPED / policy
    weights, card = (f"{os.fspath(stem)}{suffix}" for suffix in (".npz", ".json"))
    if not (os.path.isfile(weights) and os.path.isfile(card)):
        shipped = ", ".join(sorted(path.stem for path in SHIPPED.glob("*.npz")))
        raise InputError(
            f"a policy is a shipped one ({shipped}) or a folder with policy.npz, policy.json; got {named(policy)}"
        )
    content, arrays = read_json(card), read_arrays(weights)
    try:
        if not isinstance(content, dict) or "pilot" not in content:
            raise ValueError("`pilot` is missing in its card")
        config = pilot_config(content["pilot"])
        check_arrays(arrays, config.features.shapes)
    except ValueError as error:
        raise InputError(f"the policy {named(weights)} does not fit this program: {error}") from error
    return arrays, config
