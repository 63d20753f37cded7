"""Cells on pairs of scans from different places: along a drive, from different viewpoints, of four simulated rooms."""

import gzip
import time
from pathlib import Path
from typing import Any

import numpy as np

from ....slam.errors import InputError
from ....slam.geometry import between
from ....slam.logs.carmen import read_carmen
from ....slam.scan import LaserScan
from ...lab.scan_pairs import LOGS, Trial, view_pairs
from ...lab.statistics import share
from .contestants import make_contestant, quantiles

AT_TRUTH = "plicp from the reference"
NEAR_LINEAR, NEAR_ANGULAR = 0.20, 2.0
"""What counts as success between real pairs [m, deg]: the corrected poses are no better than that."""


def views(
    folder: str,
    building: str,
    matcher: str,
    turns: tuple[float, float],
    distances: tuple[float, float],
    guess: str,
    pairs: int,
) -> dict[str, Any]:
    """Return how often, and for which pairs, a matcher finds the pose of the corrected log, within 0.20 m and 2 deg.

    Args:
        folder: Of the logs.
        building: "intel" or "aces".
        matcher: Its name, or `AT_TRUTH`: PL-ICP that starts at the answer.
        turns: The headings differ by this much (from, to) [deg].
        distances: The places differ by this much (from, to) [m].
        guess: "none": the matcher is told that the robot stood still; "wrong": something up to 1 m off in x and y, with
            any heading.
        pairs: How many.
    """
    tool = make_contestant("plicp" if matcher == AT_TRUTH else matcher)
    low, high = np.radians(turns)
    asked = view_pairs(Path(folder), building, (float(low), float(high)), (distances[0], distances[1]), pairs, seed=0)
    good, believed, ambiguous, times = [], [], [], []
    for trial in asked:
        start = time.process_time()
        match = tool.match(trial.reference, trial.new, _guess(trial, matcher, guess))
        times.append(1e3 * (time.process_time() - start))
        error = between(trial.truth, match.pose)
        good.append(bool(np.hypot(error[0], error[1]) < NEAR_LINEAR and abs(error[2]) < np.radians(NEAR_ANGULAR)))
        believed.append(match.converged)
        ambiguous.append(match.ambiguous)
    return {
        "right": [int(g) for g in good],
        "success": share(good).to_dict(),
        "believed": share(believed).to_dict(),
        "right_of_believed": share([g for g, b in zip(good, believed, strict=True) if b]).to_dict(),
        "ambiguous": share(ambiguous).to_dict(),
        "timing": {"total_ms": quantiles(times)},
    }


def _guess(trial: Trial, matcher: str, guess: str) -> np.ndarray:
    if matcher == AT_TRUTH:
        return trial.truth
    return trial.guess if guess == "wrong" else np.zeros(3)


def consecutive(folder: str, building: str, matcher: str, scans: int) -> dict[str, Any]:
    """Return the iterations and the time of a matcher on consecutive scans of a drive, from the odometry."""
    drive, tool = read_carmen(Path(folder) / LOGS[building]), make_contestant(matcher)
    steps, agrees, times = [], [], []
    for k in range(1, min(scans, len(drive.scans))):
        guess = between(drive.odometry[k - 1], drive.odometry[k])
        start = time.process_time()
        match = tool.match(drive.scans[k - 1], drive.scans[k], guess)
        times.append(1e3 * (time.process_time() - start))
        steps.append(match.iterations)
        agrees.append(match.score)
    return {
        "beams": len(drive.scans[0]),
        "pairs": len(steps),
        "iterations": quantiles(steps),
        "agreeing_points": quantiles(agrees),
        "timing": {"total_ms": quantiles(times)},
    }


def known_rooms(file: str, matcher: str, repeats: int) -> dict[str, Any]:
    """Return the errors and the time of a matcher on the pairs of a pairs file (see `read_pairs`)."""
    tool, errors, steps, times = make_contestant(matcher), [], [], []
    pairs = read_pairs(Path(file))
    for _ in range(repeats):
        errors, steps = [], []
        for pair in pairs:
            start = time.process_time()
            match = tool.match(pair.reference, pair.new, pair.guess)
            times.append(1e3 * (time.process_time() - start))
            errors.append(between(pair.truth, match.pose))
            steps.append(match.iterations)
    error = np.array(errors)
    return {
        "pairs": len(pairs),
        "error_cm": quantiles(np.hypot(error[:, 0], error[:, 1]) * 1e2),
        "error_deg": quantiles(np.degrees(np.abs(error[:, 2]))),
        "iterations": quantiles(steps),
        "timing": {"total_ms": quantiles(times)},
    }


def read_pairs(file: Path) -> list[Trial]:
    """Return the pairs of a file `NAME.pairs.txt.gz`, their truth from `NAME.pairs_gt.txt` beside it.

    After a header, a pair a line: id, guess (x, y, theta), n, n ranges of the reference, n of the new scan; full
    circle, 0.12 to 8 m. The truth: id x y theta a line.

    Raises:
        InputError: If a line is not of that form, or the truth is missing.
    """
    truth_file = file.with_name(file.name.replace(".pairs.txt.gz", ".pairs_gt.txt"))
    if not truth_file.is_file():
        raise InputError(f"{file}: its truth {truth_file.name} is not beside it")
    truth = np.loadtxt(truth_file, ndmin=2)
    answers = {int(row[0]): row[1:4] for row in truth}
    pairs = []
    with gzip.open(file, "rt", encoding="utf-8") as stream:
        for number, line in enumerate(stream.read().splitlines()[1:], start=2):
            words = np.array(line.split(), dtype=np.float64)
            beams = int(words[4]) if len(words) > 4 else 0
            if beams < 1 or len(words) != 5 + 2 * beams or int(words[0]) not in answers:
                raise InputError(f"{file}:{number}: not a pair: id, guess, n, n + n ranges, with a truth")
            scans = (_full_circle(words[5 : 5 + beams]), _full_circle(words[5 + beams :]))
            pairs.append(Trial(*scans, words[1:4], answers[int(words[0])]))
    return pairs


def _full_circle(ranges: np.ndarray) -> LaserScan:
    bearings = np.linspace(-np.pi, np.pi, len(ranges), endpoint=False, dtype=np.float64)
    return LaserScan(np.where((ranges >= 8.0) | (ranges <= 0.0), np.inf, ranges), bearings, 0.12, 8.0)
