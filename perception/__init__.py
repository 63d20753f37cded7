"""People and planes seen by a robot's laser and camera, and the filter that keeps people out of maps.

Most users need one class. It detects legs, tracks people, and drops their returns, scan by scan:

>>> import numpy as np
>>> from tagalong.perception import PeopleFilter
>>> from tagalong.slam.scan import LaserScan
>>> people_filter = PeopleFilter()
>>> scan = LaserScan(np.full(361, 4.0), np.linspace(-np.pi / 2, np.pi / 2, 361), range_min=0.1, range_max=30.0)
>>> filtered = people_filter.update(scan, odometry=(0.0, 0.0, 0.0))
>>> len(filtered.people), int(filtered.removed.sum()), len(filtered.without_people)
(0, 0, 361)

The same for a whole recorded drive, of a bag, say, before it is mapped:

    drive = read_log(Path("lobby.bag"))
    for filtered in filtered_scans(drive):
        slam.update(filtered.odometry, filtered.without_people)

Filtering    PeopleFilter (PeopleFilterConfig) returns a FilteredScan. For recordings, HindsightFilter, and
             `filtered_scans` for a whole drive, know people from when they were first seen, not first believed in.
Detection    LegDetector (LegDetectorConfig) finds legs in one scan, by a LegForest. Your own detector is a class with
             `detect(scan) -> Detections`: PeopleFilter(detector=...).
Tracking     PeopleTracker (TrackerConfig, a node for each stage) turns legs into People, with identities.
Leader       LeaderSelector keeps to the person chosen first.
Camera       PlaneFinder and PeopleFinder read RGB-D frames, of any camera (see below); ImmobileMapper maps what stays.
Numbers      PerceptionConfig is the tree of all of them; `perception_preset` has named ones; `table_ii` the paper's.

A frame of your own depth camera, with what its calibration says (fx, fy, cx, cy); here a floor seen from 1.2 m:

>>> from tagalong.perception import PeopleFinder, Pinhole, PlaneFinder, RgbdFrame
>>> camera = Pinhole.from_intrinsics((320, 240), (262.5, 262.5), (159.5, 119.5))
>>> depth = (1200.0 / np.fmax(0.2, np.arange(240)[:, None] / 262.5 - 0.2) * np.ones(320)).astype(np.uint16)
>>> colour = np.zeros((240, 320, 3), np.uint8)
>>> planes = PlaneFinder().find(RgbdFrame(depth, colour, camera, camera_height=None))
>>> people = PeopleFinder.load().find(planes.frame, planes)
>>> planes.mount.floor_seen, len(people), people.floor_known
(True, 0, True)

What is listed here is public; everything else may change. Names are imported when they are first used.
"""

from typing import TYPE_CHECKING

from ..slam.door import lends

if TYPE_CHECKING:
    from .config import PerceptionConfig, perception_preset, table_ii
    from .hindsight import HindsightFilter, filtered_scans
    from .immobile.mapper import ImmobileMapper
    from .leader.selector import LeaderSelector
    from .legs.detector import Detections, LegDetector, LegDetectorConfig
    from .legs.forest import LegForest
    from .people_filter import FilteredScan, PeopleFilter, PeopleFilterConfig
    from .rgbd.frame import Pinhole, RgbdFrame
    from .rgbd.people_finder import PeopleFinder
    from .rgbd.planes import PlaneFinder
    from .tracking.config import TrackerConfig
    from .tracking.people import People
    from .tracking.tracker import PeopleTracker

__all__ = [
    "Detections",
    "FilteredScan",
    "HindsightFilter",
    "ImmobileMapper",
    "LeaderSelector",
    "LegDetector",
    "LegDetectorConfig",
    "LegForest",
    "People",
    "PeopleFilter",
    "PeopleFilterConfig",
    "PeopleFinder",
    "PeopleTracker",
    "PerceptionConfig",
    "Pinhole",
    "PlaneFinder",
    "RgbdFrame",
    "TrackerConfig",
    "filtered_scans",
    "perception_preset",
    "table_ii",
]

_MODULES = {
    "config": ("PerceptionConfig", "perception_preset", "table_ii"),
    "hindsight": ("HindsightFilter", "filtered_scans"),
    "immobile.mapper": ("ImmobileMapper",),
    "leader.selector": ("LeaderSelector",),
    "legs.detector": ("Detections", "LegDetector", "LegDetectorConfig"),
    "legs.forest": ("LegForest",),
    "people_filter": ("FilteredScan", "PeopleFilter", "PeopleFilterConfig"),
    "rgbd.frame": ("Pinhole", "RgbdFrame"),
    "rgbd.people_finder": ("PeopleFinder",),
    "rgbd.planes": ("PlaneFinder",),
    "tracking.config": ("TrackerConfig",),
    "tracking.people": ("People",),
    "tracking.tracker": ("PeopleTracker",),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}

__getattr__, __dir__ = lends(__name__, _HOME)
