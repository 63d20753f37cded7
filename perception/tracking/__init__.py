"""From leg detections to people with an identity.

`tagalong.perception.PeopleTracker` is the tracker. `SeenPeople` is what a camera tells it; `NoLegs()` is the detector
of those who take no legs from the laser. All other names are private.
"""

from typing import TYPE_CHECKING

from ...slam.door import lends

if TYPE_CHECKING:
    from .camera import NoLegs, SeenPeople

__all__ = [
    "NoLegs",
    "SeenPeople",
]

_HOME = {
    "NoLegs": "camera",
    "SeenPeople": "camera",
}
"""Public name -> module; imported when it is asked for."""

__getattr__, __dir__ = lends(__name__, _HOME)
