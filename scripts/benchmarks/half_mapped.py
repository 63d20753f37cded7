"""A robot that is carried away while its map is half done: to where it has been, or to where nobody was yet."""

import copy
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from ...slam.engine import make_slam
from ...slam.geometry import between, compose
from ...slam.logs.drive import RecordedDrive
from ...slam.runner import run_slam
from .fault_drives import fault_drive
from .kidnapped_legs import Leg, RecordedLegs

Array = NDArray[np.float64]

DRIVES = ("belgioioso", "intel", "aces", "fhw", "csail")
LEG_SCANS = 30  # of a leg
LINEAR, ANGULAR = 0.5, np.radians(10.0)
_MAPPED = 0.6  # share of a drive, of which every second scan is mapped
_ON_MAP = 1.5  # [m] from the nearest scan that was mapped


def carried_off_a_half_map(folder: str, drive: str, seed: int, first: int, trials: int) -> dict[str, Any]:
    """Return what became of trials in which graph SLAM maps a part of a drive and is carried to a leg of the rest.

    The legs are of scans that were not mapped, anywhere on the whole drive. Where the robot is on its map is told by
    where the nearest mapped scan lies there, and by how SLAM of the whole drive has the two: so a map that is bent as
    a whole counts as right.

    Args:
        folder: Of the logs.
        drive: Of `fault_drives.LOGS`, or KIND-SEED, a drawn world.
        seed: Of all trials.
        first: Number of the first trial; each has random numbers of its own.
        trials: How many.

    Returns:
        Lists with a value a trial: `on_map` (whether the leg ends there), `found_at` (scan from which on the robot was
        sure and right to the end; None: it was not), `error_m`, `error_deg` (None: not sure at the end), `wrong` (sure
        at the end, and not right).
    """
    recording = fault_drive(folder, drive).recording
    whole = run_slam(make_slam("cartographer"), recording).trajectory
    kept = np.arange(0, int(_MAPPED * len(recording)), 2)
    part = RecordedDrive(recording.odometry[kept], [recording.scans[k] for k in kept.tolist()], None, drive)
    mapped = run_slam(make_slam("cartographer"), part)
    legs = RecordedLegs(recording, whole, np.arange(len(recording)) % 2 == 1)
    last, places = Leg(part.odometry[-1:], part.scans[-1:], whole[kept[-1:]]), KDTree(whole[kept, :2])
    result: dict[str, Any] = {"found_at": [], "error_m": [], "error_deg": [], "wrong": [], "on_map": []}
    for trial in range(first, first + trials):
        leg = legs.draw(LEG_SCANS, np.random.default_rng([seed, trial])).after(last)
        robot = copy.deepcopy(mapped.engine, {id(scan): scan for scan in part.scans})  # they never change: no copies
        updates = [robot.update(odometry, scan) for odometry, scan in zip(leg.odometry, leg.scans, strict=True)]
        off, nearest = places.query(leg.truth[:, :2])
        truth = compose(mapped.trajectory[nearest], between(whole[kept[nearest]], leg.truth))
        judged = judge([u.pose if u.located else None for u in updates], truth, LINEAR, ANGULAR)
        for key, value in {**judged, "on_map": bool(off[-1] < _ON_MAP)}.items():
            result[key].append(value)
    return result


def judge(poses: list[Array | None], truth: Array, linear: float, angular: float) -> dict[str, Any]:
    """Return what became of a robot that told its pose, or None where it was not sure, at each of n scans.

    Args:
        poses: (3,) each, or None.
        truth: (n, 3).
        linear: A pose is right within this distance [m] ...
        angular: ... and this angle [rad].
    """
    errors = [None if pose is None else between(true, pose) for true, pose in zip(truth, poses, strict=True)]
    good = [e is not None and bool(np.hypot(e[0], e[1]) <= linear and abs(e[2]) <= angular) for e in errors]
    last, scans = errors[-1], len(poses)
    found = scans - next((k for k, fine in enumerate(reversed(good)) if not fine), scans)
    return {
        "found_at": found + 1 if found < scans else None,
        "error_m": None if last is None else float(np.hypot(last[0], last[1])),
        "error_deg": None if last is None else float(np.degrees(abs(last[2]))),
        "wrong": last is not None and not good[-1],
    }
