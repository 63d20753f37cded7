"""How the robot of an environment perceives people and maps, where it is not its SLAM engine's own business."""

from dataclasses import dataclass

from ...perception.config import PerceptionConfig
from ...perception.legs.detector import LegDetectorConfig
from ...slam.errors import unknown_name
from ..limits.field_checks import check_fields

FAR_WIDTH_M = 0.12
"""A cluster needs as many points as a leg of this width gets beams, 2 or 3, by distance and spacing of the beams: 2
from 3.1 m on with 360 beams, from 9.2 m on with 1081. What that gains: `tagalong bench recall-by-distance`."""

PERCEPTION = PerceptionConfig(forest="simulation", detector=LegDetectorConfig(far_width=FAR_WIDTH_M))
"""How the robot of the environments perceives people."""

MAPS = ("occupancy", "immobile")


@dataclass(frozen=True, kw_only=True)
class MappingConfig:
    """What the robot's map is made of.

    Attributes:
        map: What it holds: "occupancy", or "immobile" area by laser and camera, which needs `slam`.
        filter_people: Whether people are taken out of the scans before they reach SLAM and map. False gives them the
            raw scans, as the comparison of Ye 2021 does.
    """

    map: str = "occupancy"
    filter_people: bool = True

    def __post_init__(self) -> None:
        check_fields(self)
        if self.map not in MAPS:
            raise unknown_name("mapping", self.map, MAPS)
