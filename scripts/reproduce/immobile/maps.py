"""Figures of the maps: a desk, all kinds of cells, the plan, and the two maps side by side."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ....envs.scenes.scene import Scene
from ....slam.geometry import transform_points
from ....slam.logs.ros_map import write_ros_map
from ....slam.occupancy_map import OccupancyMap
from ...figures.canvas import BLUE, FAINT, GREEN, INK, ORANGE, RED, Colour, PlanCanvas, save_png, side_by_side
from ...figures.maps import FREE, UNKNOWN
from ..following.map_files import load_map
from ..report import Figure
from .exhibits import load_exhibit
from .measures import marked

Array = NDArray[np.float64]

LASER_BLUE = (90, 190, 225)
_RED_MARKS = ("a", "b", "c")
_FLAT_M = 0.5
_INSIDE, _BELOW, _BESIDE = np.array([0.28, 0.25]), np.array([0.2, -0.3]), np.array([-0.27, -0.15])


class DriveMaps:
    """What one drive left in its folder, drawn in the frame of the building.

    Args:
        files: The drive's folder.
        scene: Its building.
        T_world_map: (3,) the map's frame in the building.
    """

    def __init__(self, files: Path, scene: Scene, T_world_map: Array) -> None:
        self._files, self._scene, self._T_world_map = files, scene, T_world_map
        self._path = load_map(files / "conventional.npz")[1]
        self.exhibit, self._walls, self._things = load_exhibit(files / "exhibits.npz")

    def grid(self, name: str, layer: str = "map") -> OccupancyMap:
        """Return one of the maps."""
        stem = name if name == "conventional" else f"{name.replace(' ', '_')}_{layer}"
        return load_map(self._files / f"{stem}.npz")[0]

    def export(self, folder: Path, name: str) -> None:
        """Write the map and, beside it, the layer of movable things: `folder`/`name`.yaml and `name`_movable.yaml."""
        write_ros_map(folder / f"{name}.yaml", self.grid("immobile"))
        write_ros_map(folder / f"{name}_movable.yaml", self.grid("immobile", "movable"))

    def draw_desk(self, folder: Path) -> Figure:
        """Draw Fig. 6: the desks, with and without the camera."""
        tables = np.concatenate([s.outline() for s in self._scene.solids if s.kind == "table"])
        middle = tables[np.abs(tables - np.median(tables, axis=0)).max(axis=1) < 2.0]
        low, high = middle.min(axis=0) - 0.5, middle.max(axis=0) + 0.5
        pictures = []
        for title, name in (("laser and camera", "immobile"), ("laser alone", "laser")):
            canvas = PlanCanvas(low, high, title, size=(620, 420))
            self._kinds(canvas, self.grid(name), self.grid(name, "laser"))
            for solid in self._scene.solids:
                if solid.kind in ("table", "chair"):
                    canvas.line(np.vstack((solid.outline(), solid.outline()[:1])), ORANGE, 1.5)
            canvas.legend([("by camera", BLUE), ("by laser", LASER_BLUE), ("truly", ORANGE)])
            pictures.append(canvas.finished())
        return self._saved(
            folder / "fig6_desk.png",
            side_by_side(pictures),
            "Fig. 6: four desks and their chairs. The laser sees legs; the camera marks their tops where it saw them.",
        )

    def draw_integrated(self, folder: Path) -> Figure:
        """Draw Fig. 7: the integrated map by what marked each cell."""
        canvas = self._canvas("laser and camera in one map")
        self._kinds(canvas, self.grid("immobile"), self.grid("immobile", "laser"))
        movable = self.grid("immobile", "movable")
        self._cells(canvas, movable.cell_centres(movable.probability > 0.5), movable.resolution, GREEN)
        names = ("wall", RED), ("other, by camera", BLUE), ("by laser", LASER_BLUE), ("movable", GREEN)
        canvas.legend([*names, ("free", FREE), ("unknown", UNKNOWN)])
        caption = "Fig. 7: what marked each cell. Green is the layer of movable things, which are not in the map."
        return self._saved(folder / "fig7_integrated.png", canvas.finished(), caption)

    def draw_plan(self, folder: Path) -> Figure:
        """Draw Fig. 8: the building, its marks and the robot's path."""
        canvas = self._canvas("the laboratory")
        low, high = self._bounds()
        canvas.polygon([low, (high[0], low[1]), high, (low[0], high[1])], FREE)
        for outline in self._scene.outlines:
            wall = outline.kind == "wall"
            canvas.polygon(outline.polygon, INK if wall else FAINT, INK)
        canvas.line(self._world(self._path[:, :2]), GREEN, 3.0)
        self._marks(canvas)
        canvas.legend([("path of the robot", GREEN), ("things", FAINT), ("a b c: hidden corners, door", RED)])
        return self._saved(folder / "fig8_plan.png", canvas.finished(), "Fig. 8: plan, path, marks a to g.")

    def draw_both(self, folder: Path) -> Figure:
        """Draw Fig. 9: the immobile-area map and the conventional one, with the marks."""
        pictures = []
        for title, name in (("a: immobile area, laser and camera", "immobile"), ("b: occupancy grid", "conventional")):
            grid = self.grid(name)
            canvas = self._canvas(title)
            self._cells(canvas, grid.cell_centres(grid.free), grid.resolution, FREE)
            self._cells(canvas, grid.occupied_points, grid.resolution, INK)
            self._marks(canvas)
            pictures.append(canvas.finished())
        caption = "Fig. 9: both maps at the end of the same drive, on the same poses."
        return self._saved(folder / "fig9_maps.png", side_by_side(pictures), caption)

    def _kinds(self, canvas: PlanCanvas, grid: OccupancyMap, laser: OccupancyMap) -> None:
        """Draw the cells of `grid`, coloured by who marked them."""
        canvas.polygon(self._frame_of(canvas), UNKNOWN)
        self._cells(canvas, grid.cell_centres(grid.free), grid.resolution, FREE)
        cells = grid.occupied_points
        wall, by_laser = _among(cells, self._walls, grid.resolution), marked(laser, cells)
        for mine, colour in ((~by_laser & ~wall, BLUE), (by_laser & ~wall, LASER_BLUE), (wall, RED)):
            self._cells(canvas, cells[mine], grid.resolution, colour)

    def _cells(self, canvas: PlanCanvas, centres: Array, side: float, colour: Colour) -> None:
        """Fill the cells with `centres` (n, 2), map frame, in pieces: the map is turned against the picture."""
        steps = (np.arange(_PIECES) + 0.5) / _PIECES - 0.5
        offsets = side * np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
        pieces = (centres[:, None] + offsets).reshape(-1, 2)
        canvas.cells(self._world(pieces), _OVERLAP * side / _PIECES, colour, _COVER / _PIECES)

    def _canvas(self, title: str) -> PlanCanvas:
        canvas = PlanCanvas(*self._bounds(), title, size=(900, 620))
        canvas.polygon(self._frame_of(canvas), UNKNOWN)
        return canvas

    def _frame_of(self, canvas: PlanCanvas) -> Array:
        low, high = self._bounds()
        return np.array([low, (high[0], low[1]), high, (low[0], high[1])])

    def _bounds(self) -> tuple[Array, Array]:
        bounds = np.array(self._scene.bounds)
        return bounds[:2] - 0.3, bounds[2:] + 0.3

    def _marks(self, canvas: PlanCanvas) -> None:
        for name, polygon in self._scene.marks.items():
            colour = RED if name in _RED_MARKS else GREEN
            canvas.line(np.vstack((polygon, polygon[:1])), colour, 2.5)
            low, high = polygon.min(axis=0), polygon.max(axis=0)
            flat = high[1] - low[1] < _FLAT_M
            beside = np.array([low[0], high[1]]) + _BESIDE  # not on the cells that somebody left
            inside = low + (_BELOW if flat else _INSIDE)
            canvas.label(inside if name in _RED_MARKS else beside, name, colour)

    def _world(self, points: Array) -> Array:
        return transform_points(self._T_world_map, points)

    def _saved(self, path: Path, image: Image.Image, caption: str) -> Figure:
        save_png(path, image)
        return Figure(file=path, caption=caption)


_COVER = 4.0
_PIECES, _OVERLAP = 4, 1.3


def _among(cells: Array, others: Array, resolution: float) -> NDArray[np.bool_]:
    """Return (n,) which of `cells` (n, 2) are among `others` (m, 2)."""
    numbers = {tuple(cell) for cell in np.floor(others / resolution).astype(int).tolist()}
    return np.array([tuple(cell) in numbers for cell in np.floor(cells / resolution).astype(int).tolist()], dtype=bool)
