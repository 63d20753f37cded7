"""Errors of a trajectory against a reference: absolute (ATE) and relative (RPE), after Sturm et al. 2012."""

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds import check_poses
from ..errors import InputError
from ..geometry import between, compose, transform_points
from .rigid import fit_rigid

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ErrorStatistics:
    """Statistics of absolute errors, in the unit of the errors.

    Attributes:
        rmse: Root of the mean square.
        mean: Mean.
        std: Standard deviation.
        median: Median.
        max: The largest.
        count: How many errors there are.
    """

    rmse: float
    mean: float
    std: float
    median: float
    max: float
    count: int

    @classmethod
    def of(cls, errors: Array) -> "ErrorStatistics":
        """Return the statistics of errors (n,), n > 0."""
        if len(errors) == 0:
            raise InputError("error statistics need at least one error, got none")
        root = float(np.sqrt(np.mean(errors**2)))
        return cls(
            root, float(errors.mean()), float(errors.std()), float(np.median(errors)), float(errors.max()), len(errors)
        )

    def to_dict(self) -> dict[str, float]:
        """Return the fields by name."""
        return asdict(self)


@dataclass(frozen=True, eq=False)
class AbsoluteError:
    """Absolute trajectory error.

    Attributes:
        translation: Of the distances between estimated and reference positions [m].
        rotation: Of the absolute heading differences [deg].
        T_ref_est: (3,) the alignment that was applied to the estimate; zeros if none.
    """

    translation: ErrorStatistics
    rotation: ErrorStatistics
    T_ref_est: Array


@dataclass(frozen=True)
class RelativeError:
    """Relative pose error: how far the motion over a fixed number of poses is off.

    Attributes:
        translation: Of the lengths of the error's translation [m].
        rotation: Of its absolute rotations [deg].
    """

    translation: ErrorStatistics
    rotation: ErrorStatistics


def absolute_error(estimate: Array, reference: Array, align: bool = True) -> AbsoluteError:
    """Return the ATE of `estimate` (n, 3) against `reference` (n, 3), pose i against pose i.

    Args:
        estimate: Estimated poses, in any frame if `align`.
        reference: Reference poses.
        align: Whether the estimate is first laid on the reference by the best rigid motion of its positions.

    Raises:
        InputError: If the shapes differ or there is no pose.
    """
    _check_pair(estimate, reference)
    T_ref_est = fit_rigid(estimate[:, :2], reference[:, :2]) if align else np.zeros(3)
    aligned = compose(T_ref_est, estimate)
    positions = transform_points(T_ref_est, estimate[:, :2])
    distances = np.linalg.norm(positions - reference[:, :2], axis=1)
    turns = np.rad2deg(np.abs(between(reference, aligned)[:, 2]))
    return AbsoluteError(ErrorStatistics.of(distances), ErrorStatistics.of(turns), T_ref_est)


def relative_error(estimate: Array, reference: Array, step: int = 1) -> RelativeError:
    """Return the RPE over `step` poses, of `estimate` (n, 3) against `reference` (n, 3), all overlapping pairs.

    Raises:
        InputError: If the shapes differ or there are not more than `step` poses.
    """
    _check_pair(estimate, reference)
    if not 1 <= step < len(estimate):
        raise InputError(f"`step` must lie in [1, {len(estimate) - 1}] for {len(estimate)} poses, got {step}")
    moved_est = between(estimate[:-step], estimate[step:])
    moved_ref = between(reference[:-step], reference[step:])
    error = between(moved_ref, moved_est)
    return RelativeError(
        ErrorStatistics.of(np.hypot(error[:, 0], error[:, 1])),
        ErrorStatistics.of(np.rad2deg(np.abs(error[:, 2]))),
    )


def associate(times_a: Array, times_b: Array, max_gap_s: float = 0.01) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the indices (k,) and (k,) of the poses that belong together: nearest in time, each used once at most.

    They come in the order of time, whatever that of the poses, so that `relative_error` sees steps of the motion.

    Args:
        times_a: (n,) times [s], in any order.
        times_b: (m,) times [s], in any order.
        max_gap_s: Times farther apart than this do not belong together [s].
    """
    if len(times_a) == 0 or len(times_b) == 0:
        return np.empty(0, dtype=np.intp), np.empty(0, dtype=np.intp)
    order = np.argsort(times_b, kind="stable")
    ordered = times_b[order]
    right = np.clip(np.searchsorted(ordered, times_a), 1, max(len(ordered) - 1, 1))
    left = right - 1
    right = np.minimum(right, len(ordered) - 1)
    nearest = np.where(np.abs(ordered[left] - times_a) <= np.abs(ordered[right] - times_a), left, right)
    gaps = np.abs(ordered[nearest] - times_a)
    by_gap = np.argsort(gaps, kind="stable")
    by_gap = by_gap[gaps[by_gap] <= max_gap_s]
    _, first = np.unique(nearest[by_gap], return_index=True)
    chosen = np.sort(by_gap[first])
    chosen = chosen[np.argsort(times_a[chosen], kind="stable")]
    return chosen, order[nearest[chosen]]


def _check_pair(estimate: Array, reference: Array) -> None:
    if estimate.shape != reference.shape or estimate.ndim != 2 or estimate.shape[1] != 3 or len(estimate) == 0:
        raise InputError(f"trajectories must both have shape (n, 3), n > 0, got {estimate.shape} and {reference.shape}")
    for name, poses in (("estimate", estimate), ("reference", reference)):
        check_poses(poses, name, jumps=False)
