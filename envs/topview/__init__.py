"""A picture of the world from above, by numpy and Pillow: no display, no OpenGL."""

from .snapshot import Snapshot, Tracks
from .view import TopView

__all__ = ["Snapshot", "TopView", "Tracks"]
