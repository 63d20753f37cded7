"""Things of a person's height that stand about: what a detector of people must not take for one."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from ...envs.scenes.scene import Scene
from ...envs.scenes.solids import Solid, post
from ...slam.errors import unknown_name

Array = NDArray[np.float64]
REACH_M = 7.0
"""Things and people stand no farther off than this, if not told otherwise [m]."""
Maker = Callable[[Generator, float, float], list[Solid]]


def _drum(x: float, y: float, radius: float, bottom: float, top: float) -> Solid:
    return Solid(kind="prop", x=x, y=y, radius=radius, bottom=bottom, top=top)


def _block(
    rng: Generator, x: float, y: float, size: tuple[float, float], top: float, bottom: float = 0.0, kind: str = "prop"
) -> Solid:
    half_length, half_width = size
    yaw = float(rng.uniform(-np.pi, np.pi))
    return Solid(kind=kind, x=x, y=y, yaw=yaw, half_length=half_length, half_width=half_width, bottom=bottom, top=top)


def _lamp(rng: Generator, x: float, y: float) -> list[Solid]:
    shade = float(rng.uniform(1.3, 1.5))
    return [post("prop", x, y, 0.02, shade), _drum(x, y, float(rng.uniform(0.12, 0.22)), shade, shade + 0.25)]


def _coat_stand(rng: Generator, x: float, y: float) -> list[Solid]:
    bottom, top = rng.uniform(0.6, 0.9), rng.uniform(1.4, 1.6)
    return [post("prop", x, y, 0.03, 1.75), _block(rng, x, y, (rng.uniform(0.15, 0.28), 0.13), top, bottom)]


def _plant(rng: Generator, x: float, y: float) -> list[Solid]:
    bottom = float(rng.uniform(0.5, 0.9))
    crown = _drum(x, y, float(rng.uniform(0.2, 0.35)), bottom, float(rng.uniform(1.3, 1.8)))
    return [post("carton", x, y, 0.18, 0.4), post("prop", x, y, 0.04, bottom), crown]


def _stack(rng: Generator, x: float, y: float) -> list[Solid]:
    size = (float(rng.uniform(0.15, 0.35)), float(rng.uniform(0.15, 0.3)))
    return [_block(rng, x, y, size, float(rng.uniform(1.25, 2.0)), kind="carton")]


def _dress_form(rng: Generator, x: float, y: float) -> list[Solid]:
    top = float(rng.uniform(1.3, 1.5))
    body = _drum(x, y, float(rng.uniform(0.12, 0.18)), 0.8, top)
    return [post("prop", x, y, 0.03, 0.8), body, _drum(x, y, 0.05, top, top + 0.1)]


def _speaker(rng: Generator, x: float, y: float) -> list[Solid]:
    bottom = float(rng.uniform(1.0, 1.2))
    return [post("prop", x, y, 0.03, bottom), _block(rng, x, y, (0.17, 0.14), bottom + 0.5, bottom)]


def _dispenser(rng: Generator, x: float, y: float) -> list[Solid]:
    return [_block(rng, x, y, (0.16, 0.16), 1.0), _drum(x, y, 0.14, 1.0, float(rng.uniform(1.3, 1.45)))]


def _banner(rng: Generator, x: float, y: float) -> list[Solid]:
    return [_block(rng, x, y, (float(rng.uniform(0.3, 0.45)), 0.02), 2.0, 0.05, kind="screen")]


def _statue(rng: Generator, x: float, y: float) -> list[Solid]:
    """Return a plinth with a bust: as high as a person, and with something like a head."""
    top = float(rng.uniform(1.4, 1.5))
    return [
        _block(rng, x, y, (0.2, 0.2), 0.95),
        _drum(x, y, 0.13, 0.95, top),
        _drum(x, y, 0.08, top, top + 0.22),
    ]


def _column(rng: Generator, x: float, y: float) -> list[Solid]:
    """Return one to three columns, legs of a machine or of a rack, that stand close, some on a foot of beams."""
    found: list[Solid] = []
    for _ in range(int(rng.integers(1, 4))):
        (dx, dy), top = rng.uniform(-0.3, 0.3, 2), float(rng.uniform(1.2, 2.4))
        bottom = float(rng.choice((0.0, 0.1, 0.3)))
        if rng.random() < 0.5:
            found.append(_drum(x + dx, y + dy, float(rng.uniform(0.03, 0.15)), bottom, top))
        else:
            size = (float(rng.uniform(0.03, 0.2)), float(rng.uniform(0.02, 0.12)))
            found.append(_block(rng, x + dx, y + dy, size, top, bottom))
    for turn in rng.uniform(-np.pi, np.pi, int(rng.integers(0, 4))):
        half = float(rng.uniform(0.15, 0.3))
        dx, dy = half * float(np.cos(turn)), half * float(np.sin(turn))
        found.append(_plate(x + dx, y + dy, float(turn), (half, 0.04), 0.02, float(rng.uniform(0.08, 0.2))))
    return found


def _hat_stand(rng: Generator, x: float, y: float) -> list[Solid]:
    return [post("prop", x, y, 0.035, 1.6), _drum(x, y, float(rng.uniform(0.14, 0.2)), 1.6, 1.72)]


def _clutter(rng: Generator, x: float, y: float) -> list[Solid]:
    """Return blocks, drums and posts in a heap, of any sizes and up to any height."""
    found: list[Solid] = []
    for _ in range(int(rng.integers(2, 7))):
        (dx, dy), bottom = rng.uniform(-0.3, 0.3, 2), float(max(0.0, rng.uniform(-1.0, 1.2)))
        top = bottom + float(rng.uniform(0.05, 1.2))
        if rng.random() < 0.6:
            size = (float(rng.uniform(0.02, 0.35)), float(rng.uniform(0.02, 0.25)))
            found.append(_block(rng, x + dx, y + dy, size, top, bottom))
        else:
            found.append(_drum(x + dx, y + dy, float(rng.uniform(0.02, 0.2)), bottom, top))
    return found


def _shelf(rng: Generator, x: float, y: float) -> list[Solid]:
    """Return boards on four posts, and things on the boards."""
    yaw, half_length, half_width = float(rng.uniform(-np.pi, np.pi)), float(rng.uniform(0.3, 0.5)), 0.18
    turned = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    height, found = float(rng.uniform(1.2, 2.1)), []
    for sx, sy in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        dx, dy = turned @ (sx * half_length, sy * half_width)
        found.append(post("prop", x + float(dx), y + float(dy), 0.02, height))
    for board in np.arange(0.3, height + 0.01, float(rng.uniform(0.3, 0.45))).tolist():
        found.append(_plate(x, y, yaw, (half_length, half_width), board - 0.03, board))
        if rng.random() < 0.7:
            dx, dy = turned @ (rng.uniform(-0.7, 0.7) * half_length, 0.0)
            size = (float(rng.uniform(0.05, 0.2)), float(rng.uniform(0.05, 0.15)))
            top = float(board) + float(rng.uniform(0.08, 0.3))
            found.append(_block(rng, x + float(dx), y + float(dy), size, top, float(board), kind="carton"))
    return found


def _curtain(rng: Generator, x: float, y: float) -> list[Solid]:
    """Return a row of drums that stand close: folds of cloth."""
    yaw, radius = float(rng.uniform(-np.pi, np.pi)), float(rng.uniform(0.03, 0.08))
    along = 1.6 * radius * (np.arange(int(rng.integers(4, 14))) - 4.0)
    bottom, top = float(rng.uniform(0.0, 0.8)), float(rng.uniform(1.4, 2.4))
    return [_drum(x + float(np.cos(yaw) * s), y + float(np.sin(yaw) * s), radius, bottom, top) for s in along]


def _high_chair(rng: Generator, x: float, y: float) -> list[Solid]:
    """Return a chair with a back as high as that of an armchair, turned anywhere."""
    yaw, seat = float(rng.uniform(-np.pi, np.pi)), float(rng.uniform(0.4, 0.5))
    behind = np.array([x, y]) - 0.25 * np.array([np.cos(yaw), np.sin(yaw)])
    half_width, back = float(rng.uniform(0.2, 0.35)), float(rng.uniform(1.0, 1.3))
    bottom = float(rng.choice((0.05, 0.35)))
    return [
        _plate(x, y, yaw, (0.25, half_width), bottom, seat),
        _plate(float(behind[0]), float(behind[1]), yaw, (0.05, half_width), seat, back),
    ]


def _four_legs(rng: Generator, x: float, y: float) -> list[Solid]:
    """Return a table, a stool or a chair on four legs, turned anywhere."""
    yaw, top, radius = float(rng.uniform(-np.pi, np.pi)), float(rng.uniform(0.38, 0.8)), float(rng.uniform(0.012, 0.04))
    size = np.array([rng.uniform(0.17, 0.6), rng.uniform(0.17, 0.35)])
    turned = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    found = [_plate(x, y, yaw, (float(size[0]), float(size[1])), top - 0.04, top)]
    for corner in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        dx, dy = turned @ (np.array(corner) * (size - radius))
        found.append(post("prop", x + float(dx), y + float(dy), radius, top))
    if rng.random() < 0.5:
        dx, dy = turned @ (-size[0], 0.0)
        found.append(_plate(x + float(dx), y + float(dy), yaw, (0.02, float(size[1])), top, top + 0.45))
    return found


def _one_leg(rng: Generator, x: float, y: float) -> list[Solid]:
    """Return a table or a chair on one post, which stands on a star of five feet or on a plate."""
    yaw, seat = float(rng.uniform(-np.pi, np.pi)), float(rng.uniform(0.4, 0.75))
    half, foot = float(rng.uniform(0.2, 0.4)), float(rng.uniform(0.2, 0.32))
    found = [
        post("prop", x, y, float(rng.uniform(0.02, 0.06)), seat),
        _plate(x, y, yaw, (half, half), seat - 0.06, seat),
    ]
    if rng.random() < 0.4:
        return [*found, _drum(x, y, foot, 0.0, 0.03)]
    for turn in yaw + np.arange(5) * (2.0 * np.pi / 5.0):
        dx, dy = 0.5 * foot * float(np.cos(turn)), 0.5 * foot * float(np.sin(turn))
        found.append(_plate(x + dx, y + dy, float(turn), (0.5 * foot, 0.025), 0.03, 0.09))
    return found


def _low_things(rng: Generator, x: float, y: float) -> list[Solid]:
    """Return one to three bins, cases, bags and boxes below the hips."""
    found: list[Solid] = []
    for _ in range(int(rng.integers(1, 4))):
        dx, dy = (float(v) for v in rng.uniform(-0.35, 0.35, 2))
        top = float(rng.uniform(0.15, 0.8))
        if rng.random() < 0.5:
            found.append(_drum(x + dx, y + dy, float(rng.uniform(0.06, 0.22)), 0.0, top))
        else:
            size = (float(rng.uniform(0.05, 0.3)), float(rng.uniform(0.05, 0.25)))
            found.append(_block(rng, x + dx, y + dy, size, top, kind=str(rng.choice(("prop", "carton")))))
    return found


def _plate(x: float, y: float, yaw: float, size: tuple[float, float], bottom: float, top: float) -> Solid:
    half_length, half_width = size
    return Solid(kind="prop", x=x, y=y, yaw=yaw, half_length=half_length, half_width=half_width, bottom=bottom, top=top)


PROPS: dict[str, tuple[Maker, ...]] = {
    "none": (),
    "training 0": (_lamp, _curtain),
    "training 1": (_coat_stand, _four_legs, _clutter),
    "training 2": (_plant, _shelf, _high_chair),
    "training 3": (_stack, _one_leg, _column),
    "training 4": (_dress_form, _low_things),
    "unseen": (_speaker, _dispenser, _banner, _statue, _hat_stand),
}
"""Name -> what there is; what a detector is tested among is nothing that it was trained among."""


def draw_props(rng: Generator, scene: Scene, spots: Array, name: str, reach: float = REACH_M) -> list[Solid]:
    """Return things standing on free floor before the robot at some of its `spots` (k, 3), up to `reach` away [m].

    Raises:
        InputError: If there are no props of this name.
    """
    if name not in PROPS:
        raise unknown_name("kind of props", name, tuple(PROPS))
    found: list[Solid] = []
    for spot in spots:
        if not PROPS[name] or rng.random() < 0.3:
            continue
        place = before(rng, scene, spot, 0.5, reach)
        if place is not None:
            maker = PROPS[name][rng.integers(len(PROPS[name]))]
            found += maker(rng, float(place[0]), float(place[1]))
    return found


def before(rng: Generator, scene: Scene, spot: Array, room: float, reach: float = REACH_M) -> Array | None:
    """Return (2,) a place with `room` around it, in sight of a robot at `spot` (3,) and up to `reach` away [m]; None
    where there is none.
    """
    high = [solid for solid in scene.solids if solid.bottom < 1.0 < solid.top]
    for _ in range(12):
        bearing, distance = rng.uniform(-0.62, 0.62), rng.uniform(0.7, reach)
        turn = spot[2] + bearing
        place = spot[:2] + distance * np.array([np.cos(turn), np.sin(turn)])
        way = spot[:2] + np.linspace(0.0, 1.0, 24)[:, None] * (place - spot[:2])
        if scene.clearance(place, of_people=True) > room and all(solid.distance(way).min() > 0.0 for solid in high):
            return place
    return None
