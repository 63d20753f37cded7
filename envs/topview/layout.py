"""Where the parts of a picture stand."""

from dataclasses import dataclass

SIZE = (960, 540)
"""Width and height of a picture [pixel]."""
_GAP = 8
_LONG = 1.8
"""Buildings longer than this, against their width, have the map below the view, others beside it."""


@dataclass(frozen=True)
class PanelLayout:
    """Places in a picture [pixel].

    Attributes:
        view: Width and height of the view, at the upper left corner.
        map_corner: Upper left corner of the map.
        map_size: Width and height of the map.
        captions: Upper left corner of the captions.
        closest: Most pixels a metre of the view.
        farthest: Fewest pixels a metre; a larger building is seen through a window that moves with the robot.
    """

    view: tuple[int, int]
    map_corner: tuple[int, int]
    map_size: tuple[int, int]
    captions: tuple[int, int]
    closest: float = 70.0
    farthest: float = 40.0


def layout(bounds: tuple[float, float, float, float]) -> PanelLayout:
    """Return the layout for a building within `bounds` (x_min, y_min, x_max, y_max) [m]."""
    x_min, y_min, x_max, y_max = bounds
    width, height = SIZE
    if x_max - x_min > _LONG * (y_max - y_min):
        top = height - 150
        side = 306
        return PanelLayout(
            view=(width, top),
            map_corner=(_GAP, top + _GAP),
            map_size=(width - side - 3 * _GAP, height - top - 2 * _GAP),
            captions=(width - side, top + _GAP),
            farthest=64.0,
        )
    left, below = 600, 130
    return PanelLayout(
        view=(left, height),
        map_corner=(left + _GAP, _GAP),
        map_size=(width - left - 2 * _GAP, height - below - 2 * _GAP),
        captions=(left + 3 * _GAP, height - below),
    )
