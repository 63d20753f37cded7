"""A straight corridor with smooth walls: nothing along it says how far the robot has come.

With a laser that reaches neither end, only the odometry does. It is the place where people in the scans matter most to
a scan matcher, since they are the only thing there that has an edge; and it shows what filtering cannot help.
"""

import numpy as np

from .corridor import with_standing_places
from .polyline import resample
from .scene import Scene, choose_route
from .solids import box

LENGTH = 30.0
"""Length [m], before it is varied by up to a quarter."""
_WIDTHS = (2.0, 2.5)
_WALL = 0.3


def plain_corridor(rng: np.random.Generator, route: str | None = None) -> Scene:
    """Return a straight corridor of about 30 x 2.2 m with nothing in it.

    Routes: "forward" and "back".
    """
    length, half = LENGTH * rng.uniform(0.75, 1.25), rng.uniform(*_WIDTHS) / 2.0
    solids = [
        box("wall", (-_WALL, -half - _WALL), (length + _WALL, -half)),
        box("wall", (-_WALL, half), (length + _WALL, half + _WALL)),
        box("wall", (-_WALL, -half), (0.0, half)),
        box("wall", (length, -half), (length + _WALL, half)),
    ]
    forward = resample(np.array([(1.2, 0.0), (length - 0.8, 0.0)]), 0.1)
    routes = {"forward": forward, "back": forward[::-1].copy()}
    scene = Scene(
        name="plain_corridor",
        solids=tuple(solids),
        floor=np.array([(0.0, -half), (length, -half), (length, half), (0.0, half)]),
        routes=routes,
        route_name=choose_route(routes, route, rng),
        lap=0.0,
        half_width=half - 0.2,
        standing_places=np.zeros((0, 2)),
    )
    return with_standing_places(scene, half, rng)
