"""How the two colours of a surface alternate."""

from enum import IntEnum


class SurfacePattern(IntEnum):
    """How the two colours of a geom alternate."""

    PLAIN = 0
    STRIPES = 1
    CHECKS = 2
    GRAIN = 3
    HEAD = 4
    PANEL = 5
