"""How a laser stands on its robot, and what odometry makes of a metre and a turn, as the drive's own scans show it.

A bag that was begun after the fixed transforms were sent has lost where the laser stands; a driver may have a wrong
wheel radius or track, a swapped sign or mixed-up units. What the log says of both is compared with what its scans show:
pairs of them are matched without the odometry. With z the way between two scans by the odometry, as a complex number
in the frame of the first, s that of the scans, and a the angle by which the robot turned between them,

    z = f s + l (1 - exp(i a)),

where the length of f is what odometry tells for a metre, its angle how far the laser is turned on the robot, and l how
far aside it stands, times that length (Censi, Franchi, Marchionni and Oriolo, "Simultaneous calibration of odometry and
sensor parameters for mobile robots", 2013, solve the like for two wheels). What is off so far that SLAM would suffer is
put right, and said.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from ..geometry import between, compose, inverse
from ..logs.drive import RecordedDrive
from ..scan import LaserScan
from ..scan_to_scan import make_matcher

Array = NDArray[np.float64]

_PAIRS = 200  # pairs of scans that are looked at, evenly over the drive
_FAR = (0.3, 0.35)  # [m, rad] of odometry between the two scans of a pair ...
_MOST_SCANS = 16  # ... or so many scans, where the odometry hardly moves
_LEAST = (0.15, 0.05)  # [m, rad] a pair with a smaller motion by its scans says nothing of a factor
_BEAMS = 180  # of a scan are enough
_KNOWN = 0.05  # [m] a match is known worse than this along a corridor
_ENOUGH = 10  # pairs that a verdict needs
_NOISE = 0.03  # [m, rad] of a pair; a way that is off farther counts less (Cauchy)
_ASIDE = 1.0  # [m] standard deviation of how far a laser stands from where the log says
_AGREES = 0.2  # of its motion a pair that agrees is off at most, besides the noise; most pairs must
_RIGHT = (0.8, 1.25)  # factors that are no gross error: floors, payload and tyres make a few percent
_NEAR = (0.25, 0.2)  # [m, rad] nor is a laser that stands no farther from where it is said to: SLAM hardly suffers
_MENDED = (0.2, 5.0)  # factors that can be put right: beyond, odometry says nothing


@dataclass(frozen=True)
class Calibration:
    """What odometry says for what the scans show, and where the laser stands; `nan` where too few pairs of scans tell.

    Attributes:
        way: Metres that odometry tells for each metre of the scans.
        turn: Radians that odometry tells for each radian of the scans.
        mirrored: Whether the scans turn the other way round than the odometry does; `turn` is that of scans put right.
        moved: (x, y, theta) of what the log calls the robot, by where its laser is, seen from the robot whose motion
            odometry tells [m, m, rad]; zero where the log is right about the laser.
        pairs: How many pairs of scans told (way, turn).
    """

    way: float = math.nan
    turn: float = math.nan
    mirrored: bool = False
    moved: tuple[float, float, float] = (0.0, 0.0, 0.0)
    pairs: tuple[int, int] = (0, 0)

    @property
    def misplaced(self) -> bool:
        """Whether the laser stands elsewhere than the log says."""
        x, y, theta = self.moved
        return math.hypot(x, y) > _NEAR[0] or abs(theta) > _NEAR[1]

    @property
    def wrong_factors(self) -> dict[str, float]:
        """The grossly wrong factors, by the unit that they are of."""
        factors = {"metre": self.way, "radian": self.turn}
        return {unit: value for unit, value in factors.items() if not (_within(value, _RIGHT) or math.isnan(value))}

    @property
    def usable(self) -> bool:
        """Whether the odometry can be put right."""
        return all(_within(value, _MENDED) for value in self.wrong_factors.values())


def calibration(drive: RecordedDrive) -> Calibration:
    """Return how the laser of a drive stands on the robot and by which factors its odometry is off.

    The pairs are matched on the whole circle and 2 m around no motion at all, so that nothing of the odometry enters.
    Along a corridor, where a match is blind, and where several places fit, a pair does not count.

    Args:
        drive: With odometry.
    """
    mount = np.asarray(drive.scans[0].T_robot_lidar if len(drive) else (0.0, 0.0, 0.0), dtype=np.float64)
    told, seen = _matched(drive)
    turns = np.abs(seen[:, 2]) > _LEAST[1]
    turn = _slope(told[turns, 2], seen[turns, 2])
    mirrored = turn < 0.0
    if mirrored:
        seen, turn = seen * [1.0, -1.0, -1.0], -turn
    seen = compose(compose(mount, seen), inverse(mount))
    moves = np.hypot(seen[:, 0], seen[:, 1]) > _LEAST[0]
    count = (int(moves.sum()), int(turns.sum()))
    found = _fitted(told, seen) if count[0] >= _ENOUGH else None
    if found is None:
        return Calibration(turn=turn, mirrored=mirrored, pairs=count)
    factor, lever = found
    way = abs(factor)
    if not way >= _MENDED[0]:
        return Calibration(way, turn, mirrored, pairs=count)
    aside = 0.0j if math.isnan(turn) else lever / way  # turns alone tell it
    theta = math.atan2(factor.imag, factor.real)
    return Calibration(way, turn, mirrored, (aside.real, aside.imag, theta), count)


def calibrated(drive: RecordedDrive) -> RecordedDrive:
    """Return the drive with its odometry, and a mirrored scan, put right where they are grossly wrong; notes say so.

    The poses are still those of what the log calls the robot: where its laser stands elsewhere on the robot than the
    log says, the odometry becomes that of a robot which carries its laser there. Else, and without odometry, it is the
    same drive.
    """
    if not drive.has_odometry:
        return drive
    found = calibration(drive)
    notes = said_of(found, np.asarray(drive.scans[0].T_robot_lidar) if len(drive) else np.zeros(3))
    if not notes:
        return drive
    if not found.usable:
        return replace(drive, notes=(*drive.notes, *notes))
    right = CalibratedOdometry(found)
    odometry = [right.update(pose) for pose in drive.odometry]
    scans = [_turned_over(scan) for scan in drive.scans] if found.mirrored else drive.scans
    return replace(drive, odometry=np.array(odometry), scans=scans, notes=(*drive.notes, *notes))


def thinned(scan: LaserScan) -> LaserScan:
    """Return a scan of fewer beams: enough of them to match it."""
    step = max(1, len(scan) // _BEAMS)
    return replace(scan, ranges=scan.ranges[::step], bearings=scan.bearings[::step])


class CalibratedOdometry:
    """Puts odometry right where it is grossly wrong, pose by pose; it begins as it is told.

    Args:
        found: What is wrong with it.
    """

    def __init__(self, found: Calibration) -> None:
        wrong = found.wrong_factors if found.usable else {}
        way, turn = wrong.get("metre", 1.0), wrong.get("radian", 1.0)
        self._factors = np.array([way, way, turn])
        self._moved = np.array(found.moved) if found.usable and found.misplaced else np.zeros(3)
        self._told: Array | None = None
        self._pose = np.zeros(3)

    def update(self, told: Array) -> Array:
        """Return (3,) where what the log calls the robot is, for its next pose (3,) as the odometry tells it."""
        if self._told is None:
            self._pose = self._told = told
        step = between(self._told, told) / self._factors
        self._pose = compose(self._pose, compose(compose(inverse(self._moved), step), self._moved))
        self._told = told
        return self._pose


def said_of(found: Calibration, mount: Array) -> list[str]:
    """Return what is grossly wrong, a sentence each; `mount` is T_robot_lidar (3,) as the log says."""
    pairs, said = f"({max(found.pairs)} pairs of scans)", []
    wrong = [f"{value:.2f} {unit}s for each {unit}" for unit, value in found.wrong_factors.items()]
    if wrong:
        what = "that is taken out" if found.usable else "poses may be wrong"
        said.append(f"odometry is grossly wrong: it says {' and '.join(wrong)} that the scans show {pairs}; {what}")
    if found.usable and found.mirrored:
        said.append(f"scans turn the other way round than the odometry {pairs}: the laser counts as upside down")
    if found.usable and found.misplaced:
        x, y, theta = (np.round(compose(np.array(found.moved), mount), 2) + 0.0).tolist()
        place = f"{x:.2f} m ahead and {y:.2f} m to the left, turned by {math.degrees(theta):.0f} degrees"
        said.append(f"the laser does not stand on the robot as said, but {place}, by odometry and scans {pairs}")
    return said


def _within(value: float, limits: tuple[float, float]) -> bool:
    return limits[0] <= value <= limits[1]


def _matched(drive: RecordedDrive) -> tuple[Array, Array]:
    """Return (n, 3) motions of the robot by its odometry, and (n, 3) those of the laser by its scans."""
    tool, told, seen = make_matcher("global", second_maxima=0), list[Array](), list[Array]()
    last = len(drive) - 1
    for first in np.unique(np.linspace(0, max(last - 1, 0), _PAIRS).astype(np.int64)).tolist():
        second = _partner(drive.odometry, first, last)
        if second is None:
            continue
        found = tool.match(thinned(drive.scans[first]), thinned(drive.scans[second]), (0.0, 0.0, 0.0))
        if found.converged and np.linalg.eigvalsh(found.covariance[:2, :2])[-1] <= _KNOWN**2:
            told.append(between(drive.odometry[first], drive.odometry[second]))
            seen.append(np.asarray(found.pose))
    return np.array(told).reshape(-1, 3), np.array(seen).reshape(-1, 3)


def _partner(odometry: Array, first: int, last: int) -> int | None:
    """Return the scan that makes a pair with `first`: where the odometry has gone far enough, or some scans later."""
    for second in range(first + 1, min(first + _MOST_SCANS, last) + 1):
        motion = between(odometry[first], odometry[second])
        if np.hypot(motion[0], motion[1]) >= _FAR[0] or abs(motion[2]) >= _FAR[1]:
            return second
    return min(first + _MOST_SCANS, last) if first < last else None


def _slope(told: Array, seen: Array) -> float:
    """Return what makes `told` (n,) of `seen` (n,) with the least sum of absolute errors; nan: most do not obey it."""
    if len(seen) < _ENOUGH:
        return math.nan
    ratios, weights = told / seen, np.abs(seen)
    order = np.argsort(ratios, kind="stable")
    share = np.cumsum(weights[order]) / weights.sum()
    slope = float(ratios[order][np.searchsorted(share, 0.5)])
    return slope if _agree(told - slope * seen, seen) else math.nan


def _agree(off: NDArray[np.generic], motions: NDArray[np.generic]) -> bool:
    """Return whether most `motions` (n,) are explained; `off` (n,) is what is left of them."""
    return bool(np.mean(np.abs(off) <= _NOISE + _AGREES * np.abs(motions)) > 0.5)


def _fitted(told: Array, seen: Array) -> tuple[complex, complex] | None:
    """Return f and l of the module's equation for motions (n, 3) of both; None: most pairs do not obey it."""
    way, said = seen[:, 0] + 1j * seen[:, 1], told[:, 0] + 1j * told[:, 1]
    lever = 1.0 - np.exp(1j * seen[:, 2])

    def off(numbers: Array) -> NDArray[np.complex128]:
        return said - complex(*numbers[:2]) * way - complex(*numbers[2:]) * lever

    def residuals(numbers: Array) -> Array:
        away = off(numbers) / _NOISE
        return np.concatenate((away.real, away.imag, numbers[2:] / _ASIDE))

    start = least_squares(residuals, np.array([1.0, 0.0, 0.0, 0.0])).x
    numbers = least_squares(residuals, start, loss="cauchy").x
    return (complex(*numbers[:2]), complex(*numbers[2:])) if _agree(off(numbers), way) else None


def _turned_over(scan: LaserScan) -> LaserScan:
    """Return a scan of a laser that hangs upside down."""
    return replace(scan, ranges=scan.ranges[::-1], bearings=-scan.bearings[::-1])
