"""Any ROS map as a building: what is occupied becomes walls, what is free is walked on."""

from functools import lru_cache
from pathlib import Path

import numpy as np

from ...slam.errors import InputError
from ...slam.logs.ros_map import read_ros_map
from ...slam.occupancy_map import OccupancyMap
from .cells import FreeSpace, merged_boxes, regions, walls_around
from .office_layout import OfficeLayout, Rectangle
from .request import SceneRequest
from .scene import Scene
from .tours import PERSON_CLEARANCE, ROBOT_CLEARANCE, FloorPlan, draw_tour, toured
from .ways import WayPlanner

WALKS = 10
"""Ways that bystanders walk on."""
COARSEST = 0.2
"""Largest side of a cell from which a building can be made [m]."""
_LARGEST = 16_000_000
_DRAWS = 10  # of tours; of 1178 draws on the built-in plan 7 found none
_WALL_M = 0.25
_MARGIN = 0.5


def floor_plan(rng: np.random.Generator, request: SceneRequest) -> Scene:
    """Return the building of the map `request.floor_plan`, or the built-in plan where that is None.

    Occupied cells next to free space are walls, merged into boxes. Tours and walks keep to free cells,
    `ROBOT_CLEARANCE` and `PERSON_CLEARANCE` from all others; what is unknown stops no laser beam, but nobody walks
    there. The building is the same for every seed, tours and walks are drawn. Routes: "tour" and "back".

    Raises:
        InputError: If the map cannot be read, is too coarse or too large, or leaves no room for a tour.
    """
    if request.floor_plan is None:
        plan, planner, walking = _built_in()
    else:
        path = Path(request.floor_plan)
        try:
            changed = path.stat().st_mtime_ns
        except OSError as error:
            raise InputError(f"{path}: the map cannot be read ({error.strerror})") from error
        plan, planner, walking = _from_file(path, changed)
    tours = (draw_tour(planner, rng) for _ in range(_DRAWS))  # a draw of ends that lie together has none
    tour = next((tour for tour in tours if tour is not None), None)
    if tour is None:
        raise InputError(
            f"{request.floor_plan or 'the built-in plan'}: no tour of 14 m or more that keeps {ROBOT_CLEARANCE} m from "
            f"everything; the largest free part for the robot's middle has {planner.area:.1f} m^2"
        )
    return toured(plan, tour, rng, request.route, WALKS, walking)


@lru_cache(maxsize=4)
def _from_file(path: Path, changed_ns: int) -> tuple[FloorPlan, WayPlanner, WayPlanner]:
    """Return the plan of a map and its planners; `changed_ns`, when the file was written, makes changed maps new."""
    grid = read_ros_map(path)
    if grid.resolution > COARSEST:
        raise InputError(f"{path}: cells may be {COARSEST} m at most, got {grid.resolution} m")
    if grid.probability.size > _LARGEST:
        raise InputError(f"{path}: maps of up to {_LARGEST} cells are supported, got {grid.probability.size}")
    if not grid.free.any():
        raise InputError(f"{path}: the map has no free cell")
    return _plan(_cropped(grid))


@lru_cache(maxsize=1)
def _built_in() -> tuple[FloorPlan, WayPlanner, WayPlanner]:
    """Return a small day clinic: a waiting room, a corridor round the corner, and treatment rooms."""
    layout = OfficeLayout(
        corridors=(Rectangle(0.0, 0.0, 14.0, 2.2), Rectangle(11.8, 0.0, 14.0, 9.0)),
        rooms=(
            Rectangle(0.0, 2.35, 5.2, 9.0),
            Rectangle(5.35, 2.35, 11.65, 5.5),
            Rectangle(5.35, 5.65, 11.65, 9.0),
            Rectangle(0.0, -4.65, 6.0, -0.15),
            Rectangle(6.15, -4.65, 14.0, -0.15),
        ),
        doors=(
            Rectangle(2.0, 2.2, 3.4, 2.35),
            Rectangle(7.0, 2.2, 8.3, 2.35),
            Rectangle(5.2, 6.6, 5.35, 7.9),
            Rectangle(11.65, 3.2, 11.8, 4.5),
            Rectangle(11.65, 6.6, 11.8, 7.9),
            Rectangle(3.6, -0.15, 4.9, 0.0),
            Rectangle(6.0, -3.2, 6.15, -1.9),
            Rectangle(10.6, -0.15, 11.9, 0.0),
        ),
    )
    space = layout.painted()
    free = space.free.copy()
    for low, high in (((1.0, 7.6), (1.9, 8.5)), ((7.6, 6.4), (8.2, 7.2)), ((9.0, -2.9), (10.2, -2.2))):
        (row0, row1), (col0, col1) = space.index(np.array([low, high]))
        free[row0:row1, col0:col1] = False
    probability = np.where(free, 0.0, np.where(walls_around(free, 3), 1.0, np.nan)).astype(np.float32)
    return _plan(OccupancyMap(probability, space.resolution, space.origin))


def _plan(grid: OccupancyMap) -> tuple[FloorPlan, WayPlanner, WayPlanner]:
    space = FreeSpace(grid.free, grid.resolution, grid.origin)
    planner = WayPlanner(space, ROBOT_CLEARANCE)
    near = walls_around(grid.free, max(1, round(_WALL_M / grid.resolution)))
    solids = tuple(merged_boxes(grid.occupied & near, grid.resolution, grid.origin))
    if not solids:
        raise InputError("a floor plan needs occupied cells next to its free ones, got none")
    plan = FloorPlan(name="floor_plan", solids=solids, space=space, half_width=0.8)
    return plan, planner, WayPlanner(space, PERSON_CLEARANCE)


def _cropped(grid: OccupancyMap) -> OccupancyMap:
    """Return the part of the map round its free cells, less specks of free space that hang together with nothing."""
    region = regions(grid.free)
    sizes = np.bincount(region.ravel())
    sizes[0] = 0
    kept = sizes[region] >= 0.02 * sizes.max()
    rows, cols = np.nonzero(kept & grid.free)
    margin = round(_MARGIN / grid.resolution)
    row0, col0 = max(0, int(rows.min()) - margin), max(0, int(cols.min()) - margin)
    part = grid.probability[row0 : rows.max() + 1 + margin, col0 : cols.max() + 1 + margin].copy()
    inside = kept[row0 : rows.max() + 1 + margin, col0 : cols.max() + 1 + margin]
    part[(part < grid.free_threshold) & ~inside] = np.nan
    origin = (grid.origin[0] + col0 * grid.resolution, grid.origin[1] + row0 * grid.resolution)
    return OccupancyMap(part, grid.resolution, origin, grid.occupied_threshold, grid.free_threshold)
