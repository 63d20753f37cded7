"""What the nodes `filter` and `people` do: people out of scans, and where the people are."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...perception.config import perception_preset
from ...perception.filtered_logs.people_messages import CLOUD, POSES, PeopleMessages
from ...perception.filtered_logs.scan_filter import ScanFilter, removed_readings
from ...perception.people_filter import FilteredScan
from ...slam.geometry import compose, inverse, transform_points
from .live_scans import InputConfig, LiveScan, LiveScans
from .outputs import MadeMessages, Maker, Output

SCAN_TYPE, MARKERS = "sensor_msgs/msg/LaserScan", "visualization_msgs/msg/MarkerArray"
_SCAN_FIELDS = ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max")


@dataclass(frozen=True, kw_only=True)
class FilterNodeConfig(InputConfig):
    """Parameters of the nodes `filter` and `people`.

    Attributes:
        preset: Numbers of the tracker, as of `tagalong filter --preset`.
        forest: Leg forest: "real", "simulation" or a file.
    """

    preset: str = "recorded"
    forest: str = "real"


class _FilteredScans(ABC):
    """Takes people out of scans as they come; what is sent of each is up to the node."""

    def __init__(self, maker: Maker, config: FilterNodeConfig) -> None:
        self._maker, self._messages, self._scans = maker, MadeMessages(maker), LiveScans(config)
        self._filter = ScanFilter(replace(perception_preset(config.preset), forest=config.forest))

    def take(self, source: str, message: Any, now_s: float) -> list[Output]:
        """Take a message; return what each scan that is ready gives."""
        ready = self._scans.take(source, message, now_s)
        return [output for live in ready for output in self._send(live, self._filter.update(live.scan, live.odometry))]

    def tick(self, now_s: float) -> list[Output]:
        """Send nothing: the clock does not matter here."""
        return []

    def notes(self) -> list[str]:
        """Return what the scans have shown of the laser since the last call."""
        return self._scans.notes()

    def _people(self, live: LiveScan) -> PeopleMessages:
        return PeopleMessages(self._maker, flipped=live.flipped)  # pyright: ignore[reportArgumentType]

    @abstractmethod
    def _send(self, live: LiveScan, filtered: FilteredScan) -> list[Output]:
        """Return what is sent of a scan."""


class FilterLogic(_FilteredScans):
    """Sends scans without people (NaN: no measurement), and the people, in the scans' own frame.

    Args:
        maker: Of messages.
        config: Parameters.
    """

    def __init__(self, maker: Maker, config: FilterNodeConfig) -> None:
        super().__init__(maker, config)
        self.outputs = {
            "scan_filtered": SCAN_TYPE,
            "scan_filtered/people": POSES,
            "scan_filtered/tracks": CLOUD,
            "scan_filtered/legs": POSES,
        }

    def _send(self, live: LiveScan, filtered: FilteredScan) -> list[Output]:
        message, people = live.message, self._people(live)
        removed = removed_readings(filtered, live.order, len(message.ranges), float(message.angle_increment))
        ranges = np.where(removed, np.float32(np.nan), np.asarray(message.ranges, dtype=np.float32))
        plain = {name: getattr(message, name) for name in (*_SCAN_FIELDS, "header", "intensities")}
        return [
            Output("scan_filtered", self._maker.make(SCAN_TYPE, **plain, ranges=ranges)),
            Output("scan_filtered/people", people.people(message.header, filtered)),
            Output("scan_filtered/tracks", people.tracks(message.header, filtered)),
            Output("scan_filtered/legs", people.legs(message.header, filtered)),
        ]


class PeopleLogic(_FilteredScans):
    """Sends the people: as poses and as points in the scans' frame, and as markers for RViz in the odometry's frame.

    Args:
        maker: Of messages.
        config: Parameters.
    """

    def __init__(self, maker: Maker, config: FilterNodeConfig) -> None:
        super().__init__(maker, config)
        self.outputs = {"people": POSES, "people/tracks": CLOUD, "people/markers": MARKERS}

    def _send(self, live: LiveScan, filtered: FilteredScan) -> list[Output]:
        people, header = self._people(live), live.message.header
        markers = people_markers(self._messages, filtered, live, self._scans.odom_frame)
        return [
            Output("people", people.people(header, filtered)),
            Output("people/tracks", people.tracks(header, filtered)),
            Output("people/markers", markers),
        ]


def people_markers(messages: MadeMessages, filtered: FilteredScan, live: LiveScan, frame: str, leader: int = -1) -> Any:
    """Return a MarkerArray of the people in the odometry's frame, the one who leads in another colour."""
    T_odom_began = compose(live.T_odom_robot, inverse(live.odometry))
    places = transform_points(T_odom_began, filtered.people.positions)
    return messages.people(places, filtered.people.ids.tolist(), leader, live.scan.time_s, frame)
