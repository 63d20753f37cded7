"""Success, accuracy and speed of the scan matchers on real logs (Cuzzocrea et al. 2022, section 3).

Run: python -m tagalong.scripts.experiments.scan_matching LOGS OUT [TRIALS]
"""

import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from ...slam.files import write_json
from ...slam.geometry import between
from ...slam.logs.carmen import read_carmen
from ...slam.matching import make_matcher
from ...slam.matching.global_matcher import GlobalConfig, GlobalMatcher
from ...slam.matching.lookup import build_lookup
from ...slam.matching.surfaces import near_points
from ...slam.search.exhaustive import exhaustive_search
from .cells import Cell, run_cells
from .hardware import describe_machine
from .scan_pairs import LOGS, is_success, read_scans, split_trials
from .statistics import share

BUILDINGS = ("intel", "belgioioso", "seattle", "sena")
MATCHERS = ("mbicp", "hglasm-g-small", "hglasm-g-medium", "hglasm-g-large", "global")
# translation [m] and rotation [deg] of the guess's error; NaN: any rotation
POINTS = ((0.57, 20.0), (0.57, 40.0), (0.57, 60.0), (0.57, 110.0), (2.12, float("nan")))


def success(
    folder: str, building: str, matcher: str, polish: bool, translation: float, rotation: float | None, trials: int
) -> dict[str, Any]:
    """Return success, errors of the successes and times [ms] of one matcher at one error of the guess."""
    tool = make_matcher(matcher, **({"polish": True} if polish else {}))
    angle = np.nan if rotation is None else np.radians(rotation)
    errors, times = [], []
    for trial in split_trials(read_scans(Path(folder), building), trials, translation, float(angle), seed=0):
        start = time.thread_time()
        match = tool.match(trial.reference, trial.new, trial.guess)
        times.append(time.thread_time() - start)
        errors.append(between(trial.truth, match.pose))
    good = is_success(np.array(errors))
    distance, turn = np.hypot(*np.array(errors)[good, :2].T) * 1e3, np.degrees(np.abs(np.array(errors)[good, 2]))
    return {
        "success": share(good.tolist()).to_dict(),
        "error_mm": _quantiles(distance),
        "error_deg": _quantiles(turn),
        "time_ms": _quantiles(np.array(times) * 1e3),
    }


def exhaustive(folder: str, building: str, trials: int) -> dict[str, Any]:
    """Return in how many trials the branch and bound equals the exhaustive search to the bit."""
    config = GlobalConfig()
    matcher, equal = GlobalMatcher(config), 0
    for trial in split_trials(read_scans(Path(folder), building), trials, 2.12, float("nan"), seed=1):
        limit = config.refinement.surfaces.range_limit
        points = near_points(trial.new, limit)
        grid = build_lookup(near_points(trial.reference, limit), config.lookup)
        found = matcher.search(trial.reference, points, trial.guess)
        equal += found.best == exhaustive_search(grid, points, trial.guess, config.window).best
    return {"equal": equal, "trials": trials}


def consecutive(folder: str, building: str, matcher: str, scans: int) -> dict[str, Any]:
    """Return the time [ms] and the iterations on consecutive scans, from the odometry."""
    drive, tool, times, steps = read_carmen(Path(folder) / LOGS[building]), make_matcher(matcher), [], []
    for k in range(1, min(scans, len(drive))):
        guess = between(drive.odometry[k - 1], drive.odometry[k])
        start = time.thread_time()
        match = tool.match(drive.scans[k - 1], drive.scans[k], guess)
        times.append(time.thread_time() - start)
        steps.append(match.iterations)
    return {"beams": len(drive.scans[0]), "time_ms": _quantiles(np.array(times) * 1e3), "iterations": np.mean(steps)}


def cells(folder: Path, trials: int) -> list[Cell]:
    """Return all cells; see the functions that they call."""
    made = []
    for building in BUILDINGS:
        common = {"folder": str(folder), "building": building}
        for matcher in MATCHERS:
            for translation, rotation in POINTS:
                for polish in (False, True) if matcher.startswith("hglasm") else (False,):
                    turn = None if np.isnan(rotation) else rotation
                    name = f"success/{building}/{matcher}{'+plicp' if polish else ''}/{translation}-{turn or 'any'}"
                    question = {"matcher": matcher, "polish": polish, "translation": translation, "rotation": turn}
                    made.append(Cell(name=name, function=success, arguments={**common, **question, "trials": trials}))
        made.append(Cell(name=f"exhaustive/{building}", function=exhaustive, arguments={**common, "trials": 50}))
        for matcher in ("plicp", "mbicp"):
            arguments = {**common, "matcher": matcher, "scans": 400}
            made.append(Cell(name=f"consecutive/{building}/{matcher}", function=consecutive, arguments=arguments))
    return made


def _quantiles(values: np.ndarray) -> dict[str, float]:
    if len(values) == 0:
        return {"median": float("nan"), "p95": float("nan")}
    return {"median": float(np.median(values)), "p95": float(np.quantile(values, 0.95))}


if __name__ == "__main__":
    logs, out = Path(sys.argv[1]), Path(sys.argv[2])
    results = run_cells(cells(logs, int(sys.argv[3]) if len(sys.argv) > 3 else 250), out)
    write_json(out / "summary.json", {"machine": describe_machine(), "results": results})
    for label, result in results.items():
        print(label, {key: value for key, value in result.items() if key != "error_deg"})
