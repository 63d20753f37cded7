"""One scan, raw and with the people taken out, side by side (Ye et al. 2021, Fig. 1 b and c)."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from ...slam.geometry import transform_points
from ...slam.scan import LaserScan
from .canvas import BLUE, FAINT, INK, ORANGE, PlanCanvas, side_by_side

_RING_M = 1.0
_ROBOT = np.array([(0.30, 0.0), (-0.22, 0.20), (-0.12, 0.0), (-0.22, -0.20)])  # an arrow head, x forward [m]
_FORWARD_IS_UP = (0.0, 0.0, np.pi / 2.0)


def scan_pair_picture(
    raw: LaserScan,
    filtered: LaserScan,
    people_robot: ArrayLike = (),
    zeta: float = 0.35,
    reach: float = 6.0,
    title: str = "",
) -> Image.Image:
    """Return both scans around the robot, forward up, with rings at every metre.

    Args:
        raw: The scan as measured.
        filtered: The same beams with those on people dropped (`LaserScan.without`).
        people_robot: (n, 2) tracked people in the robot frame [m], drawn as circles of radius `zeta`.
        zeta: Distance within which points count as a person's [m].
        reach: How far the pictures reach to each side, and forwards [m].
        title: Begins the line above each picture.
    """
    dropped = raw.is_return & ~filtered.is_return
    people = transform_points(_FORWARD_IS_UP, np.asarray(people_robot, dtype=np.float64).reshape(-1, 2))
    lead = f"{title}: " if title else ""
    left = _sheet(raw, dropped, people, zeta, reach, f"{lead}raw scan, {int(raw.is_return.sum())} points")
    count = int(filtered.is_return.sum())
    right = _sheet(filtered, np.zeros_like(dropped), people[:0], zeta, reach, f"people filtered, {count} points")
    return side_by_side((left, right))


def _sheet(
    scan: LaserScan,
    on_people: NDArray[np.bool_],
    people: NDArray[np.float64],
    zeta: float,
    reach: float,
    title: str,
) -> Image.Image:
    canvas = PlanCanvas((-reach, -0.45 * reach), (reach, reach), title, (680, 680))
    _rings(canvas, reach)
    points = transform_points(_FORWARD_IS_UP, transform_points(scan.T_robot_lidar, scan.beam_points))
    shown = np.all((points > (-reach, -0.45 * reach)) & (points < reach), axis=1)
    canvas.dots(points[shown & ~on_people], INK, 1.8)
    for person in people:
        canvas.circle(person, zeta, ORANGE, 1.5)
    canvas.dots(points[shown & on_people], ORANGE, 2.4)
    canvas.polygon(transform_points(_FORWARD_IS_UP, _ROBOT), BLUE)
    legend = [("robot", BLUE), ("walls and things", INK)]
    canvas.legend([*legend, ("taken for people", ORANGE)] if on_people.any() or len(people) else legend)
    return canvas.finished()


def _rings(canvas: PlanCanvas, reach: float) -> None:
    for radius in np.arange(_RING_M, reach, _RING_M):
        canvas.circle((0.0, 0.0), float(radius), (222, 225, 230))
        if radius % 2 == 0:
            canvas.label((0.0, float(radius)), f"{radius:g} m", FAINT, 15)
