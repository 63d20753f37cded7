"""Where the known floor ends, and the way there (Yamauchi 1997), on the robot's own map."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ...envs.task.interface import FollowInterface, OwnMap
from ...slam.geometry import transform_points
from .grid_field import way_field

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
_EIGHT = np.ones((3, 3), dtype=bool)


@dataclass(frozen=True, kw_only=True)
class FrontierConfig:
    """What counts as a frontier and which ways are good.

    Attributes:
        cell: Side of a cell of the plan [m].
        radius: Nothing known may come nearer to the robot's centre than this [m]; None: by the robot's size.
        comfort: Ways are dearer up to this distance from things [m].
        tightness: Cost of a cell at `radius`, over that of a cell beyond `comfort`.
        smallest: Frontiers shorter than this are not worth a visit [m].
        reached: What is left unknown this near is for when nothing else is left: the robot is there already [m].
        seen_from: What is farther than this from any place the robot was does not count as explored [m].
    """

    cell: float = 0.1
    radius: float | None = None
    comfort: float = 0.6
    tightness: float = 4.0
    smallest: float = 0.5
    reached: float = 0.6
    seen_from: float = 4.0

    def radius_for(self, robot: FollowInterface) -> float:
        """Return `radius`; where it is None halfway between half the robot's width and half its diagonal [m].

        On its way a robot passes things with its narrow side, but for the bends, where its corners swing out.
        """
        halfway = 0.5 * (robot.half_width + math.hypot(robot.half_length, robot.half_width))
        return math.ceil(100.0 * halfway) / 100.0 if self.radius is None else self.radius


@dataclass(frozen=True, eq=False)
class FrontierWay:
    """A way to a frontier.

    Attributes:
        places: (n, 2) from the robot on, map frame [m].
        frontier: (2,) where it leads [m].
    """

    places: Array
    frontier: Array


def plan_way(
    own: OwnMap, visited: Array, given_up: Array, robot: FollowInterface, config: FrontierConfig
) -> FrontierWay | None:
    """Return the cheapest way to a frontier; None if there is none left.

    Args:
        own: The robot's map and pose.
        visited: (m, 2) where the robot was, map frame [m].
        given_up: (k, 2) places; within 0.5 m of them no frontier is tried again [m].
        robot: Says how large the robot is.
        config: What counts.
    """
    free, occupied, corner = coarse(own, visited, config)
    gap = np.asarray(ndimage.distance_transform_edt(~occupied)) * config.cell
    radius = config.radius_for(robot)
    comfort = max(config.comfort, radius + config.cell)  # a wide robot has some, too
    cost = 1.0 + config.tightness * np.clip((comfort - gap) / (comfort - radius), 0.0, 1.0)
    cost[~free | (gap < radius)] = np.inf
    here = np.floor((own.pose[:2] - corner) / config.cell).astype(int)
    row, col = int(np.clip(here[1], 0, free.shape[0] - 1)), int(np.clip(here[0], 0, free.shape[1] - 1))
    _free_the_robot(cost, free, row, col, radius, config)
    field, parent = np.empty_like(cost), np.empty(cost.shape, dtype=np.int32)
    way_field(cost, row, col, field, parent)
    cell = _cheapest_frontier(frontiers(free, occupied), field, corner, own.pose[:2], given_up, config)
    if cell is None:
        return None
    places = _trace(parent, cell, corner, config.cell)
    return FrontierWay(places, places[-1])


def coarse(own: OwnMap, visited: Array, config: FrontierConfig) -> tuple[Mask, Mask, Array]:
    """Return (rows, cols) free and (rows, cols) occupied cells of the plan, and (2,) the corner of cell [0, 0] [m].

    A cell is occupied if a cell of the map in it is; free if none is and one is free, near to where the robot was.
    """
    grid = own.map
    places = np.vstack((visited, own.pose[None, :2]))
    low = np.minimum(np.array(grid.origin), places.min(axis=0)) - config.cell
    size = np.array(grid.probability.shape[::-1]) * grid.resolution
    high = np.maximum(np.array(grid.origin) + size, places.max(axis=0)) + config.cell
    low = np.floor(low / config.cell) * config.cell
    cols, rows = np.ceil((high - low) / config.cell).astype(int)
    masks = [np.zeros((rows, cols), dtype=bool) for _ in range(3)]
    marks = (grid.cell_centres(grid.free), grid.occupied_points, places)
    for mask, points in zip(masks, marks, strict=True):
        index = np.floor((points - low) / config.cell).astype(int)
        mask[index[:, 1], index[:, 0]] = True
    free, occupied, was = masks
    near = np.asarray(ndimage.distance_transform_edt(~was)) * config.cell <= config.seen_from
    return free & ~occupied & near, occupied, low


def frontiers(free: Mask, occupied: Mask) -> NDArray[np.int32]:
    """Return (rows, cols) the number of the frontier that a cell belongs to, 0 for none: free, beside the unknown."""
    unknown = ~free & ~occupied
    edge = free & np.asarray(ndimage.binary_dilation(unknown, _EIGHT), dtype=bool)
    labels, _ = ndimage.label(edge, _EIGHT)  # pyright: ignore[reportGeneralTypeIssues]
    return np.asarray(labels, dtype=np.int32)


def _cheapest_frontier(
    labels: NDArray[np.int32], field: Array, corner: Array, here: Array, given_up: Array, config: FrontierConfig
) -> tuple[int, int] | None:
    """Return row and column of the frontier's cell with the cheapest way, or None if there is no frontier.

    Cells nearer than `reached` are for when there are no others: the robot is there already and has only to turn.
    """
    long_enough = np.bincount(labels.ravel()) * config.cell >= config.smallest
    cells = np.argwhere((labels > 0) & long_enough[labels] & np.isfinite(field))
    places = (cells[:, ::-1] + 0.5) * config.cell + corner
    refused = np.zeros(len(cells), dtype=bool)
    for place in given_up:
        refused |= np.hypot(*(places - place).T) < 0.5
    near = np.hypot(*(places - here).T) < config.reached
    for chosen in (~refused & ~near, ~refused & near):
        if chosen.any():
            of = cells[chosen]
            row, col = of[int(np.argmin(field[tuple(of.T)]))]
            return int(row), int(col)
    return None


def _free_the_robot(cost: Array, free: Mask, row: int, col: int, radius: float, config: FrontierConfig) -> None:
    """Let ways leave the place where the robot stands, even if it stands too near to something."""
    reach = int(np.ceil(radius / config.cell)) + 1
    window = (slice(max(row - reach, 0), row + reach + 1), slice(max(col - reach, 0), col + reach + 1))
    shut = ~np.isfinite(cost[window]) & free[window]
    cost[window][shut] = 3.0 * config.tightness
    cost[row, col] = min(cost[row, col], 3.0 * config.tightness)


def _trace(parent: NDArray[np.int32], cell: tuple[int, int], corner: Array, side: float) -> Array:
    """Return (n, 2) the places from the start to `cell` (row, col), map frame [m]."""
    cols = parent.shape[1]
    flat, cells = cell[0] * cols + cell[1], []
    while flat >= 0:
        cells.append((flat % cols, flat // cols))
        flat = int(parent[flat // cols, flat % cols])
    return (np.array(cells[::-1]) + 0.5) * side + corner


def place_ahead(places: Array, T_map_robot: Array, reach: float) -> Array:
    """Return (2,), robot frame: the place of a way (n, 2, map frame) that lies `reach` metres ahead of the robot."""
    nearest = int(np.argmin(np.hypot(*(places - T_map_robot[:2]).T)))
    rest = places[nearest:]
    steps = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(rest, axis=0).T))))
    chosen = rest[min(int(np.searchsorted(steps, reach)), len(rest) - 1)]
    x, y, theta = T_map_robot
    return transform_points((0.0, 0.0, -theta), (chosen - (x, y))[None])[0]
