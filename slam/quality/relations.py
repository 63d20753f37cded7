"""Errors of a trajectory by relations between its poses, after Kuemmerle et al., Autonomous Robots 27(4), 2009.

The measure needs no common frame and does not punish an early error for all that follows.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..geometry import between, compose, wrap_angle
from ..logs.relations import Readings, Relations
from ..logs.tum import Trajectory
from .trajectory import ErrorStatistics

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RelationError:
    """Errors over all scored relations; the paper prints mean +- std of each.

    Attributes:
        translation: Of the absolute translational errors [m].
        rotation: Of the absolute rotational errors [deg].
        translation_squared: Of the squared translational errors [m^2].
        rotation_squared: Of the squared rotational errors [deg^2].
        skipped: Relations that could not be scored, as the trajectory has no pose near their time.
    """

    translation: ErrorStatistics
    rotation: ErrorStatistics
    translation_squared: ErrorStatistics
    rotation_squared: ErrorStatistics
    skipped: int = 0


def relation_error(T_first_second: Array, T_map_first: Array, T_map_second: Array, skipped: int = 0) -> RelationError:
    """Return the errors of (m, 3) relations, given the estimated poses (m, 3) at their two moments."""
    error = between(T_first_second, between(T_map_first, T_map_second))
    metres, degrees = np.hypot(error[:, 0], error[:, 1]), np.rad2deg(np.abs(error[:, 2]))
    return RelationError(
        translation=ErrorStatistics.of(metres),
        rotation=ErrorStatistics.of(degrees),
        translation_squared=ErrorStatistics.of(metres**2),
        rotation_squared=ErrorStatistics.of(degrees**2),
        skipped=skipped,
    )


def score_relations(
    trajectory: Trajectory, relations: Relations, readings: Readings | None = None, max_gap_s: float = 2.0
) -> RelationError:
    """Return the errors of a trajectory by `relations`.

    A relation's moments need not be moments of the trajectory. With `readings`, the pose at a moment is the nearest
    pose of the trajectory carried on by the odometry between the two; without, it is interpolated in time.

    Args:
        trajectory: Estimated poses, one a scan, with the times of the log.
        relations: By time or by reading.
        readings: Odometry of all readings; needed where the relations are by reading.
        max_gap_s: Relations at moments farther than this from any pose, or with `readings` from any reading, or from
            poses that are themselves farther than this from any reading, are skipped and counted [s].

    Raises:
        InputError: If the relations are by reading and there are no readings, or if no relation can be scored.
    """
    if relations.by_reading and readings is None:
        raise InputError("relations by index of reading need the odometry of the readings, got none")
    if readings is None:
        poses, gaps = zip(*(_interpolated(trajectory, t) for t in (relations.first, relations.second)), strict=True)
    else:
        poses, gaps = zip(*_carried(trajectory, relations, readings), strict=True)
    near = (gaps[0] <= max_gap_s) & (gaps[1] <= max_gap_s)
    if not near.any():
        raise InputError(f"no relation lies within {max_gap_s} s of a pose of the trajectory; are the clocks the same?")
    return relation_error(relations.T_first_second[near], poses[0][near], poses[1][near], int((~near).sum()))


def _interpolated(trajectory: Trajectory, times: Array) -> tuple[Array, Array]:
    """Return poses (m, 3) at `times` (m,) and how far each is from the nearest pose of the trajectory [s]."""
    order = np.argsort(trajectory.times_s, kind="stable")
    known, poses = trajectory.times_s[order], trajectory.poses[order]
    right = np.clip(np.searchsorted(known, times), min(1, len(known) - 1), len(known) - 1)
    left = np.maximum(right - 1, 0)
    span = np.maximum(known[right] - known[left], 1e-9)
    share = np.clip((times - known[left]) / span, 0.0, 1.0)[:, None]
    step = poses[right] - poses[left]
    step[:, 2] = wrap_angle(step[:, 2])
    gaps = np.minimum(np.abs(times - known[left]), np.abs(known[right] - times))
    return poses[left] + share * step, gaps


def _carried(trajectory: Trajectory, relations: Relations, readings: Readings) -> list[tuple[Array, Array]]:
    """Return, for both moments, poses (m, 3) carried on by odometry from the nearest scan.

    Beside them how far (m,) that scan's time is from its reading's, or the moment is from its own reading's, if that is
    more [s]: large where the clocks differ.
    """
    scans = readings_of_scans(trajectory.times_s, readings.times_s)
    result = []
    for moments in (relations.first, relations.second):
        wanted = _reading_indices(moments, relations.by_reading, readings)
        scan = _nearest(scans, wanted)
        motion = between(readings.odometry[scans[scan]], readings.odometry[wanted])
        gaps = np.abs(trajectory.times_s[scan] - readings.times_s[scans[scan]])
        if not relations.by_reading:
            gaps = np.maximum(gaps, np.abs(readings.times_s[wanted] - moments))
        result.append((compose(trajectory.poses[scan], motion), gaps))
    return result


def _reading_indices(moments: Array, by_reading: bool, readings: Readings) -> NDArray[np.intp]:
    if not by_reading:
        order = np.argsort(readings.times_s, kind="stable")
        return order[_nearest(readings.times_s[order], moments)]
    if moments.min() < 0 or moments.max() >= len(readings.times_s):
        raise InputError(f"relations name readings up to {moments.max():g}; there are {len(readings.times_s)} readings")
    return moments.astype(np.intp)


def readings_of_scans(scan_times: Array, reading_times: Array) -> NDArray[np.intp]:
    """Return (n,) the index of the reading at which each scan was taken.

    Readings may share a time. Among those nearest to a scan's time the one is taken that agrees best with an even
    count of readings a scan, as the scans with a single nearest reading show it.

    Args:
        scan_times: (n,) times of the scans [s].
        reading_times: (r,) times of all readings [s].
    """
    order = np.argsort(reading_times, kind="stable")
    ordered = reading_times[order]
    at = ordered[_nearest(ordered, scan_times)]
    low, high = np.searchsorted(ordered, at - 1e-4), np.searchsorted(ordered, at + 1e-4)
    number = np.arange(len(scan_times))
    single = high - low == 1
    if single.sum() < 2:
        return order[low]
    expected = np.polyval(np.polyfit(number[single], order[low[single]], 1), number)
    nearest = [order[a:b][np.argmin(np.abs(order[a:b] - e))] for a, b, e in zip(low, high, expected, strict=True)]
    return np.array(nearest, dtype=np.intp)


def _nearest(ordered: NDArray, values: NDArray) -> NDArray[np.intp]:
    """Return the index of the entry of `ordered` (ascending) that is nearest to each of `values`."""
    right = np.clip(np.searchsorted(ordered, values), 0, len(ordered) - 1)
    left = np.maximum(right - 1, 0)
    return np.where(np.abs(ordered[left] - values) <= np.abs(ordered[right] - values), left, right)
