"""What the robot of an environment measures with."""

from dataclasses import dataclass, field

from ..limits.arguments import branch
from ..limits.field_checks import check_fields
from ..robot.odometry import QUALITIES, OdometryConfig
from .camera.config import RgbdConfig
from .lidar import LidarConfig

CAMERAS: dict[str | None, RgbdConfig | None] = {"kinect-v2": RgbdConfig(), None: None}
"""Name -> RGB-D camera."""


@dataclass(frozen=True, kw_only=True)
class SensorsConfig:
    """The robot's sensors.

    Attributes:
        lidar: The laser scanner.
        camera: The RGB-D camera, "kinect-v2" or its configuration; None for none.
        odometry: Errors of the wheel odometry: "perfect", "good", "typical", "slipping", or their numbers.
    """

    lidar: LidarConfig = field(default=LidarConfig(), metadata=branch())
    camera: RgbdConfig | None = field(default=None, metadata=branch(choices=CAMERAS, title="camera"))
    odometry: OdometryConfig = field(
        default=QUALITIES["typical"], metadata=branch(choices=QUALITIES, title="odometry quality")
    )

    def __post_init__(self) -> None:
        check_fields(self)
