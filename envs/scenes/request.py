"""What is asked of a scene beyond its kind."""

import os
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...slam.errors import InputError, unknown_name
from ..limits.field_checks import check_fields
from .scene import Scene

SPLITS = ("train", "test")
"""Halves of the drawn buildings: no building of one is ever in the other."""


class NoRoomError(InputError):
    """A building, as it was drawn, has no room for the tour or the people asked for; another one may have."""


@dataclass(frozen=True, kw_only=True)
class SceneRequest:
    """What is asked of a scene; kinds of scenes without such a choice ignore it.

    Attributes:
        route: Name of the tour; None draws one.
        split: Of which half offices are drawn: "train" or "test".
        floor_plan: File `map.yaml` of a ROS map for the scene "floor_plan"; None takes the built-in plan.
    """

    route: str | None = None
    split: str = "train"
    floor_plan: str | os.PathLike[str] | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        if self.split not in SPLITS:
            raise unknown_name("split", self.split, SPLITS)


SceneMaker = Callable[[np.random.Generator, SceneRequest], Scene]
"""What draws a building: a function of the source of all draws and of what is asked for."""
