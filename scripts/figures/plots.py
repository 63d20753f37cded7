"""Plots by matplotlib (extra `viz`), without a display: made by `new_figure`, written whole by `save_figure`."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from ...slam.errors import MissingExtraError
from ...slam.files.output import replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure


def require_matplotlib() -> None:
    """Check early that plots can be drawn later.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        raise MissingExtraError("plots", "viz") from None


def new_figure(width: float, height: float) -> "Figure":
    """Return an empty figure of this size [inches], laid out by itself.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    require_matplotlib()
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def name_colours(figure: "Figure", colours: Mapping[str, tuple[int, int, int]]) -> None:
    """Write below the figure what its `colours` mean: name -> red, green, blue, 0 to 255 each."""
    from matplotlib.patches import Patch

    marks = [Patch(color=(r / 255.0, g / 255.0, b / 255.0), label=name) for name, (r, g, b) in colours.items()]
    figure.legend(handles=marks, loc="outside lower center", ncol=len(marks), frameon=False)


def logarithmic(axes: "Axes", which: str = "y") -> None:
    """Make the axes `which` ("x", "y" or "xy") logarithmic, their numbers written out: 0.05, not 5 x 10^-2."""
    for name in which:
        axes.set(**{f"{name}scale": "log"})
        axis: Axis = getattr(axes, f"{name}axis")
        axis.set_major_formatter(_plain)
        axis.set_minor_formatter(_plain_minor)


def _plain(value: float, _: object = None) -> str:
    return f"{value:g}"


def _plain_minor(value: float, _: object = None) -> str:
    """Name only the minor ticks at 2 and 5, so that the names do not run into each other."""
    return _plain(value) if f"{value:e}"[0] in "25" else ""


def save_figure(path: Path, figure: "Figure") -> Path:
    """Write a figure as PNG, whole or not at all; equal figures give equal bytes."""
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=120, metadata={"Software": None})
    return path
