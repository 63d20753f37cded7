"""The immobile-area map of laser and camera: recognition decides what enters it.

`CameraViewMaker().make(frame)` tells what one camera frame says about the room; `tagalong.perception.ImmobileMapper`
writes such views into its map; `ImmobileSlam(views)` is a SLAM engine that draws it. All other names are private.
"""

from typing import TYPE_CHECKING

from ...slam.door import lends

if TYPE_CHECKING:
    from .slam import ImmobileSlam
    from .view import CameraViewMaker

__all__ = [
    "CameraViewMaker",
    "ImmobileSlam",
]

_HOME = {
    "CameraViewMaker": "view",
    "ImmobileSlam": "slam",
}
"""Public name -> module; imported when it is asked for."""

__getattr__, __dir__ = lends(__name__, _HOME)
