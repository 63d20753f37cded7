"""A picture of the world from above, by numpy and Pillow: no display, no OpenGL."""

from .snapshot import DrawnTracks, Snapshot
from .view import TopView

__all__ = ["DrawnTracks", "Snapshot", "TopView"]
