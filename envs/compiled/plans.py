"""Drawn episodes as arrays: building, ways, people and start of each in a row."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_view_kernel
from ..people.behaviours.mind import Mind, minds_of
from ..people.crowd import reach_of_things
from ..people.movement.bodies import standing_bodies
from ..people.movement.ground import Ground, Ways
from ..people.movement.things import Things, things_around
from ..robot.robot import RobotConfig
from ..scenes.scene import Scene
from ..scenes.solids import Solid
from ..world.doors import GAP, THICKNESS
from ..world.drawing import EpisodeDrawing

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

TOUCHABLE = 0.3
"""Solids that begin below this height can be touched by the robot, if they begin below its top [m]."""


class Plans(NamedTuple):
    """Episodes as drawn, s of them; kernels take it as it is. What a row does not fill is 0.

    Attributes:
        people: (s,) how many people.
        group: (s,) how many of them, the first, walk with the robot.
        rectangles: (s,) how many rows of `seen_boxes` count.
        rounds: (s,) how many rows of `seen_circles` count.
        doors: (s,) how many doors.
        boxes: (s, b, 6) what people walk round, as the next four, see `Things`.
        circles: (s, c, 3).
        frame: (s, 5).
        first: (s, cells + 1).
        items: (s, k).
        touched_boxes: (s, b, 6) what the robot can touch, as the next four.
        touched_circles: (s, c, 3).
        touched_frame: (s, 5).
        touched_first: (s, cells + 1).
        touched_items: (s, k).
        seen_boxes: (s, b, 6) what the laser's plane cuts.
        seen_circles: (s, c, 3).
        leaves: (s, d, 7) of each door: hinge x, y [m], yaw and swing [rad], half width [m], distance at which it
            opens [m], length of the whole leaf [m].
        points: (s, m, 2) all ways, as the next eight, see `Ways`.
        tangents: (s, m, 2).
        free: (s, m, 2).
        speed: (s, m).
        way_first: (s, p).
        way_count: (s, p).
        bends: (s, r).
        wide: (s, r).
        way_sizes: (s, 2).
        size: (s, n, 5) of the people, as in `gait.advance_gait`.
        radius: (s, n) of the bodies [m].
        heedless: (s, n) who does not see the robot.
        kind: (s, n) of behaviour, see `Minds`.
        numbers: (s, n, NUMBERS) with which each behaviour begins.
        script: (s, n, k, 3).
        way: (s, n) on which each walks.
        ground: (s, n).
        elsewhere: (s, n).
        own_first: (s, n) where the way of each begins in `points`.
        own_count: (s, n) how many points it has.
        place: (s, n, 2) where each begins [m].
        heading: (s, n) [rad].
        feet: (s, n, 2, 2) [m].
        arc: (s, n) along the way [m].
        sense: (s, n).
        lateral: (s, n) [m].
        start: (s, 3) T_world_robot.
        start_arc: (s,) its way along the route [m].
        errors: (s, 7) of the odometry, see `believed_motion`.
    """

    people: Ints
    group: Ints
    rectangles: Ints
    rounds: Ints
    doors: Ints
    boxes: Array
    circles: Array
    frame: Array
    first: NDArray[np.int32]
    items: NDArray[np.int32]
    touched_boxes: Array
    touched_circles: Array
    touched_frame: Array
    touched_first: NDArray[np.int32]
    touched_items: NDArray[np.int32]
    seen_boxes: Array
    seen_circles: Array
    leaves: Array
    points: Array
    tangents: Array
    free: Array
    speed: Array
    way_first: Ints
    way_count: Ints
    bends: Flags
    wide: Flags
    way_sizes: Array
    size: Array
    radius: Array
    heedless: Flags
    kind: Ints
    numbers: Array
    script: Array
    way: Ints
    ground: Ints
    elsewhere: Flags
    own_first: Ints
    own_count: Ints
    place: Array
    heading: Array
    feet: Array
    arc: Array
    sense: Array
    lateral: Array
    start: Array
    start_arc: Array
    errors: Array


@inner_view_kernel
def things_of(plans: Plans, s: int) -> Things:
    """Return what people of plan s walk round."""
    return Things(plans.boxes[s], plans.circles[s], plans.frame[s], plans.first[s], plans.items[s])


@inner_view_kernel
def touchable_of(plans: Plans, s: int) -> Things:
    """Return what the robot of plan s can touch."""
    return Things(
        plans.touched_boxes[s],
        plans.touched_circles[s],
        plans.touched_frame[s],
        plans.touched_first[s],
        plans.touched_items[s],
    )


@inner_view_kernel
def ways_of(plans: Plans, s: int) -> Ways:
    """Return the ways of plan s."""
    return Ways(
        plans.points[s],
        plans.tangents[s],
        plans.free[s],
        plans.speed[s],
        plans.way_first[s],
        plans.way_count[s],
        plans.bends[s],
        plans.wide[s],
        plans.way_sizes[s],
    )


def plan_row(drawing: EpisodeDrawing) -> dict[str, NDArray[Any]]:
    """Return a drawn episode as a row of `Plans`, by name."""
    plan, config = drawing.plan, drawing.plan.config
    seen = [solid for solid in plan.scene.solids if solid.at_height(config.lidar.height)]
    seen_boxes, seen_circles = _outlines(seen)
    whole = {
        "people": len(plan.casting.people),
        "group": plan.casting.group,
        "rectangles": len(seen_boxes),
        "rounds": len(seen_circles),
        "doors": len(plan.scene.doors),
    }
    boxes, circles = drawing.terrain.boxes, drawing.terrain.circles
    return {
        **{name: np.array(number, dtype=np.int64) for name, number in whole.items()},
        **_named("", things_around(boxes, circles, reach_of_things(config.force))),
        **_named("touched_", _touchable(plan.scene, config.robot)),
        "seen_boxes": seen_boxes,
        "seen_circles": seen_circles,
        "leaves": _leaves(plan.scene),
        **_named_ways(drawing.terrain.ways),
        **_people(drawing),
        "start": plan.start,
        "start_arc": np.array(drawing.start_arc),
        "errors": drawing.odometry.errors,
    }


def _named(prefix: str, things: Things) -> dict[str, NDArray[Any]]:
    return {f"{prefix}{name}": np.asarray(value) for name, value in things._asdict().items()}


def _named_ways(ways: Ways) -> dict[str, NDArray[Any]]:
    names = {"first": "way_first", "rows": "way_count", "sizes": "way_sizes"}
    return {names.get(name, name): np.asarray(value) for name, value in ways._asdict().items()}


def _outlines(solids: list[Solid]) -> tuple[Array, Array]:
    """Return boxes (b, 6) and circles (c, 3) of solids."""
    boxes = [(s.x, s.y, np.cos(s.yaw), np.sin(s.yaw), s.half_length, s.half_width) for s in solids if not s.is_round]
    circles = [(s.x, s.y, s.radius) for s in solids if s.is_round]
    return np.array(boxes, dtype=np.float64).reshape(-1, 6), np.array(circles, dtype=np.float64).reshape(-1, 3)


def _touchable(scene: Scene, robot: RobotConfig) -> Things:
    low = [solid for solid in scene.solids if solid.bottom < TOUCHABLE and solid.bottom < robot.size[2]]
    return things_around(*_outlines(low), reach=robot.radius + 0.01)


def _leaves(scene: Scene) -> Array:
    rows = [(*d.hinge, d.yaw, d.swing, d.width / 2.0 - GAP, d.opens_at, d.width) for d in scene.doors]
    return np.array(rows, dtype=np.float64).reshape(-1, 7)


HALF_LEAF = THICKNESS / 2.0
"""Half of the thickness of a door's leaf [m]."""


def _people(drawing: EpisodeDrawing) -> dict[str, NDArray[Any]]:
    casting, ways = drawing.plan.casting, drawing.terrain.ways
    sizes = casting.physiques
    size = [(p.thigh, p.shin, p.leg_radius, p.stance_half_width, p.walk_ratio) for p in sizes]
    stance = np.array([p.stance_half_width for p in sizes], dtype=np.float64)
    bodies = standing_bodies([person.start for person in casting.people], stance)
    minds = minds_of([person.behaviour for person in casting.people if isinstance(person.behaviour, Mind)])
    way = np.array([person.path for person in casting.people], dtype=np.int64)
    ground = np.array([person.ground for person in casting.people], dtype=np.int64)
    return {
        "size": np.array(size, dtype=np.float64).reshape(-1, 5),
        "radius": np.array([p.radius for p in sizes], dtype=np.float64),
        "heedless": np.array([person.heedless for person in casting.people], dtype=np.bool_),
        "kind": minds.kind,
        "numbers": minds.numbers,
        "script": minds.script,
        "way": way,
        "ground": ground,
        "elsewhere": ground == Ground.ELSEWHERE,
        "own_first": ways.first[way],
        "own_count": ways.rows[way],
        "place": bodies.position,
        "heading": bodies.heading,
        "feet": bodies.feet,
        "arc": bodies.arc,
        "sense": bodies.sense,
        "lateral": bodies.lateral,
    }
