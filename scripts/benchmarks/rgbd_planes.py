"""How many points of RGB-D frames get the plane that they are truly of, and what is left of the camera's tilt.

Frames 2 s apart of the operator's drive of five minutes through the scene "lab", 128 x 106 pixels: level, and with
pitch and roll of 2 degrees standard deviation, which is 3 degrees now and then; and other mounts. Truth is the thing
that each ray met; a point of a desk or seat is on its top if it is measured above the lower edge of the slab. What is
left of the tilt is the slope of the true ceiling, or else floor, after the correction.

example:
  tagalong bench rgbd-planes --seeds 3 --first-seed 100

One seed (100) gave (share of the points; tilt in degrees: the largest found, what was left in the median and 95 of 100
frames); the tilt that the simulator knows is taken away from the frames:

    camera         floor  ceiling  wall   table  chair  largest  left  95 %
    level          0.997  0.995    0.989  0.874  0.791  0.3      0.03  0.48
    tilted         0.997  0.995    0.989  0.872  0.771  8.7      0.04  0.36
    20 down        0.999  -        0.706  0.879  0.756  20.1     0.03  0.04
    45 down, high  0.999  -        0.000  0.980  0.752  45.0     0.01  0.03
    low            0.999  0.990    0.920  -      -      0.1      0.07  0.16

Where the camera looks down it sees neither a ceiling nor how high an upright plane is: walls are faces then. A camera
0.3 m high sees no top of a table.

What is wrong at tables and chairs lies at their edges: a third of their points have something else beside them.
"""

import argparse
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...envs.recording.operator import Operator
from ...envs.sensors.camera.config import RgbdConfig
from ...envs.sensors.lidar import LidarConfig
from ...envs.world.config import WorldConfig
from ...envs.world.world import World
from ...perception.rgbd.planes import PlaneFinder, Planes, Surface
from ..console.arguments import at_least, random_seed
from ..console.tables import format_table
from .results import write_results

KINDS = {
    "floor": Surface.FLOOR,
    "ceiling": Surface.CEILING,
    "wall": Surface.WALL,
    "table": Surface.TOP,
    "chair": Surface.TOP,
}
"""What is counted, and the surface that is right for it."""
LOWEST = {"table": 0.66, "chair": 0.43}
"""Points of these are on the top above this height [m]."""
MOUNTS = {
    "level": RgbdConfig(),
    "tilted": RgbdConfig(vibration=float(np.radians(2.0))),
    "20 down": RgbdConfig(pitch=float(np.radians(20.0))),
    "45 down, high": RgbdConfig(pitch=float(np.radians(45.0)), camera_height=1.8),
    "low": RgbdConfig(camera_height=0.3),
}
"""Name -> camera. What it is told of its tilt is taken away: the planes have to tell it."""
_EVERY_S = 2.0
_LONGEST_S = 330.0
_ENOUGH = 300


class Counts:
    """What is counted over frames.

    Attributes:
        right: Points of each kind with the right surface.
        whole: Points of each kind.
        slopes: What is left of the tilt, frame by frame [rad].
        tilts: The tilt that was corrected, the larger of pitch and roll, frame by frame [rad].
    """

    def __init__(self) -> None:
        self.right, self.whole = dict.fromkeys(KINDS, 0), dict.fromkeys(KINDS, 0)
        self.slopes: list[float] = []
        self.tilts: list[float] = []

    def add(self, planes: Planes, kinds: NDArray[np.str_]) -> None:
        """Count one frame, whose pixels truly show `kinds` (h, w)."""
        heights = np.nan_to_num(planes.points[..., 2], nan=-np.inf)
        for kind, surface in KINDS.items():
            mine = (kinds == kind) & (heights > LOWEST.get(kind, -np.inf)) & np.isfinite(heights)
            self.whole[kind] += int(mine.sum())
            self.right[kind] += int((planes.surface[mine] == surface).sum())
        for kind in ("ceiling", "floor"):
            mine = (kinds == kind) & np.isfinite(heights)
            if planes.tilt_known and mine.sum() >= _ENOUGH:
                points = planes.points[mine]
                design = np.column_stack((points[:, :2], np.ones(len(points))))
                slope = np.linalg.lstsq(design, points[:, 2], rcond=None)[0][:2]
                self.slopes.append(float(np.hypot(*slope)))
                self.tilts.append(float(np.abs(planes.tilt).max()))
                break

    def row(self) -> list[str]:
        """Return the shares, and median and 95th percentile of what is left of the tilt, as words."""
        shares = [f"{self.right[kind] / max(self.whole[kind], 1):.4f} ({self.whole[kind]})" for kind in KINDS]
        left = np.degrees(np.quantile(self.slopes, (0.5, 0.95))) if self.slopes else (np.nan, np.nan)
        return [*shares, f"{np.degrees(max(self.tilts, default=np.nan)):.1f}", f"{left[0]:.2f}", f"{left[1]:.2f}"]


def count_drive(seed: int, mount: RgbdConfig, counts: Counts, longest_s: float = _LONGEST_S) -> None:
    """Add the frames of one drive to `counts`.

    Args:
        seed: Of building and noise.
        mount: The camera.
        counts: Added to.
        longest_s: Where the drive is cut off [s].
    """
    camera, laser = replace(mount, rate_hz=1.0 / _EVERY_S), LidarConfig(beams=31)
    config = WorldConfig(scene="lab", route="operator", people=0, leader=False, lidar=laser, camera=camera)
    world = World(config, np.random.default_rng(seed))
    operator, finder, last = Operator(world.scene), PlaneFinder(), None
    kinds = ["floor", "ceiling", *(solid.kind for solid in world.scene.solids)]
    kinds = np.array([*kinds, *["mover"] * (world.model.ngeom - len(kinds)), "nothing"])
    while not operator.done(world.truth) and world.time_s < longest_s:
        world.step(operator.command(world.truth))
        if world.frames[-1] is not last:
            last = world.frames[-1]
            counts.add(finder.find(replace(last, tilt=None)), kinds[world.frame_geoms()])


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--seeds", type=at_least(1), default=3)
    parser.add_argument("--first-seed", type=random_seed, default=0)
    parser.add_argument("--mounts", nargs="+", choices=tuple(MOUNTS), default=list(MOUNTS), help="default: all")


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json."""
    results, rows = {}, []
    for name in options.mounts:
        counts = Counts()
        for seed in range(options.first_seed, options.first_seed + options.seeds):
            count_drive(seed, MOUNTS[name], counts)
        results[name] = vars(counts)
        rows.append([name, *counts.row()])
    print(format_table(["camera", *KINDS, "largest tilt", "left [deg]", "95 %"], rows))
    write_results(options, {"counts": results})
    return 0
