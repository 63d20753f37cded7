"""People tracked by the laser, by the camera, and by both: MOTA, and returns kept out of the map.

The operator drives through the scene "lab" for five minutes; of its four people two never move. Three onboard stacks of
the environment, as `FollowEnv` makes them, get the same scans and frames: `laser` has no camera, `camera` has the
camera too and `people="camera"`, `both` has the camera and `people="tracker"`. What the camera sees is known 0.3 s
after the exposure.

People count within 6 m where the laser has at least 3 returns on one of their legs, or the camera sees at least half of
what the picture would show of them. `in view` are the people within the camera's angle of view, `all round` all.
Removed are returns that the robot keeps out of its map: of those on people within 6 m, of those on people who never
move, and of all others (which should stay). Counts are added up over the drives; the intervals (95 %) are Student's, of
the drives' own figures.

example:
  tagalong bench people-by-sensor --seeds 5 --first-seed 121

It gave with pairs of legs, the tracker before the present one (five drives of about 280 s):

    people from  MOTA in view          MOTA all round        people's returns      of who never moves    others
                                                             removed                                     removed
    laser        0.330 [0.045, 0.616]  0.295 [0.059, 0.531]  0.959 [0.941, 0.976]  0.964 [0.935, 0.993]  0.003
    camera       0.978 [0.973, 0.983]  0.479 [0.471, 0.488]  0.414 [0.391, 0.438]  0.364 [0.329, 0.398]  0.000
    both         0.988 [0.986, 0.990]  0.764 [0.758, 0.769]  0.989 [0.986, 0.991]  0.987 [0.983, 0.991]  0.003

By the laser hardly anybody was known who had not moved. The present tracker knows standing legs by their looks, too
(two drives of 15 s: all in view, by the laser alone). The camera alone forgets who is out of its sight; both together
start a person by the camera and keep it by its legs.
"""

import argparse
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...envs.episode_setup import OnboardStackFactory, world_config
from ...envs.follow_config import make_config
from ...envs.onboard.stack import Belief
from ...envs.recording.operator import Operator
from ...envs.world.truth import TrueState
from ...envs.world.world import World
from ...perception.metrics.clear_mot import ClearMot
from ...slam.errors import InputError
from ...slam.geometry import compose, inverse, transform_points
from ..console.arguments import at_least, positive, random_seed
from ..console.tables import format_table
from ..lab.statistics import Estimate, t_mean
from ..training.rgbd_truth import WholeBodies
from .people import LEAST_RETURNS, RANGE, returns_on_a_leg
from .results import write_results

Array = NDArray[np.float64]

STACKS: dict[str, dict[str, Any]] = {
    "laser": {},
    "camera": {"camera": "kinect-v2", "people": "camera"},
    "both": {"camera": "kinect-v2"},
}
"""By what people are known -> arguments of the environment."""
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
    """Counts for one onboard stack."""

    def __init__(self) -> None:
        self.in_view, self.all_round = ClearMot(), ClearMot()
        self.people, self.still, self.others = np.zeros(2), np.zeros(2), np.zeros(2)

    def add(
        self,
        truth: TrueState,
        belief: Belief,
        labels: NDArray[np.int32],
        seen: NDArray[np.bool_],
        half_view: float,
        never_move: NDArray[np.bool_],
    ) -> None:
        """Take what is believed after a scan.

        Args:
            truth: What is really so.
            belief: What is believed.
            labels: (k,) whose each return of the scan is; -1 for nobody's.
            seen: (n,) who counts.
            half_view: Half the camera's angle of view [rad].
            never_move: (n,) who stays where they are all the time.
        """
        centres, scan = truth.people.positions, belief.scan
        tracks = transform_points(compose(truth.robot_pose, inverse(belief.odometry)), belief.people.positions)
        around, ahead = (_near(truth, places, np.pi) for places in (centres, tracks))
        view, view_tracks = (_near(truth, places, half_view) for places in (centres, tracks))
        self.all_round.add(centres, seen & around, tracks, belief.people.ids, ahead)
        self.in_view.add(centres, seen & view, tracks, belief.people.ids, view_tracks)
        removed = ~belief.filtered.is_return[scan.is_return]
        near = (labels >= 0) & (scan.ranges[scan.is_return] <= RANGE)
        still = near & never_move[np.maximum(labels, 0)]
        for total, chosen in ((self.people, near), (self.still, still), (self.others, labels < 0)):
            total += (np.count_nonzero(chosen), np.count_nonzero(chosen & removed))


def _near(truth: TrueState, places: Array, half_view: float) -> NDArray[np.bool_]:
    """Return (n,) which `places` (n, 2) are within 6 m and `half_view` [rad] of the robot's front."""
    robot = transform_points(inverse(truth.robot_pose), places)
    return (np.hypot(*robot.T) <= RANGE) & (np.abs(np.arctan2(robot[:, 1], robot[:, 0])) <= half_view)


def drive(seed: int, seconds: float) -> dict[str, SensorJudge]:
    """Drive through one lab with three onboard stacks."""
    configs = {
        name: make_config({"scene": "lab", "leader": False, "slam": None, **given}) for name, given in STACKS.items()
    }
    camera = configs["both"].sensors.camera
    if camera is None:
        raise InputError('"both" must have a camera')
    world = World(world_config(configs["both"], {"route": "operator", "people": 0}), np.random.default_rng(seed))
    stacks = {
        name: OnboardStackFactory(config).make(world, np.random.default_rng(seed)) for name, config in configs.items()
    }
    judges = {name: SensorJudge() for name in STACKS}
    operator, whole = Operator(world.scene), WholeBodies(camera, world.model, len(world.truth.people))
    never_move = _who_never_moves(world)
    while world.time_s < seconds and not world.truth.tour_done:
        world.step(operator.command(world.truth))
        scan, truth, labels = world.scan(), world.truth, world.scan_labels()[world.scan().is_return]
        seen = returns_on_a_leg(truth, scan, labels) >= LEAST_RETURNS
        pixels = world.people_of(world.frame_geoms())
        counts = np.bincount(pixels[pixels >= 0], minlength=len(seen))
        seen |= (counts >= 40) & (counts >= 0.5 * whole.count(world.data, truth.robot_pose))
        for name, stack in stacks.items():
            belief = stack.update(scan, world.odometry)
            stack.look(world.frames)
            judges[name].add(truth, belief, labels, seen, camera.horizontal_fov / 2.0, never_move)
    return judges


def _who_never_moves(world: World) -> NDArray[np.bool_]:
    return np.array([len(errand.places) == 1 for errand in world.scene.errands])


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--seeds", type=at_least(1), default=5)
    parser.add_argument("--first-seed", type=random_seed, default=0)
    parser.add_argument("--seconds", type=positive, default=330.0, help="longest drive [s]")


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json."""
    drives = []
    for seed in range(options.first_seed, options.first_seed + options.seeds):
        drives.append(drive(seed, options.seconds))
        print(
            f"seed {seed}: " + "  ".join(f"{name} {drives[-1][name].in_view.mota:.3f}" for name in STACKS), flush=True
        )
    rows = {name: figures([judges[name] for judges in drives]) for name in STACKS}
    print(
        format_table(COLUMNS, [[name, *(value.text(digits=3) for value in row.values())] for name, row in rows.items()])
    )
    write_results(
        options, {"figures": {name: {k: value.to_dict() for k, value in row.items()} for name, row in rows.items()}}
    )
    return 0


def figures(judges: list[SensorJudge]) -> dict[str, Estimate]:
    """Return a row of the table: sums of counts over all drives, not means of ratios; intervals over the drives."""
    total, each = _figures(judges), [_figures([judge]) for judge in judges]
    row = {}
    for name, value in total.items():
        spread = t_mean([one[name] for one in each])
        row[name] = Estimate(value, value + spread.low - spread.mean, value + spread.high - spread.mean, spread.n)
    return row


def _figures(judges: list[SensorJudge]) -> dict[str, float]:
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
