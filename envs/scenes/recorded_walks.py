"""Ways of bystanders as real people walked them, put into a scene where they fit."""

import os
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ...slam.errors import InputError
from ...slam.logs.pedestrians import RecordedWalk, read_pedestrians
from .cells import FreeSpace
from .polyline import arc_lengths
from .scene import Scene, Walk
from .tours import PERSON_CLEARANCE

Array = NDArray[np.float64]

WALKS = 12
"""Ways that are looked for."""
_ATTEMPTS = 1500
_SHORTEST, _LONGEST = 3.0, 1e4  # [m]; in the field of view of one camera nobody walks ten kilometres
_CELL = 0.1
_SLOWEST, _FASTEST = 0.3, 1.8


def with_recorded_walks(scene: Scene, path: str | os.PathLike[str], rng: np.random.Generator) -> Scene:
    """Return `scene` with ways of bystanders from the recording `path`.

    Each is a piece of at least 3 m of a recorded walk, smoothed, turned and moved to a drawn place so that it keeps
    clear of everything; whoever walks there goes at the recorded speed (0.3 to 1.8 m/s), to and fro, and makes room for
    others.

    Raises:
        InputError: If the file cannot be read, nothing of it fits, or the scene's people have a script.
    """
    if scene.errands:
        raise InputError(f"the people of the scene {scene.name} have a script: they cannot walk as recorded")
    file = Path(path)
    try:
        recorded = _read(file, file.stat().st_mtime_ns)
    except OSError as error:
        raise InputError(f"{file}: the walks cannot be read ({error.strerror})") from error
    clearance, space = _reachable(scene)
    rows, cols = np.nonzero(clearance > PERSON_CLEARANCE)
    places = (np.stack((cols, rows), axis=-1) + 0.5) * _CELL + np.asarray(space.origin, dtype=np.float64)
    walks: list[Walk] = []
    for _ in range(_ATTEMPTS if recorded else 0):
        drawn = recorded[int(rng.integers(len(recorded)))]
        turn, place = rng.uniform(-np.pi, np.pi), places[int(rng.integers(len(places)))]
        fitted = _fitted(drawn, float(turn), place, clearance, space)
        if fitted is not None:
            walks.append(fitted)
        if len(walks) == WALKS:
            break
    if not walks:
        raise InputError(f"{file}: no piece of {_SHORTEST} m of a walk fits into this {scene.name}")
    return replace(scene, walks=tuple(walks))


@lru_cache(maxsize=4)
def _read(file: Path, changed_ns: int) -> tuple[RecordedWalk, ...]:
    """Return the smoothed walks of a file; `changed_ns`, when it was written, makes changed files new."""
    walks = [walk.smoothed() for walk in read_pedestrians(file)]
    lengths = [float(arc_lengths(walk.points)[-1]) for walk in walks]
    if max(lengths) > _LONGEST:
        raise InputError(f"{file}: somebody walks {max(lengths):.3g} m in it, at most {_LONGEST:g} m are possible")
    return tuple(walk for walk, length in zip(walks, lengths, strict=True) if length >= _SHORTEST)


def _reachable(scene: Scene) -> tuple[Array, FreeSpace]:
    """Return the clearance [m] of the cells that people can reach from the route, 0 elsewhere, and the cells."""
    x0, y0, x1, y1 = scene.bounds
    shape = (int(np.ceil((y1 - y0) / _CELL)) + 1, int(np.ceil((x1 - x0) / _CELL)) + 1)
    space = FreeSpace(np.ones(shape, dtype=bool), _CELL, (x0, y0)).without(scene.solids)
    here = np.zeros(shape, dtype=bool)
    here[space.index(scene.route)] = True
    reached = ndimage.binary_propagation(here & space.free, mask=space.free)
    return np.where(reached, space.clearance, 0.0), space


def _fitted(walk: RecordedWalk, turn: float, place: Array, clearance: Array, space: FreeSpace) -> Walk | None:
    """Return the longest piece of `walk` that keeps clear when its middle is put on `place`; None if too short."""
    cos, sin = np.cos(turn), np.sin(turn)
    points = (walk.points - walk.points[len(walk.points) // 2]) @ np.array([[cos, sin], [-sin, cos]]) + place
    arcs = arc_lengths(points)
    dense = np.arange(0.0, arcs[-1], _CELL)
    way = np.stack([np.interp(dense, arcs, points[:, axis]) for axis in (0, 1)], axis=-1)
    inside = np.all((way > space.origin) & (way < np.array(space.origin) + np.array(clearance.shape[::-1]) * _CELL), 1)
    fits = inside & (clearance[space.index(way)] > PERSON_CLEARANCE)
    edges = np.flatnonzero(np.diff(np.concatenate(([False], fits, [False])).astype(np.int8)))
    if len(edges) == 0:
        return None
    lengths = edges[1::2] - edges[::2]
    best = int(lengths.argmax())
    if lengths[best] * _CELL < _SHORTEST:
        return None
    piece = slice(int(edges[2 * best]), int(edges[2 * best + 1]))
    speed = np.interp(dense[piece], arcs, np.gradient(arcs, walk.time_s))
    return Walk(points=way[piece], speed=np.clip(speed, _SLOWEST, _FASTEST))
