"""A tracker in a round hall: scans of posts before a wall, and a detector that also sees the wall."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from tagalong.perception.legs.clusters import Clusters
from tagalong.perception.legs.detector import Detections
from tagalong.perception.tracking.config import TrackerConfig
from tagalong.perception.tracking.tracker import PeopleTracker
from tagalong.slam import LaserScan
from tagalong.slam.geometry import inverse, transform_points

BEARINGS = np.radians(np.arange(-135.0, 135.0, 0.3516))


def wall_from(pose, radius=9.0, bearings=BEARINGS):
    """How far the round wall of the hall is along each beam, seen from `pose` (3,)."""
    ahead = pose[0] * np.cos(bearings + pose[2]) + pose[1] * np.sin(bearings + pose[2])
    return np.sqrt(ahead**2 + radius**2 - pose[0] ** 2 - pose[1] ** 2) - ahead


def scan_of(places, time_s, radius=0.08, wall=9.0, bearings=BEARINGS):
    """A scan of posts at `places` (n, 2) before a wall at so many metres, one or one for each beam."""
    ranges = np.full(len(bearings), wall)
    for x, y in places:
        away, off = np.hypot(x, y), bearings - np.arctan2(y, x)
        hit = np.abs(away * np.sin(off)) < radius
        ranges[hit & (np.cos(off) > 0.0)] = np.minimum(ranges[hit & (np.cos(off) > 0.0)], away)
    return LaserScan(ranges, bearings, 0.1, 11.0, time_s=time_s)


@dataclass
class BeforeWall:
    """A detector that also reports the far wall of a scan, as one cluster that is nobody."""

    detector: Any

    def detect(self, scan):
        found, far = self.detector.detect(scan), scan.ranges > 4.0
        if not far.any():
            return found
        wall, clusters = scan.beam_points[far], found.clusters
        count = len(clusters.points)
        points = np.concatenate((clusters.points, wall))
        start, end = np.append(clusters.start, count), np.append(clusters.end, count + len(wall))
        return Detections(
            np.concatenate((found.positions, wall.mean(axis=0)[None])),
            np.append(found.confidence, 0.0),
            np.append(found.human, False),
            Clusters(points, np.arange(len(points)), start, end),
        )


@dataclass
class Hall:
    """A tracker in a round hall that is shown places of clusters in the odometry frame, 7.5 times a second."""

    detector: Any
    rate_hz: float = 7.5
    scans: int = 0

    def __post_init__(self):
        self.tracker = PeopleTracker(TrackerConfig(), BeforeWall(self.detector))

    def show(
        self, places, confidence=0.3, odometry=(0.0, 0.0, 0.0), hidden=False, true=None, seen=None, bearings=BEARINGS
    ):
        self.scans += 1
        pose = np.asarray(odometry, dtype=float)
        there = transform_points(inverse(pose), np.reshape(places, (-1, 2)))
        wall = 0.5 if hidden else wall_from(pose if true is None else true, bearings=bearings)
        scan = scan_of(there, self.scans / self.rate_hz, wall=wall, bearings=bearings)
        self.detector.positions = there[:0] if hidden else there
        self.detector.confidence = np.full(len(self.detector.positions), confidence)
        return self.tracker.update(scan, odometry, seen).people
