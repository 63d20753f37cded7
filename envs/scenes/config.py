"""Which building an environment stands in."""

import os
from dataclasses import dataclass

from ..limits.field_checks import check_fields
from .catalogue import check_scene_name
from .request import SceneMaker


@dataclass(frozen=True, kw_only=True)
class SceneConfig:
    """The building, drawn anew in each episode.

    Attributes:
        scene: Its kind: "corridor", "floor_plan", "lab", "landmarks", "meeting_room", "office" or "plain_corridor"; or
            one of Follow-Bench's situations: "narrow_corridor", "doorway", "intersection", "clutter"; one of the hard
            ones: "tight_office", "narrow_doors", "tight_doorway", "wide_corridor", "busy_crossing", "packed_clutter";
            or a function that draws a building of one's own, see `tagalong.envs.scenes`.
        split: Of which half offices are drawn: "train" or "test"; no building of one is ever in the other.
        floor_plan: File `map.yaml` of a ROS map for the scene "floor_plan"; None takes a built-in plan.
        walking_paths: File of recorded walks (`frame id x y` or the `obsmat` form of the ETH and UCY recordings, plain
            or gzip); bystanders walk as in it. None leaves them to the scene.
    """

    scene: str | SceneMaker = "corridor"
    split: str = "train"
    floor_plan: str | os.PathLike[str] | None = None
    walking_paths: str | os.PathLike[str] | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        check_scene_name(self.scene)
