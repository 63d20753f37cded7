"""A building as the simulator, the top view and the metrics see it."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.errors import unknown_name
from .polyline import arc_lengths
from .solids import Solid

Array = NDArray[np.float64]

RUN_OUT = 3.0
"""Length of the route behind the leader's last stop [m], so that people who walk ahead have somewhere to go."""


@dataclass(frozen=True)
class Outline:
    """One object of the top view.

    Attributes:
        polygon: (k, 2) corners, world frame [m].
        kind: What it is, e.g. "wall".
        bottom: Height of its lower face [m].
        top: Height of its upper face [m].
    """

    polygon: Array
    kind: str
    bottom: float
    top: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Walk:
    """A way on which a bystander walks to and fro.

    Attributes:
        points: (k, 2) world frame [m].
        speed: (k,) at which somebody was recorded there [m/s]; None: whoever walks there has a pace of their own.
    """

    points: Array
    speed: Array | None = None

    def speeds(self, spacing: float) -> Array:
        """Return the speed at the points that `resample` gives for `spacing` [m], NaN where there is none [m/s]."""
        arcs = arc_lengths(self.points)
        wanted = np.arange(0.0, arcs[-1] + 1e-9, spacing)
        return np.full(len(wanted), np.nan) if self.speed is None else np.interp(wanted, arcs, self.speed)


@dataclass(frozen=True, kw_only=True)
class Door:
    """A hinged door that is closed until somebody on foot comes near, and stays open then.

    Attributes:
        hinge: (x, y) of its hinge [m].
        yaw: Direction from the hinge along the closed leaf [rad].
        swing: Angle of the open leaf against the closed one, counter-clockwise positive [rad].
        width: Width of the leaf [m].
        top: Height of the leaf [m].
        opens_at: Distance of a person from its middle at which it opens [m].
    """

    hinge: tuple[float, float]
    yaw: float
    swing: float
    width: float
    top: float = 2.05
    opens_at: float = 1.3

    @property
    def middle(self) -> tuple[float, float]:
        """(x, y) of the middle of the closed leaf [m]."""
        half = self.width / 2.0
        return self.hinge[0] + half * float(np.cos(self.yaw)), self.hinge[1] + half * float(np.sin(self.yaw))


@dataclass(frozen=True, kw_only=True)
class Errand:
    """What a scripted person does: goes straight from place to place, and waits at each.

    Attributes:
        name: What it is called in reports.
        places: (x, y, wait) [m, m, s] in their order; the person begins at the first and stays at the last.
        pace: Walking speed [m/s].
        face: Direction to look to while standing [rad].
    """

    name: str
    places: tuple[tuple[float, float, float], ...]
    pace: float = 0.9
    face: float = 0.0


@dataclass(frozen=True, kw_only=True)
class OperatorPlan:
    """How a person with a joystick would drive the robot; scripted, not recorded from a human.

    Attributes:
        route: Name of the tour that is driven.
        speed: Speed on straight pieces [m/s].
        waits: (arc length, time): the robot stops at each arc length [m] until that time of the episode [s].
        looks: (arc length, angle): at each arc length [m] the robot turns by an angle and back [rad].
    """

    route: str
    speed: float
    waits: tuple[tuple[float, float], ...] = ()
    looks: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, kw_only=True)
class Scene:
    """One drawn building, in a world frame of its own. A scene of one's own needs the first six; see `make_scene`.

    Attributes:
        name: What it is called in errors and reports.
        solids: Walls and furniture.
        floor: (k, 2) polygon of the walkable floor between the walls [m]; furniture stands on it.
        routes: Tours by name; each (n, 2) [m], drivable by the robot, ending `RUN_OUT` metres behind the tour's end.
        route_name: The tour of this episode.
        half_width: Clear space to both sides of the route [m].
        lap: Length [m] of one lap where the route is a closed lap driven several times, else 0.
        standing_places: (m, 2) arc length along the route and lateral offset (left positive) of places where somebody
            can stand without blocking the robot [m].
        walks: Ways of bystanders who do not walk on the tour; () where all walk on the tour.
        ceiling: Height of the ceiling [m]; None where there is none.
        doors: Hinged doors.
        errands: One for each scripted person; they are there in every episode.
        operator: How an operator would drive the robot; None where nobody has said so.
        marks: Places that reports speak of: (k, 2) polygons by name [m].
    """

    name: str
    solids: tuple[Solid, ...]
    floor: Array
    routes: dict[str, Array]
    route_name: str
    half_width: float
    lap: float = 0.0
    standing_places: Array = field(default_factory=lambda: np.zeros((0, 2)))
    walks: tuple[Walk, ...] = ()
    ceiling: float | None = None
    doors: tuple[Door, ...] = ()
    errands: tuple[Errand, ...] = ()
    operator: OperatorPlan | None = None
    marks: dict[str, Array] = field(default_factory=dict)

    @property
    def route(self) -> Array:
        """(n, 2) the tour of this episode [m], world frame."""
        return self.routes[self.route_name]

    @cached_property
    def tour_length(self) -> float:
        """Arc length of the route at which the leader stops [m]."""
        return float(np.hypot(*np.diff(self.route, axis=0).T).sum()) - RUN_OUT

    @cached_property
    def bounds(self) -> tuple[float, float, float, float]:
        """(x_min, y_min, x_max, y_max) around all solids [m]."""
        corners = np.concatenate([solid.outline() for solid in self.solids])
        low, high = corners.min(axis=0), corners.max(axis=0)
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    @cached_property
    def outlines(self) -> tuple[Outline, ...]:
        """All objects that begin below 2 m as polygons with heights, for the top view."""
        low = (solid for solid in self.solids if solid.bottom < 2.0)
        return tuple(Outline(solid.outline(), solid.kind, solid.bottom, solid.top) for solid in low)

    def clearance(self, points: ArrayLike, *, of_people: bool = False) -> Array:
        """Return (...,) distances [m] from `points` (..., 2) to the nearest solid.

        Args:
            points: World frame [m].
            of_people: Whether to measure to everything that people walk around, instead of what is lower than 0.4 m
                (which is what the robot can hit).
        """
        nearest = np.full(np.asarray(points).shape[:-1], np.inf)
        for solid in self.solids:
            if solid.blocks_people if of_people else solid.bottom < 0.4:
                nearest = np.minimum(nearest, solid.distance(points))
        return nearest


def choose_route(routes: dict[str, np.ndarray], wanted: str | None, rng: np.random.Generator) -> str:
    """Return `wanted`, or a drawn one where it is None; the draw is made in both cases.

    Raises:
        InputError: If there is no such route.
    """
    drawn = str(rng.choice(sorted(routes)))
    if wanted is None:
        return drawn
    if wanted not in routes:
        raise unknown_name("route", wanted, tuple(routes))
    return wanted
