"""People tracked by the laser, by the camera, and by both: MOTA, and returns kept out of the map.

The operator drives through the scene "lab" for five minutes; of its four people two never move. Three trackers get the
same scans and frames: `laser` the legs alone, `camera` the RGB-D camera alone, `both` one tracker fed with both. The
camera's people come `--delay` seconds after the exposure and are placed by the odometry at the exposure.

People count within 6 m where the laser has at least 3 returns on one of their legs, or the camera sees at least half of
what the picture would show of them. `in view` are the people within the camera's angle of view, `all round` all.
Removed are returns within zeta of tracked people: of those on people within 6 m, of those on people who never move, and
of all others (which should stay).

Command: python -m tagalong.scripts.experiments.people_by_sensor --seeds 1 --first-seed 20 --out out/people-by-sensor

It gave, one drive of about 280 s (others removed: share of the returns on everything that is no person):

    people from  MOTA in view  MOTA all round  people's returns removed  of who never move  others removed
    laser        0.303         0.242           0.233                     0.248              0.000
    camera       0.981         0.490           0.406                     0.383              0.000
    both         0.982         0.771           0.895                     0.897              0.001

and with the camera's people 0.3 s late, another drive (--first-seed 21 --delay 0.3):

    laser        0.192         0.155           0.207                     0.192              0.000
    camera       0.979         0.518           0.441                     0.374              0.000
    both         0.992         0.772           0.890                     0.894              0.000

The laser alone knows nobody who has not moved; the camera alone forgets who is out of its sight; both together start a
person by the camera and keep it by its legs. What is missed are people beside and behind the robot whom the camera has
not seen yet, or whose legs were hidden since.
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...envs.camera.config import RgbdConfig
from ...envs.lidar import LidarConfig
from ...envs.operator import Operator
from ...envs.truth import TrueState
from ...envs.world import World
from ...envs.world_config import WorldConfig
from ...perception.config import PerceptionConfig
from ...perception.legs.detector import LegDetector
from ...perception.legs.forest import LegForest
from ...perception.people_filter import near_points, people_points_lidar
from ...perception.rgbd.people_finder import PeopleFinder
from ...perception.rgbd.planes import PlaneFinder
from ...perception.tracking.camera import NoLegs, SeenPeople
from ...perception.tracking.tracker import PeopleTracker, TrackerUpdate
from ...slam.errors import InputError
from ...slam.files import write_json
from ...slam.geometry import compose, inverse, transform_points
from ...slam.scan import LaserScan
from ..tables import format_table
from ..training.rgbd_truth import WholeBodies
from .clear_mot import ClearMot
from .hardware import describe_machine
from .people import LEAST_RETURNS, RANGE, returns_on_a_leg

Array = NDArray[np.float64]

SENSORS = ("laser", "camera", "both")
COLUMNS = (
    "people from",
    "MOTA in view",
    "MOTA all round",
    "misses",
    "false",
    "switches",
    "people's returns removed",
    "of who never move",
    "others removed",
)
_NEVER = 0.3
"""Who stays within this of where they were at first never moves [m]."""


class SensorJudge:
    """Counts for one tracker."""

    def __init__(self, config: PerceptionConfig) -> None:
        self._zeta = config.zeta
        self.in_view, self.all_round = ClearMot(), ClearMot()
        self.people, self.still, self.others = np.zeros(2), np.zeros(2), np.zeros(2)

    def add(
        self,
        truth: TrueState,
        update: TrackerUpdate,
        scan: LaserScan,
        labels: NDArray[np.int32],
        seen: NDArray[np.bool_],
        half_view: float,
        never_move: NDArray[np.bool_],
    ) -> None:
        """Take one scan; `labels` (k,) say whose each return is, `seen` (n,) who counts; `half_view` in rad."""
        centres = truth.people.positions
        tracks = transform_points(compose(truth.robot_pose, inverse(update.odometry)), update.people.positions)
        around, ahead = (_near(truth, places, np.pi) for places in (centres, tracks))
        view, view_tracks = (_near(truth, places, half_view) for places in (centres, tracks))
        self.all_round.add(centres, seen & around, tracks, update.people.ids, ahead)
        self.in_view.add(centres, seen & view, tracks, update.people.ids, view_tracks)
        points = people_points_lidar(update.people, update.odometry, scan)
        removed = near_points(scan, points, self._zeta)[scan.is_return]
        near = (labels >= 0) & (scan.ranges[scan.is_return] <= RANGE)
        still = near & never_move[np.maximum(labels, 0)]
        for total, chosen in ((self.people, near), (self.still, still), (self.others, labels < 0)):
            total += (np.count_nonzero(chosen), np.count_nonzero(chosen & removed))


def _near(truth: TrueState, places: Array, half_view: float) -> NDArray[np.bool_]:
    """Return (n,) which `places` (n, 2) are within 6 m and `half_view` [rad] of the robot's front."""
    robot = transform_points(inverse(truth.robot_pose), places)
    return (np.hypot(*robot.T) <= RANGE) & (np.abs(np.arctan2(robot[:, 1], robot[:, 0])) <= half_view)


def drive(seed: int, delay_s: float, seconds: float, config: PerceptionConfig) -> dict[str, SensorJudge]:
    """Drive through one lab with three trackers."""
    camera = RgbdConfig(mount=(0.0, 0.0, 0.0))
    setting = WorldConfig(
        scene="lab", route="operator", people=0, leader=False, camera=camera, lidar=LidarConfig(mount=(0.0, 0.0, 0.0))
    )
    world = World(setting, np.random.default_rng(seed))
    legs, planes, finder = (
        LegDetector(LegForest.load("simulation"), config.detector()),
        PlaneFinder(),
        PeopleFinder.load(),
    )
    trackers = {name: PeopleTracker(config, NoLegs() if name == "camera" else legs) for name in SENSORS}
    judges = {name: SensorJudge(config) for name in SENSORS}
    operator, whole = Operator(world.scene), WholeBodies(camera, world.model, len(world.truth.people))
    first, never_move = world.truth.people.positions, _who_never_moves(world)
    waiting: list[SeenPeople] = []
    while world.time_s < seconds and not world.truth.tour_done:
        world.step(operator.command(world.truth))
        scan, frame, truth, odometry = world.scan(), world.frames[-1], world.truth, world.odometry
        waiting.append(SeenPeople.at_exposure(finder.find(frame, planes.find(frame)), frame.time_s, odometry))
        ready = waiting.pop(0) if scan.time_s - waiting[0].time_s >= delay_s - 1e-9 else None
        labels = world.scan_labels()[scan.is_return]
        seen = returns_on_a_leg(truth, scan, labels) >= LEAST_RETURNS
        pixels = world.people_of(world.frame_geoms())
        counts = np.bincount(pixels[pixels >= 0], minlength=len(first))
        seen |= (counts >= 40) & (counts >= 0.5 * whole.count(world.data, truth.robot_pose))
        for name, tracker in trackers.items():
            update = tracker.update(scan, odometry, None if name == "laser" else ready)
            judges[name].add(truth, update, scan, labels, seen, camera.horizontal_fov / 2.0, never_move)
    return judges


def _who_never_moves(world: World) -> NDArray[np.bool_]:
    return np.array([len(errand.places) == 1 for errand in world.scene.errands])


def main(arguments: list[str] | None = None) -> int:
    """Run the experiment; see the module's docstring."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--delay", type=float, default=0.0, help="of the camera's results [s]")
    parser.add_argument("--seconds", type=float, default=330.0, help="longest drive [s]")
    parser.add_argument("--out", type=Path, help="folder for people_by_sensor.json")
    options = parser.parse_args(arguments)
    if options.seeds < 1 or options.delay < 0.0:
        raise InputError(f"need at least one seed and no negative delay, got {options.seeds} and {options.delay}")
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    drives = []
    for seed in seeds:
        drives.append(drive(seed, options.delay, options.seconds, PerceptionConfig()))
        print(
            f"seed {seed}: " + "  ".join(f"{name} {drives[-1][name].in_view.mota:.3f}" for name in SENSORS), flush=True
        )
    rows = {name: figures([judges[name] for judges in drives]) for name in SENSORS}
    print(format_table(COLUMNS, [[name, *(f"{value:.3f}" for value in row.values())] for name, row in rows.items()]))
    if options.out is not None:
        content: dict[str, Any] = {"options": vars(options), "figures": rows, "machine": describe_machine()}
        write_json(options.out / "people_by_sensor.json", content)
    return 0


def figures(judges: list[SensorJudge]) -> dict[str, float]:
    """Return a row of the table over all drives: sums of counts, not means of ratios."""

    def share(name: str, *kinds: str) -> float:
        counts = [getattr(judge, name) for judge in judges]
        return sum(getattr(c, kind) for c in counts for kind in kinds) / max(1, sum(c.truths for c in counts))

    removed = {
        name: np.sum([getattr(judge, name) for judge in judges], axis=0) for name in ("people", "still", "others")
    }
    errors = ("misses", "false", "switches")
    return {
        "mota_in_view": 1.0 - share("in_view", *errors),
        "mota_all_round": 1.0 - share("all_round", *errors),
        **{kind: share("all_round", kind) for kind in errors},
        **{f"removed_{name}": float(value[1] / max(1.0, value[0])) for name, value in removed.items()},
    }


if __name__ == "__main__":
    raise SystemExit(main())
