"""Fits the numbers of the tracker's error model to drives of the real tracker."""

from collections.abc import Sequence
from itertools import groupby, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from ...envs.tracker_errors.errors import (
    BORN,
    DOUBT,
    FOUND,
    LOST,
    MISSED,
    PLACE,
    QUANTITIES,
    SECOND,
    SIGHT,
    TrackerErrors,
)
from ...envs.tracker_errors.kernel import FARTHEST_M, SWAP_M, come_on, seen_for
from ...slam.errors import InputError
from .tracker_drives import LEADER, SEEN, UNKNOWN, UNSEEN, TrackedDrive

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

TOO_FEW = "the drives are too few or too short to fit errors to: people have to be seen and lost on them"
_RIDGE = 1e-3  # keeps a weight finite where nothing speaks for any value of it
_LAGS_S = np.arange(0.1, 3.05, 0.1)
_LONGEST_LAG = 10  # scans that correlations are looked at over: beyond lie steps, which are no noise


def fit_errors(drives: Sequence[TrackedDrive]) -> TrackerErrors:
    """Return the numbers that describe the tracker of `drives` best: by maximum likelihood, or by moments.

    Raises:
        InputError: If nobody on them was seen, or lost out of sight, as every number needs it.
    """
    weights = np.zeros((len(QUANTITIES), len(SIGHT)))
    longest = _longest_unseen_s(drives)
    weights[BORN] = _born(drives, longest)
    for row, before, after in (
        (MISSED, SEEN, (UNSEEN, UNKNOWN)),
        (FOUND, UNSEEN, (SEEN,)),
        (LOST, UNSEEN, (UNKNOWN,)),
    ):
        sights, happened = _changes(drives, before, after, longest)
        weights[row] = rate_weights(sights, happened, drives[0].dt)
    weights[SECOND] = rate_weights(*_seconds_begun(drives), drives[0].dt)
    delay = delay_s(drives)
    place_error, sights = _seen_rows(drives, lambda d: d.place - d.position + delay * d.velocity)
    trust, _ = _seen_rows(drives, lambda d: d.trust)
    weights[PLACE] = 0.5 * mean_weights(sights, (place_error**2).mean(axis=1))  # of the variance
    weights[DOUBT] = mean_weights(sights, 1.0 - trust)
    lag = min(_LAGS_S.tolist(), key=lambda lag: _spread(drives, lag))
    swap, swapped = _swaps(drives)
    motion = _spread(drives, lag)
    place_s = np.mean([correlation_s([drive], lambda d: d.place - d.position + delay * d.velocity) for drive in drives])
    return TrackerErrors(
        weights=weights,
        place_s=float(place_s),
        delay_s=delay,
        motion_lag_s=lag,
        motion_mps=motion,
        motion_s=correlation_s(drives, lambda d: d.motion - followed(d.velocity, lag, d.dt)),
        unseen_mps=_unseen_mps(drives),
        longest_unseen_s=longest,
        swap_per_s=swap,
        swapped_s=swapped,
        **_false_tracks(drives),
    )


def with_one(sights: Array) -> Array:
    """Return (k, 10) the columns `SIGHT` of `sights` (k, 9)."""
    return np.concatenate((np.ones((len(sights), 1)), sights), axis=1)


def rate_weights(sights: Array, happened: Flags, dt: float) -> Array:
    """Return (10,) the weights of a rate, by maximum likelihood of what happened within `dt` [s].

    Args:
        sights: (k, 9) how somebody was seen, how far the track was off, for how long it was seen, and the way come.
        happened: (k,) whether it happened.
        dt: [s].
    """
    columns = with_one(sights)

    def loss(weights: Array) -> tuple[float, Array]:
        expected = np.exp(np.clip(columns @ weights, -20.0, 6.0)) * dt
        chance = -np.expm1(-expected)
        cost = np.where(happened, -np.log(np.maximum(chance, 1e-300)), expected).sum() + _RIDGE * weights @ weights
        slope = np.where(happened, -expected * np.exp(-expected) / np.maximum(chance, 1e-300), expected)
        return float(cost), slope @ columns + 2.0 * _RIDGE * weights

    start = np.zeros(len(SIGHT))
    start[0] = np.log(max(float(happened.sum()), 1e-6 * len(happened)) / (dt * len(happened)))
    found = minimize(loss, start, jac=True, method="BFGS")
    return np.asarray(found.x)


def _born(drives: Sequence[TrackedDrive], longest_s: float) -> Array:
    """Return (10,) the weights of the rate at which people become known."""
    sights, happened = _changes(drives, UNKNOWN, (SEEN, UNSEEN), longest_s)
    sights[:, -1] = _joined([ways_come(d)[1:][(d.phase[:-1] == UNKNOWN) & _near(d)] for d in drives])
    return rate_weights(sights, happened, drives[0].dt)


def _near(drive: TrackedDrive) -> Flags:
    """Return (T - 1, n) who is near enough to become known in each scan but the first."""
    return drive.sight[1:, :, 0] < FARTHEST_M


def ways_come(drive: TrackedDrive) -> Array:
    """Return (T, n) how far each has come in sight by each scan [m]."""
    way, near = np.zeros(drive.position.shape), _near(drive)
    for k in range(1, len(way)):
        for i in np.flatnonzero(near[k - 1]).tolist():
            way[k, i] = way[k - 1, i]
            come_on(way[k, i], drive.velocity[k, i], tuple(drive.sight[k, i]), drive.dt)
    return np.hypot(*way.transpose(2, 0, 1))


def seen_s(drive: TrackedDrive) -> Array:
    """Return (T, n) for how long each who is seen has been without a break [s]; 0 for the others."""
    times = np.zeros(drive.phase.shape)
    for k in range(1, len(times)):
        goes_on = (drive.phase[k] == SEEN) & (drive.phase[k - 1] == SEEN)
        times[k] = np.where(goes_on, times[k - 1] + drive.dt, 0.0)
    return times


def mean_weights(sights: Array, values: Array) -> Array:
    """Return (10,) the weights of the mean of positive `values` (k,), as if they were exponentially distributed."""
    columns = with_one(sights)

    def loss(weights: Array) -> tuple[float, Array]:
        log = np.clip(columns @ weights, -20.0, 6.0)
        share = values * np.exp(-log)
        slope = (1.0 - share) @ columns + 2.0 * _RIDGE * weights
        return float((log + share).sum() + _RIDGE * weights @ weights), slope

    start = np.zeros(len(SIGHT))
    start[0] = np.log(values.mean())
    return np.asarray(minimize(loss, start, jac=True, method="BFGS").x)


def _changes(
    drives: Sequence[TrackedDrive], before: int, after: tuple[int, ...], longest_s: float
) -> tuple[Array, Flags]:
    """Return how people of phase `before` were seen a scan later (k, 9), and whether they changed to one of `after`.

    Who was unseen for `longest_s` [s] is left out: they are given up.
    """
    sights, happened = [], []
    for drive in drives:
        old, new, sight = drive.phase[:-1], drive.phase[1:], drive.sight[1:]
        there = (old == before) & _near(drive) & (drive.unseen_s[:-1] + 0.5 * drive.dt < longest_s)
        seen_log2 = np.vectorize(seen_for)(seen_s(drive))[:-1]
        past = drive.off[:-1][there], seen_log2[there], np.zeros(np.count_nonzero(there))
        sights.append(np.column_stack((sight[there], *past)))
        happened.append(np.isin(new[there], after))
    return _joined(sights), _joined(happened)


def _joined(parts: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Return what each drive tells, as one array; an error where none tells anything."""
    joined = np.concatenate(parts)
    if not len(joined):
        raise InputError(TOO_FEW)
    return joined


def _longest_unseen_s(drives: Sequence[TrackedDrive]) -> float:
    """Return for how long the longest unseen tracks last, but for one of a hundred [s]."""
    last = [d.unseen_s[:-1][(d.phase[:-1] == UNSEEN) & (d.phase[1:] != UNSEEN)] for d in drives]
    return float(np.quantile(_joined(last), 0.99))


def _unseen_mps(drives: Sequence[TrackedDrive]) -> float:
    """Return how much more velocities are off while people are not seen, each axis [m/s].

    By how places go astray: the mean square of their error grows with the square of the time, by the variance of the
    velocity's error, of which what seen velocities are off by is known.
    """
    rows = [((d.place - d.position)[d.phase == UNSEEN], d.unseen_s[d.phase == UNSEEN]) for d in drives]
    squares = (_joined([error for error, _ in rows]) ** 2).mean(axis=1)
    slope = float(np.polyfit(_joined([time for _, time in rows]) ** 2, squares, 1)[0])
    off, _ = _seen_rows(drives, lambda d: d.motion - d.velocity)
    return float(np.sqrt(max(slope - (off**2).mean(), 0.0)))


def _seen_rows(drives: Sequence[TrackedDrive], values) -> tuple[Array, Array]:
    """Return `values(drive)` of all who are seen, and how they are seen (k, 9); the track's past does not count."""
    parts = [(values(d)[d.phase == SEEN], d.sight[d.phase == SEEN]) for d in drives]
    sights = _joined([sight for _, sight in parts])
    return _joined([part for part, _ in parts]), np.column_stack((sights, np.zeros((len(sights), 3))))


def delay_s(drives: Sequence[TrackedDrive]) -> float:
    """Return how far seen places are behind, in seconds of the true motion."""
    error, _ = _seen_rows(drives, lambda d: d.place - d.position)
    motion, _ = _seen_rows(drives, lambda d: d.velocity)
    return max(-float((error * motion).sum() / (motion**2).sum()), 0.0)


def followed(velocity: Array, lag_s: float, dt: float) -> Array:
    """Return velocities (T, n, 2) as a filter with the time constant `lag_s` has them."""
    share, slow = 1.0 - np.exp(-dt / lag_s), velocity.copy()
    for k in range(1, len(velocity)):
        slow[k] = slow[k - 1] + share * (velocity[k] - slow[k - 1])
    return slow


def _spread(drives: Sequence[TrackedDrive], lag_s: float) -> float:
    """Return the standard deviation of seen velocities from the followed ones, each axis [m/s]."""
    error, _ = _seen_rows(drives, lambda d: d.motion - followed(d.velocity, lag_s, d.dt))
    return float(np.sqrt((error**2).mean()))


def correlation_s(drives: Sequence[TrackedDrive], values) -> float:
    """Return the correlation time of an error `values(drive)` (T, n, 2) of people who stay seen [s]."""
    products, counts = np.zeros(_LONGEST_LAG + 1), np.zeros(_LONGEST_LAG + 1)
    for drive in drives:
        error = np.where((drive.phase == SEEN)[:, :, None], values(drive), np.nan)
        for lag in range(_LONGEST_LAG + 1):
            product = error[lag:] * error[: len(error) - lag]
            products[lag] += np.nansum(product)
            counts[lag] += np.isfinite(product).sum()
    correlation = products / np.maximum(counts, 1)
    lags = np.arange(1, _LONGEST_LAG + 1) * drives[0].dt
    share = np.clip(correlation[1:] / correlation[0], 1e-3, 1.0)
    # the exponential that comes nearest in the mean
    times = np.geomspace(0.05, 20.0, 400)
    return float(times[np.argmin(((np.exp(-lags / times[:, None]) - share) ** 2).sum(axis=1))])


def _swaps(drives: Sequence[TrackedDrive]) -> tuple[float, float]:
    """Return at which rate the leader and somebody else near it are taken for each other [1/s], and for how long [s].

    From when it was first the right one, and by the leader alone: what the numbers of other tracks do is in no
    observation.
    """
    begun = wrong = near = 0
    for drive in drives:
        apart = np.hypot(*(drive.position - drive.position[:, :1]).transpose(2, 0, 1))
        beside = ((apart[:, 1:] < SWAP_M) & (drive.phase[:, 1:] == SEEN)).any(axis=1) & (drive.phase[:, 0] == SEEN)
        near += int(beside.sum())
        who = drive.leads[drive.leads >= LEADER].tolist()
        first = who.index(LEADER) if LEADER in who else len(who)
        wrong += sum(number > LEADER for number in who[first:])
        begun += sum(a == LEADER < b for a, b in pairwise(who))
    dt = drives[0].dt
    return begun / max(near * dt, dt), max(wrong, 1) * dt / max(begun, 1)


def _seconds_begun(drives: Sequence[TrackedDrive]) -> tuple[Array, Flags]:
    """Return how everybody seen is seen (k, 9), and whether a second track of theirs begins there."""
    begun = []
    for drive in drives:
        starts = np.zeros(drive.phase.shape, dtype=bool)
        there = {(row.number, row.scan) for row in drive.false if row.seen}
        for row in drive.false:
            if row.seen and row.number in drive.ever and (row.number, row.scan - 1) not in there:
                starts[row.scan, row.person] = True
        begun.append(starts[drive.phase == SEEN])
    return _seen_rows(drives, lambda d: d.position)[1], _joined(begun)


def _false_tracks(drives: Sequence[TrackedDrive]) -> dict[str, float]:
    """Return the numbers of second tracks and of things."""
    dt = drives[0].dt
    second = {True: [0, 0], False: [0, 0]}  # ever somebody's? -> runs, scans
    standing = scans = 0
    apart, trust = [], []
    for drive in drives:
        rows = [row for row in drive.false if row.seen]
        for number, run in groupby(sorted(rows, key=lambda row: (row.number, row.scan)), key=lambda row: row.number):
            at = [row.scan for row in run]
            counts = second[number in drive.ever]
            counts[0] += 1 + sum(b > a + 1 for a, b in pairwise(at))
            counts[1] += len(at)
        scans += len(rows)
        standing += sum(row.speed < 0.3 for row in rows)
        apart += [row.apart for row in rows if row.speed >= 0.3 and row.number in drive.ever]
        trust += [row.trust for row in rows]
    near_s = sum(len(drive.phase) * drive.near_beams for drive in drives) * dt
    (runs, length), (things, thing_length) = second[True], second[False]
    return {
        "second_stands": standing / max(scans, 1),
        "second_m": float(np.sqrt(np.mean(np.square(apart)) / 2.0)) if apart else 0.0,
        "second_life_s": max(length, 1) * dt / max(runs, 1),
        "thing_per_s": things / max(near_s, dt),
        "thing_life_s": max(thing_length, 1) * dt / max(things, 1),
        "false_confidence": float(np.mean(trust)) if trust else 0.0,
    }
