"""A follower that was learned: a shipped policy, or one from a folder that `tagalong train follower` wrote."""

import json
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...envs.interface import FollowInterface
from ...slam.errors import InputError
from ...slam.files import read_arrays
from ..follower import Observation
from .detour import DetourConfig
from .features import FeatureConfig
from .guard import GuardConfig
from .keep_up import KeepUpConfig
from .network import Network, check_arrays
from .pilot import Pilot, PilotConfig
from .steering import SteeringConfig
from .swerve import SwerveConfig

Part = TypeVar("Part", GuardConfig, KeepUpConfig, DetourConfig, SwerveConfig)
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
    folder = Path(policy)
    weights, card = folder / "policy.npz", folder / "policy.json"
    if not folder.is_dir():
        weights, card = SHIPPED / f"{policy}.npz", SHIPPED / f"{policy}.json"
    if not (weights.is_file() and card.is_file()):
        shipped = ", ".join(sorted(path.stem for path in SHIPPED.glob("*.npz")))
        raise InputError(
            f"a policy is a shipped one ({shipped}) or a folder with policy.npz, policy.json; got {policy}"
        )
    arrays = read_arrays(weights)
    try:
        check_arrays(arrays)
        return arrays, pilot_config(json.loads(card.read_text(encoding="utf-8"))["pilot"])
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"the policy {weights} does not fit this program: {error}") from error


def pilot_config(fields: dict[str, Any]) -> PilotConfig:
    """Return the configuration that `dataclasses.asdict` made `fields` of."""
    return PilotConfig(
        features=FeatureConfig(**fields["features"]),
        steering=SteeringConfig(**fields["steering"]),
        guard=_part(GuardConfig, fields["guard"]),
        keep_up=_part(KeepUpConfig, fields.get("keep_up")),
        detour=_part(DetourConfig, fields.get("detour")),
        swerve=_part(SwerveConfig, fields.get("swerve")),
    )


def _part(kind: type[Part], fields: dict[str, Any] | None) -> Part | None:
    return None if fields is None else kind(**_with_tuples(fields))


def _with_tuples(fields: dict[str, Any]) -> dict[str, Any]:
    return {name: tuple(value) if isinstance(value, list) else value for name, value in fields.items()}
