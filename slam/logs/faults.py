"""Faults put into a recorded drive: what odometry, clocks, lasers and drivers do wrong, one at a time.

Each fault is a pure function of a drive and a generator of random numbers; the drive stays as it is. Where a log's
clock stood still, one scan a second is taken for its rate.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from ..geometry import between, compose, inverse, wrap_angle
from ..scan import LaserScan
from .drive import RecordedDrive

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_WINDOW = 40  # scans in which the odometry freezes once
_FROZEN_FROM = 1.0 / 3.0  # share of the drive after which it freezes for good: the map has begun by then
_TYPICAL_NOISE = (0.01, np.radians(0.3), np.radians(0.8))  # [m/sqrt(m), rad/sqrt(m), rad/sqrt(rad)] of a wheeled robot
_SLIP = (0.3, 0.1, np.radians(10.0))  # [m, m, rad] standard deviations of what a slip adds
_SLIP_EVERY = 10.0  # mean way between two slips [m]
_JITTER = 0.3  # standard deviation of a stamp [share of the usual step between scans]
_STUCK_AT = 1.0  # [m]
_LEG_RADIUS = 0.07  # [m]
_LEGS = np.array([(0.30, 0.75), (0.55, 0.65), (0.20, -0.80), (0.45, -0.70)])  # of two people, laser frame [m]
_SWAY = 0.03  # standard deviation of a leg's place from scan to scan [m]


@dataclass(frozen=True, eq=False)
class DisturbedDrive:
    """A drive with a fault.

    Attributes:
        recording: The drive as it would have been recorded; its reference is where the robot was at each scan.
        origin: (m,) number of the undisturbed scan at whose moment each scan stands.
    """

    recording: RecordedDrive
    origin: Index


@dataclass(frozen=True)
class Fault:
    """A kind of fault.

    Attributes:
        says: What is wrong, in a few words.
        into: Puts it into a drive, by a drive and a generator of random numbers.
    """

    says: str
    into: Callable[[RecordedDrive, Generator], DisturbedDrive]


def undisturbed(drive: RecordedDrive, rng: Generator) -> DisturbedDrive:
    """Return the drive as it is."""
    del rng
    return DisturbedDrive(drive, np.arange(len(drive)))


def frozen(drive: RecordedDrive, rng: Generator, scans: int) -> DisturbedDrive:
    """Let the odometry stand still for so many `scans` once in each 40, then catch up from one scan to the next."""
    source = np.arange(len(drive))
    for start in range(1, len(drive), _WINDOW):
        at = start + int(rng.integers(0, _WINDOW - scans))
        source[at : at + scans] = at - 1
    return _with_odometry(drive, drive.odometry[np.minimum(source, np.arange(len(drive)))])


def frozen_for_good(drive: RecordedDrive, rng: Generator) -> DisturbedDrive:
    """Let the odometry stand still from a third of the drive on."""
    del rng
    return _with_odometry(drive, drive.odometry[np.minimum(np.arange(len(drive)), int(_FROZEN_FROM * len(drive)))])


def late(drive: RecordedDrive, rng: Generator, lag_s: float) -> DisturbedDrive:
    """Pair each scan with the odometry of `lag_s` before [s]."""
    del rng
    clock = _clock(drive)
    return _with_odometry(drive, _odometry_at(drive, clock, clock - lag_s))


def scaled(drive: RecordedDrive, rng: Generator, factor: float) -> DisturbedDrive:
    """Let the odometry say `factor` times the way, as wheels do that are not as large as they are thought."""
    del rng
    return _with_steps(drive, _steps(drive) * (factor, factor, 1.0))


def turn_bias(drive: RecordedDrive, rng: Generator, turn: float) -> DisturbedDrive:
    """Add `turn` to the heading for each metre of the way [rad/m], as wheels of unequal size do."""
    del rng
    steps = _steps(drive)
    steps[:, 2] += turn * np.hypot(steps[:, 0], steps[:, 1])
    return _with_steps(drive, steps)


def wrong_wheels(drive: RecordedDrive, rng: Generator) -> DisturbedDrive:
    """Let the odometry say half to twice the way and the turns, as by a driver with mixed-up units."""
    way, turn = np.exp2(rng.uniform(-1.0, 1.0, 2))
    return _with_steps(drive, _steps(drive) * (way, way, turn))


def elsewhere(drive: RecordedDrive, rng: Generator) -> DisturbedDrive:
    """Put the laser anywhere on the robot, half a metre ahead or to a side at most, and turned any way; nobody says so.

    The poses of the drive stay those of the robot as it would be if the laser stood where the log says: only the
    odometry becomes that of another one.
    """
    laser = rng.uniform((-0.5, -0.5, -np.pi), (0.5, 0.5, np.pi))
    return _with_steps(drive, compose(compose(laser, _steps(drive)), inverse(laser)))


def upside_down(drive: RecordedDrive, rng: Generator) -> DisturbedDrive:
    """Hang the laser upside down, and let nobody say so."""
    del rng
    scans = [replace(scan, ranges=scan.ranges[::-1], bearings=-scan.bearings[::-1]) for scan in drive.scans]
    return DisturbedDrive(replace(drive, scans=scans), np.arange(len(drive)))


def slipping(drive: RecordedDrive, rng: Generator) -> DisturbedDrive:
    """Add a jump of some decimetres and ten degrees to the odometry every ten metres, in the mean."""
    steps = _steps(drive)
    slips = rng.random(len(steps)) < np.hypot(steps[:, 0], steps[:, 1]) / _SLIP_EVERY
    jumps = rng.normal(0.0, _SLIP, steps.shape)
    return _with_steps(drive, np.where(slips[:, None], compose(steps, jumps), steps))


def noisy(drive: RecordedDrive, rng: Generator, times: float) -> DisturbedDrive:
    """Add Gaussian noise to the odometry, `times` that of a usual wheeled robot."""
    steps = _steps(drive)
    way, turn = np.hypot(steps[:, 0], steps[:, 1]), np.abs(steps[:, 2])
    along, by_way, by_turn = _TYPICAL_NOISE
    headings = np.sqrt(by_way**2 * way + by_turn**2 * turn)
    sigmas = times * np.stack((along * np.sqrt(way), 0.25 * along * np.sqrt(way), headings), axis=-1)
    return _with_steps(drive, compose(steps, rng.normal(0.0, 1.0, steps.shape) * sigmas))


def jittered(drive: RecordedDrive, rng: Generator) -> DisturbedDrive:
    """Let the stamps of the scans jitter by 0.3 of a step, and look the odometry up at the wrong stamps."""
    clock = _clock(drive)
    steps = np.diff(clock)
    usual = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 1.0
    stamps = clock + rng.normal(0.0, _JITTER * usual, len(drive))
    scans = [replace(scan, time_s=stamp) for scan, stamp in zip(drive.scans, stamps.tolist(), strict=True)]
    changed = _with_odometry(drive, _odometry_at(drive, clock, stamps))
    return DisturbedDrive(replace(changed.recording, scans=scans), changed.origin)


def stale(drive: RecordedDrive, rng: Generator, every: int) -> DisturbedDrive:
    """Give every so-manyth scan the ranges and the stamp of the one before; the odometry goes on."""
    del rng
    shown = np.arange(len(drive))
    shown[every::every] -= 1
    recording = replace(drive, scans=[replace(drive.scans[k]) for k in shown.tolist()])
    return DisturbedDrive(recording, np.arange(len(drive)))


def doubled(drive: RecordedDrive, rng: Generator, every: int) -> DisturbedDrive:
    """Repeat every so-manyth scan with its stamp and its odometry."""
    del rng
    order = np.arange(len(drive))
    return _picked(drive, np.sort(np.concatenate((order, order[::every]))))


def thinned(drive: RecordedDrive, rng: Generator, every: int) -> DisturbedDrive:
    """Keep every so-manyth scan."""
    del rng
    return _picked(drive, np.arange(0, len(drive), every))


def gap(drive: RecordedDrive, rng: Generator, share: float) -> DisturbedDrive:
    """Leave out a `share` of the scans in one piece, somewhere in the middle of the drive."""
    missing = round(share * len(drive))
    start = int(rng.uniform(0.2, 0.8 - share) * len(drive))
    return _picked(drive, np.delete(np.arange(len(drive)), slice(start, start + missing)))


def backwards(drive: RecordedDrive, rng: Generator) -> DisturbedDrive:
    """Drive the way from its end to its beginning, looking the same way: the stamps still ascend."""
    del rng
    turned, clock = _picked(drive, np.arange(len(drive))[::-1]), _clock(drive)
    stamps = (clock[-1] - clock + clock[0])[::-1].tolist()
    scans = [replace(scan, time_s=stamp) for scan, stamp in zip(turned.recording.scans, stamps, strict=True)]
    return DisturbedDrive(replace(turned.recording, scans=scans), turned.origin)


def dropped_beams(drive: RecordedDrive, rng: Generator, share: float) -> DisturbedDrive:
    """Turn a `share` of the beams, others in each scan, into "no measurement"."""
    return _with_ranges(drive, lambda scan: np.where(rng.random(len(scan)) < share, np.nan, scan.ranges))


def missed_beams(drive: RecordedDrive, rng: Generator, share: float) -> DisturbedDrive:
    """Turn a `share` of the beams, others in each scan, into "no return": dark or shiny walls read as free space."""
    return _with_ranges(drive, lambda scan: np.where(rng.random(len(scan)) < share, np.inf, scan.ranges))


def stuck_beams(drive: RecordedDrive, rng: Generator, share: float) -> DisturbedDrive:
    """Let a `share` of the beams, the same all the time, measure 1 m: dirt or a frame before the laser."""
    stuck = rng.random(max(map(len, drive.scans), default=0)) < share
    return _with_ranges(drive, lambda scan: np.where(stuck[: len(scan)], _STUCK_AT, scan.ranges))


def noisy_beams(drive: RecordedDrive, rng: Generator, sigma: float) -> DisturbedDrive:
    """Add Gaussian noise of `sigma` to all ranges [m]."""
    return _with_ranges(drive, lambda scan: np.maximum(scan.ranges + rng.normal(0.0, sigma, len(scan)), scan.range_min))


def long_beams(drive: RecordedDrive, rng: Generator, bias: float) -> DisturbedDrive:
    """Add `bias` to all ranges [m], as of a laser that is not calibrated."""
    del rng
    return _with_ranges(drive, lambda scan: scan.ranges + bias)


def short_sighted(drive: RecordedDrive, rng: Generator, reach: float) -> DisturbedDrive:
    """Let the laser see no farther than `reach` [m]."""
    del rng
    cut = _with_ranges(drive, lambda scan: np.where(scan.ranges > reach, np.inf, scan.ranges))
    scans = [replace(scan, range_max=min(scan.range_max, reach)) for scan in cut.recording.scans]
    return DisturbedDrive(replace(cut.recording, scans=scans), cut.origin)


def sparse_beams(drive: RecordedDrive, rng: Generator, every: int) -> DisturbedDrive:
    """Leave every `every`-th beam, as a simpler laser has them."""
    del rng
    return _with_beams(drive, lambda scan: np.arange(len(scan)) % every == every // 2)


def narrow_view(drive: RecordedDrive, rng: Generator, angle: float) -> DisturbedDrive:
    """Let the laser see no wider than `angle` [rad], half of it to each side."""
    del rng
    return _with_beams(drive, lambda scan: np.abs(scan.bearings) <= 0.5 * angle + 1e-9)


def accompanied(drive: RecordedDrive, rng: Generator) -> DisturbedDrive:
    """Let two people walk along, half a metre to a metre beside the laser, one on each side."""
    return _with_ranges(drive, lambda scan: _before(scan, _LEGS + rng.normal(0.0, _SWAY, _LEGS.shape)))


FAULTS: dict[str, Fault] = {
    "none": Fault("nothing", undisturbed),
    "frozen-3": Fault("odometry frozen for 3 of 40 scans, then catching up", partial(frozen, scans=3)),
    "frozen-5": Fault("odometry frozen for 5 of 40 scans, then catching up", partial(frozen, scans=5)),
    "frozen-10": Fault("odometry frozen for 10 of 40 scans, then catching up", partial(frozen, scans=10)),
    "frozen-for-good": Fault("odometry frozen from a third of the drive on", frozen_for_good),
    "late-0.1": Fault("odometry late by 0.1 s", partial(late, lag_s=0.1)),
    "late-0.2": Fault("odometry late by 0.2 s", partial(late, lag_s=0.2)),
    "late-0.3": Fault("odometry late by 0.3 s", partial(late, lag_s=0.3)),
    "scale-0.8": Fault("odometry says 0.8 of the way", partial(scaled, factor=0.8)),
    "scale-0.9": Fault("odometry says 0.9 of the way", partial(scaled, factor=0.9)),
    "scale-1.1": Fault("odometry says 1.1 of the way", partial(scaled, factor=1.1)),
    "scale-1.2": Fault("odometry says 1.2 of the way", partial(scaled, factor=1.2)),
    "turn-bias": Fault("odometry turns by 0.05 rad more for each metre", partial(turn_bias, turn=0.05)),
    "wheels": Fault("odometry says half to twice the way and the turns", wrong_wheels),
    "elsewhere": Fault("the laser stands elsewhere on the robot than is said, turned any way", elsewhere),
    "upside-down": Fault("the laser hangs upside down, and nobody says so", upside_down),
    "slip": Fault("odometry jumps by 0.3 m and 10 deg every 10 m", slipping),
    "noise-x10": Fault("ten times the noise of a usual odometry", partial(noisy, times=10.0)),
    "jitter": Fault("stamps jitter by 0.3 of a step, odometry by the wrong stamps", jittered),
    "stale-5": Fault("every 5th scan is the one before once more", partial(stale, every=5)),
    "doubled-5": Fault("every 5th scan comes twice, odometry and all", partial(doubled, every=5)),
    "every-2": Fault("every 2nd scan only", partial(thinned, every=2)),
    "every-4": Fault("every 4th scan only", partial(thinned, every=4)),
    "every-8": Fault("every 8th scan only", partial(thinned, every=8)),
    "gap": Fault("a tenth of the scans missing in one piece", partial(gap, share=0.1)),
    "backwards": Fault("driven from the end to the beginning", backwards),
    "dropped-beams": Fault("a tenth of the beams without measurement", partial(dropped_beams, share=0.1)),
    "missed-beams": Fault("30 % of the beams read as maximum range", partial(missed_beams, share=0.3)),
    "stuck-beams": Fault("a fifth of the beams stuck at 1 m", partial(stuck_beams, share=0.2)),
    "noisy-beams": Fault("noise of 0.1 m on all ranges", partial(noisy_beams, sigma=0.1)),
    "reach-8": Fault("ranges cut at 8 m", partial(short_sighted, reach=8.0)),
    "reach-5.6": Fault("ranges cut at 5.6 m", partial(short_sighted, reach=5.6)),
    "sparse-beams": Fault("every sixth beam only", partial(sparse_beams, every=6)),
    "narrow-view": Fault("a view of 90 degrees", partial(narrow_view, angle=np.pi / 2)),
    "range-bias": Fault("all ranges 0.1 m too long", partial(long_beams, bias=0.1)),
    "people": Fault("two people who stay beside the laser", accompanied),
}
"""Name -> fault. "none" is the drive as it is."""


def _clock(drive: RecordedDrive) -> Array:
    """Return (n,) when the scans were taken, never backwards [s]; a second apart where the log's clock stood still."""
    if 2 * len(np.unique(drive.times_s)) <= len(drive):
        return np.arange(len(drive), dtype=np.float64)
    return np.maximum.accumulate(drive.times_s)


def _odometry_at(drive: RecordedDrive, clock: Array, times: Array) -> Array:
    """Return (m, 3) the odometry at `times` (m,) by that at `clock` (n,) [s]; at the ends it stands still."""
    axes = (*drive.odometry[:, :2].T, np.unwrap(drive.odometry[:, 2]))
    x, y, heading = (np.interp(times, clock, axis) for axis in axes)
    return np.stack((x, y, wrap_angle(heading)), axis=-1)


def _steps(drive: RecordedDrive) -> Array:
    """Return (n - 1, 3) how the robot moves from scan to scan by the odometry, in its own frame."""
    return between(drive.odometry[:-1], drive.odometry[1:])


def _with_steps(drive: RecordedDrive, steps: Array) -> DisturbedDrive:
    """Return the drive with an odometry that begins where it did and moves by `steps` (n - 1, 3)."""
    first = drive.odometry[0]
    headings = first[2] + np.concatenate(([0.0], np.cumsum(steps[:, 2])))
    cos, sin = np.cos(headings[:-1]), np.sin(headings[:-1])
    moves = np.stack((cos * steps[:, 0] - sin * steps[:, 1], sin * steps[:, 0] + cos * steps[:, 1]), axis=-1)
    places = first[:2] + np.concatenate((np.zeros((1, 2)), np.cumsum(moves, axis=0)))
    return _with_odometry(drive, np.column_stack((places, wrap_angle(headings))))


def _with_odometry(drive: RecordedDrive, odometry: Array) -> DisturbedDrive:
    return DisturbedDrive(replace(drive, odometry=odometry), np.arange(len(drive)))


def _with_ranges(drive: RecordedDrive, seen: Callable[[LaserScan], Array]) -> DisturbedDrive:
    scans = [replace(scan, ranges=seen(scan)) for scan in drive.scans]
    return DisturbedDrive(replace(drive, scans=scans), np.arange(len(drive)))


def _with_beams(drive: RecordedDrive, kept: Callable[[LaserScan], NDArray[np.bool_]]) -> DisturbedDrive:
    """Return the drive with those beams of each scan that are `kept`."""
    scans = [replace(scan, ranges=scan.ranges[kept(scan)], bearings=scan.bearings[kept(scan)]) for scan in drive.scans]
    return DisturbedDrive(replace(drive, scans=scans), np.arange(len(drive)))


def _picked(drive: RecordedDrive, order: Index) -> DisturbedDrive:
    """Return the drive with the scans of `order` (m,), each with its own odometry, stamp and reference."""
    reference = None if drive.reference is None else drive.reference[order]
    scans = [replace(drive.scans[k]) for k in order.tolist()]
    return DisturbedDrive(replace(drive, odometry=drive.odometry[order], scans=scans, reference=reference), order)


def _before(scan: LaserScan, legs: Array) -> Array:
    """Return the ranges (n,) of a scan before which stand `legs` (k, 2), laser frame [m]."""
    along = scan.directions @ legs.T
    inside = along**2 - (legs**2).sum(axis=1) + _LEG_RADIUS**2
    met = (inside >= 0.0) & (along > 0.0)
    ranges = np.where(met, along - np.sqrt(np.maximum(inside, 0.0)), np.inf).min(axis=1)
    return np.where(np.isfinite(ranges), np.fmin(ranges, scan.ranges), scan.ranges)
