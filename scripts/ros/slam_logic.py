"""What the node `slam` does: the map, where the odometry's frame is on it, and how well the robot's place is known."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...perception.config import perception_preset
from ...perception.filtered_logs.scan_filter import ScanFilter
from ...slam.bounds import check_numbers, check_positive
from ...slam.engine import make_slam
from ...slam.geometry import compose, inverse
from ...slam.logs.ros_messages import pose_with_covariance
from ...slam.logs.viewer_recording import MAP
from .live_scans import InputConfig, LiveScan, LiveScans
from .outputs import MadeMessages, Maker, Output

GRID, TRANSFORMS = "nav_msgs/msg/OccupancyGrid", "tf2_msgs/msg/TFMessage"
POSE = "geometry_msgs/msg/PoseWithCovarianceStamped"


@dataclass(frozen=True, kw_only=True)
class SlamNodeConfig(InputConfig):
    """Parameters of the node `slam`.

    Attributes:
        method: SLAM engine: "cartographer", "gmapping" or "ekf".
        filter_people: Whether people are taken out of the scans first.
        preset: Numbers of the tracker, as of `tagalong filter --preset`.
        forest: Leg forest: "real", "simulation" or a file.
        map_every_s: Time between two maps [s].
        ahead_s: How far the transform from map to odometry is dated ahead of the scan that it is of, so that it holds
            until the next one [s].
    """

    method: str = "cartographer"
    filter_people: bool = True
    preset: str = "recorded"
    forest: str = "real"
    map_every_s: float = 2.0
    ahead_s: float = 0.2

    def __post_init__(self) -> None:
        super().__post_init__()
        check_numbers(self)
        check_positive(self, "map_every_s")


class SlamLogic:
    """Sends the map, the transform from its frame to the odometry's, as REP 105 has it, and the pose with a covariance.

    A pose is sent while the engine knows where on its map the robot is: who fuses poses must not get others. The map's
    frame is the robot's first pose, as everywhere here.

    Args:
        maker: Of messages.
        config: Parameters.
    """

    def __init__(self, maker: Maker, config: SlamNodeConfig) -> None:
        self.outputs = {"/tf": TRANSFORMS, "map": GRID, "pose": POSE}
        self._config, self._messages, self._scans = config, MadeMessages(maker), LiveScans(config)
        people = replace(perception_preset(config.preset), forest=config.forest)
        self._filter = ScanFilter(people) if config.filter_people else None
        self._engine = make_slam(config.method)
        self._map_s = -np.inf

    def take(self, source: str, message: Any, now_s: float) -> list[Output]:
        """Take a message; return what each scan that is ready gives."""
        ready = self._scans.take(source, message, now_s)
        return [output for live in ready for output in self._send(live)]

    def tick(self, now_s: float) -> list[Output]:
        """Send nothing: the clock does not matter here."""
        return []

    def notes(self) -> list[str]:
        """Return what the scans have shown of the laser since the last call."""
        return self._scans.notes()

    def _send(self, live: LiveScan) -> list[Output]:
        scan = live.scan
        if self._filter is not None:
            scan = self._filter.update(scan, live.odometry).without_people
        update = self._engine.update(live.odometry, scan)
        T_map_odom = compose(update.pose, inverse(live.T_odom_robot))
        frames = (MAP, self._scans.odom_frame)
        sent = [Output("/tf", self._messages.transform(T_map_odom, scan.time_s + self._config.ahead_s, frames))]
        if update.located and update.covariance is not None:
            sent.append(
                Output("pose", pose_with_covariance(self._messages, update.pose, update.covariance, scan.time_s, MAP))
            )
        if scan.time_s >= self._map_s + self._config.map_every_s:
            self._map_s = scan.time_s
            sent.append(Output("map", self._messages.map(self._engine.live_map(), scan.time_s, MAP)))
        return sent
