"""What an RGB-D camera on the robot sees: frames, planes, objects.

    RgbdFrame(depth, colour, Pinhole(...), ...)      what `tagalong.perception.PlaneFinder` and `PeopleFinder` are given
    Surface                                          what a point lies on: floor, ceiling, wall, top of a table ...
    read_frames(folder)                              recorded frames: depth, colour, intrinsics of each
    read_bag_frames(bag)                             the same of a ROS 1 or ROS 2 bag, or mcap file
    RgbdPeople                                       who is in a frame; what a people finder of one's own returns
    PersonClassifier.load(path)                             a classifier that `tagalong train people` wrote

All other names are private.
"""

from typing import TYPE_CHECKING

from ...slam.door import lends

if TYPE_CHECKING:
    from .bag_frames import read_bag_frames
    from .frame import Pinhole, RgbdFrame
    from .people import RgbdPeople
    from .person_classifier import PersonClassifier
    from .pictures import read_frames
    from .planes import Surface

__all__ = [
    "PersonClassifier",
    "Pinhole",
    "RgbdFrame",
    "RgbdPeople",
    "Surface",
    "read_bag_frames",
    "read_frames",
]

_HOME = {
    "PersonClassifier": "person_classifier",
    "Pinhole": "frame",
    "RgbdFrame": "frame",
    "RgbdPeople": "people",
    "Surface": "planes",
    "read_bag_frames": "bag_frames",
    "read_frames": "pictures",
}
"""Public name -> module; imported when it is asked for."""

__getattr__, __dir__ = lends(__name__, _HOME)
