"""What kind of result a file holds, told by its content, and how such results are judged against each other."""

import os
from dataclasses import asdict, dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError, shown
from ...slam.geometry import compose, inverse, transform_points
from ...slam.logs.carmen import read_carmen
from ...slam.logs.drive_folder import read_feet
from ...slam.logs.relations import read_readings, read_relations
from ...slam.logs.ros_map import read_ros_map
from ...slam.logs.text import finite_numbers, numbered_lines
from ...slam.logs.tum import read_tum
from ...slam.quality.cells import common_cells, dynamic_residue
from ...slam.quality.relations import score_relations
from ...slam.quality.score import score_map
from ...slam.quality.trajectory import absolute_error, associate, relative_error

Kind = Literal["trajectory", "relations", "map", "log"]
Rows = list[tuple[str, str, str]]

_CARMEN_WORDS = {"FLASER", "RLASER", "ROBOTLASER1", "ODOM", "PARAM", "NEFF", "SYNC"}
_LINES_LOOKED_AT, _MOST_COLUMNS = 200, 8


@dataclass(frozen=True)
class Judgement:
    """A result judged against a reference.

    Attributes:
        rows: (quantity, value, unit), to print.
        metrics: The same and more by name, to write as JSON.
    """

    rows: Rows
    metrics: dict[str, Any]


@dataclass(frozen=True, kw_only=True)
class ScoringOptions:
    """What a judgement may need beside the two files."""

    readings: Path | None = None
    """Odometry of all readings of the log, for relations between readings."""
    people: Path | None = None
    """True feet of people (NAME.people.npz), for the dynamic residue. Where NAME.gt.tum stands beside it and
    trajectory.tum beside the estimated map, they tell where the feet are in that map; without them the feet are taken
    as they are, in the frame of the reference map."""
    max_gap_s: float = 0.02
    """Poses of two trajectories belong together when their times differ by at most this [s]."""


def kind_of(path: str | os.PathLike[str]) -> Kind:
    """Return what a file holds.

    Raises:
        InputError: If it cannot be read or is none of the four kinds.
    """
    lines = (line.strip() for _, line in islice(numbered_lines(path), _LINES_LOOKED_AT))
    words = [
        line.split(maxsplit=_MOST_COLUMNS) for line in lines if line and not line.startswith("#") and line != "---"
    ]
    if not words:
        raise InputError(f"{os.fspath(path)}: is empty")
    if words[0][0] in _CARMEN_WORDS:
        return "log"
    if words[0][0].endswith(":"):
        return "map"
    try:
        numbers = [finite_numbers(line, "") for line in words]
    except InputError:
        numbers = []
    columns = {len(line) for line in numbers}
    if columns == {5}:
        return "relations"
    if columns == {8}:
        # both have eight columns; only in a trajectory the last four are a quaternion everywhere
        lengths = np.linalg.norm(np.array(numbers)[:, 4:], axis=1)
        return "trajectory" if np.all(np.abs(lengths - 1.0) < 1e-2) else "relations"
    raise InputError(
        f"{os.fspath(path)}: neither a TUM trajectory, nor relations, nor a CARMEN log, nor a map.yaml; "
        f"it begins with {shown(' '.join(words[0]), 40)}"
    )


def judge(estimate: Path, reference: Path, options: ScoringOptions | None = None) -> Judgement:
    """Judge one file by another: trajectory by trajectory, log or relations; map by map.

    Raises:
        InputError: If the two do not go together, or one of them cannot be read.
    """
    options = options or ScoringOptions()
    kinds = kind_of(estimate), kind_of(reference)
    if options.people is not None and kinds[1] != "map":
        raise InputError(f"true feet of people judge a map; {reference.name} is none")
    if options.readings is not None and kinds[1] != "relations":
        raise InputError(f"odometry of readings goes with relations; {reference.name} holds none")
    if kinds == ("map", "map"):
        return _judge_map(estimate, reference, options)
    if kinds == ("trajectory", "relations"):
        return _judge_relations(estimate, reference, options)
    if kinds in (("trajectory", "trajectory"), ("trajectory", "log")):
        return _judge_trajectory(estimate, reference, kinds[1], options)
    one, other = (kind if kind == "relations" else f"a {kind}" for kind in kinds)
    raise InputError(
        f"{one} cannot be judged by {other} ({estimate.name}, {reference.name}); possible: trajectory by "
        "trajectory, log or relations; map by map"
    )


def _judge_trajectory(estimate: Path, reference: Path, kind: Kind, options: ScoringOptions) -> Judgement:
    est, ref, matched = _paired(estimate, reference, kind, options)
    absolute = absolute_error(est, ref)
    rows = [
        ("poses compared", str(matched), ""),
        ("ATE rmse", f"{100 * absolute.translation.rmse:.2f}", "cm"),
        ("ATE mean", f"{100 * absolute.translation.mean:.2f}", "cm"),
        ("ATE max", f"{100 * absolute.translation.max:.2f}", "cm"),
        ("heading error mean", f"{absolute.rotation.mean:.3f}", "deg"),
        ("heading error max", f"{absolute.rotation.max:.3f}", "deg"),
    ]
    metrics: dict[str, Any] = {
        "kind": "trajectory",
        "poses": matched,
        "ate_m": asdict(absolute.translation),
        "ate_deg": asdict(absolute.rotation),
        "T_ref_est": absolute.T_ref_est.tolist(),
    }
    if matched > 1:
        relative = relative_error(est, ref)
        rows += [
            ("RPE rmse, pose to pose", f"{100 * relative.translation.rmse:.3f}", "cm"),
            ("RPE rotation rmse", f"{relative.rotation.rmse:.3f}", "deg"),
        ]
        metrics |= {"rpe_m": asdict(relative.translation), "rpe_deg": asdict(relative.rotation)}
    return Judgement(rows, metrics)


def _paired(
    estimate: Path, reference: Path, kind: Kind, options: ScoringOptions
) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    """Return poses (k, 3) and (k, 3) that belong together, and k: by order for a log, by time for a trajectory."""
    est = read_tum(estimate)
    if kind == "log":
        poses = read_carmen(reference).reference
        if poses is None:
            raise InputError(f"{reference}: the log holds odometry only, no corrected poses to compare with")
        if len(poses) != len(est):
            raise InputError(f"{estimate}: needs one pose a scan of the log, got {len(est)} for {len(poses)}")
        return est.poses, poses, len(poses)
    ref = read_tum(reference)
    a, b = associate(est.times_s, ref.times_s, options.max_gap_s)
    if len(a) < min(3, len(est)):
        raise InputError(
            f"{estimate}: only {len(a)} of {len(est)} poses have a reference within {options.max_gap_s} s; "
            "are the clocks the same?"
        )
    return est.poses[a], ref.poses[b], len(a)


def _judge_relations(estimate: Path, reference: Path, options: ScoringOptions) -> Judgement:
    readings = None if options.readings is None else read_readings(options.readings)
    error = score_relations(read_tum(estimate), read_relations(reference), readings)
    metres, degrees = error.translation, error.rotation
    between_scans = "interpolated in time" if readings is None else "by odometry"
    rows = [
        (f"relations, poses between scans {between_scans}", str(metres.count), ""),
        ("relations skipped", str(error.skipped), ""),
        ("translation mean", f"{metres.mean:.4f}", "m"),
        ("translation sd", f"{metres.std:.4f}", "m"),
        ("translation max", f"{metres.max:.3f}", "m"),
        ("rotation mean", f"{degrees.mean:.3f}", "deg"),
        ("rotation sd", f"{degrees.std:.3f}", "deg"),
        ("rotation max", f"{degrees.max:.2f}", "deg"),
    ]
    return Judgement(rows, {"kind": "relations", **asdict(error)})


def _judge_map(estimate: Path, reference: Path, options: ScoringOptions) -> Judgement:
    est, ref = read_ros_map(estimate), read_ros_map(reference)
    score = score_map(est, ref)
    if options.people is not None:
        feet = _feet_on_reference(options.people, estimate, score.registration.T_ref_est)
        score = replace(score, residue=dynamic_residue(common_cells(est, ref, score.registration.T_ref_est), feet))
    fit, cells = score.registration, score.cells
    rows = [
        ("ADNN, reference to estimate", f"{100 * score.adnn.mean_m:.2f}", "cm"),
        ("  largest distance", f"{100 * score.adnn.max_m:.1f}", "cm"),
        ("ghosts, estimate to reference", f"{100 * score.ghosts.mean_m:.2f}", "cm"),
        ("  largest distance", f"{100 * score.ghosts.max_m:.1f}", "cm"),
        ("precision of occupied cells", f"{100 * cells.precision:.2f}", "%"),
        ("recall of occupied cells", f"{100 * cells.recall:.2f}", "%"),
        ("F1 of occupied cells", f"{100 * cells.f1:.2f}", "%"),
        ("IoU of occupied cells", f"{100 * cells.iou:.2f}", "%"),
        ("free space covered", f"{100 * cells.free_coverage:.2f}", "%"),
        ("estimate moved by", f"{np.hypot(fit.T_ref_est[0], fit.T_ref_est[1]):.3f}", "m"),
        ("estimate turned by", f"{np.rad2deg(fit.T_ref_est[2]):.3f}", "deg"),
    ]
    if score.residue is not None:
        rows.append(("dynamic residue", str(score.residue.cells), "cells"))
    return Judgement(rows, {"kind": "map", **score.to_dict()})


def _feet_on_reference(people: Path, estimate: Path, T_ref_est: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the places (n, f, 2) of feet in the frame of the reference map [m]."""
    feet = read_feet(people)
    truth = people.with_name(f"{people.name.removesuffix('.npz').removesuffix('.people')}.gt.tum")
    trajectory = estimate.parent / "trajectory.tum"
    if not (truth.exists() and trajectory.exists()):
        return feet
    T_world_robot, T_est_robot = read_tum(truth).poses, read_tum(trajectory).poses
    if not len(feet) == len(T_world_robot) == len(T_est_robot):
        raise InputError(
            f"{people.name}, {truth.name} and {trajectory} must hold the same scans, "
            f"got {len(feet)}, {len(T_world_robot)} and {len(T_est_robot)}"
        )
    # seen from the robot, so that a drift of the map carries the feet along
    return transform_points(compose(T_ref_est, compose(T_est_robot, inverse(T_world_robot))), feet)
