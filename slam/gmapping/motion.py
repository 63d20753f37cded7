"""The odometry motion model: how far the true motion may be from the measured one."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..geometry import compose, wrap_one

Array = NDArray[np.float64]

_WORTH = 3.0  # matched scans: so much counts what is known of any odometry
_LEAST_SCALE = 0.1
_MOST_SQUARE = 9.0  # a motion three standard deviations off is not the odometry's noise
_SIDEWAYS = 0.3  # share of `srr` that acts across the direction of motion
FLOOR = np.array([0.005, 0.005, 0.0025])  # [m, m, rad] what an odometry that stands still may be off by


class MotionModel:
    """Gathers odometry between two matched scans into a mean motion and its covariance.

    Each increment (dx, dy, dtheta), seen from where it began, is off by independent Gaussian errors with standard
    deviations srr |dx| + str |dtheta| + 0.3 srr |dy|, likewise for y, and stt |dtheta| + srt |(dx, dy)|. Over the way
    from one matched scan to the next the three errors keep their sign: they add up, however often odometry is read. The
    original draws them anew at every reading, which at 10 Hz makes a wheel that is 5 % too small look like an odometry
    that is good to 2 %; on slipping reference drives that costs a factor of five to eight in accuracy. Where nothing
    is seen for a hundred metres they do not keep it longer: else the robot might soon be anywhere.

    So far off any odometry may be. Most are better, and where scans say little, particles that are moved by ten times
    the odometry's error are soon far apart: its own `scale` is learned from scans that tell where the robot is.

    Attributes:
        mean: (3,) the gathered motion [m, m, rad].
        travelled, turned: Way [m] and turns [rad] of it, added up.
        scale: (3,) the odometry's standard deviations as a share of those above, at most 1: one for x and y, one for
            the heading.

    Args:
        srr: Translation error per translation [m/m].
        srt: Rotation error per translation [rad/m].
        str_: Translation error per rotation [m/rad].
        stt: Rotation error per rotation [rad/rad].
        memory: Over so many matched scans `scale` is learned.
        way, turn: Errors keep their sign over so much motion [m] or turning [rad].
    """

    def __init__(
        self,
        srr: float,
        srt: float,
        str_: float,
        stt: float,
        memory: float = 30.0,
        way: float = np.inf,
        turn: float = np.inf,
    ) -> None:
        self.srr, self.srt, self.str_, self.stt = srr, srt, str_, stt
        self.scale = np.ones(3)
        self._keep, self._way, self._turn = 1.0 - 1.0 / memory, way, turn
        self._squares, self._known = np.zeros(2), np.zeros(2)  # of late, for the positions and for the headings
        self.reset()

    def reset(self) -> None:
        """Start again from a motion of zero."""
        self.mean: Array = np.zeros(3)
        self._root: Array = np.zeros((3, 3))  # columns: one standard deviation of each of the three errors
        self._settled: Array = np.diag(FLOOR**2)  # covariance of what has nothing to do with them
        self.travelled = self._since_way = 0.0
        self.turned = self._since_turn = 0.0

    def add(self, increment: Array) -> None:
        """Append `increment` (3,), T_before_after by odometry."""
        dx, dy, dtheta = increment.tolist()
        carry, turn = carried(self.mean.item(2), increment)
        self._root = carry @ self._root + turn * (self.scale * self.deviations(increment))
        self._settled = carry @ self._settled @ carry.T
        self.mean = compose(self.mean, increment)
        way, turned = float(np.hypot(dx, dy)), abs(dtheta)
        self.travelled, self._since_way = self.travelled + way, self._since_way + way
        self.turned, self._since_turn = self.turned + turned, self._since_turn + turned
        if self._since_way >= self._way or self._since_turn >= self._turn:
            self._settled += self._root @ self._root.T
            self._root = np.zeros((3, 3))
            self._since_way = self._since_turn = 0.0

    @property
    def covariance(self) -> Array:
        """(3, 3) covariance of the gathered motion, in the frame where it began."""
        return self._root @ self._root.T + self._settled

    def covariance_at(self, motion: Array) -> Array:
        """Return the covariance (3, 3) of the gathered motion, wider where the robot is believed to have gone another
        `motion` (3,) that it does not explain: an odometry that stands still once is not as good as it used to be."""
        off, covariance = self._off(motion), self.covariance
        return covariance * max(1.0, float(off @ np.linalg.solve(covariance, off)) / 3.0)

    def learn(self, motion: Array, prior: Array, posterior: Array) -> None:
        """Take what a scan made of the gathered motion.

        Along the axes that both leave independent, and in units of the prior, let the scan contribute a share k of what
        is known afterwards. The mean square of how far it moves the robot is then k^2 times that of the odometry's
        errors, and k (1 - k) by the scan's own. A scan that tells nothing (k = 0) teaches nothing.

        Args:
            motion: (3,) by the odometry and the scan.
            prior: (3, 3) covariance by the odometry, as of `covariance_at`.
            posterior: (3, 3) covariance of `motion`.
        """
        off = self._off(motion)
        for i, block in enumerate((slice(0, 2), slice(2, 3))):
            root = np.linalg.inv(np.linalg.cholesky(prior[block, block]))
            shares, axes = np.linalg.eigh(np.eye(len(root)) - root @ posterior[block, block] @ root.T)
            shares = shares.clip(0.0, 1.0)
            squares = np.minimum((axes.T @ (root @ off[block])) ** 2, _MOST_SQUARE) - shares * (1.0 - shares)
            self._squares[i] = self._keep * self._squares[i] + self.scale[2 * i] ** 2 * np.mean(squares)
            self._known[i] = self._keep * self._known[i] + np.mean(shares**2)
        learned = (_WORTH + self._squares) / (_WORTH + self._known)
        self.scale = np.sqrt(learned.clip(_LEAST_SCALE**2, 1.0))[[0, 0, 1]]

    def _off(self, motion: Array) -> Array:
        """Return how far a motion (3,) is from the gathered one."""
        off = motion - self.mean
        off[2] = wrap_one(off.item(2))
        return off

    def deviations(self, increment: Array) -> Array:
        """Return the standard deviations (3,) of an increment (3,) [m, m, rad]."""
        dx, dy, dtheta = map(abs, increment.tolist())  # plain numbers: half the time of numpy's
        return np.array(
            (
                self.srr * dx + self.str_ * dtheta + _SIDEWAYS * self.srr * dy,
                self.srr * dy + self.str_ * dtheta + _SIDEWAYS * self.srr * dx,
                self.stt * dtheta + self.srt * float(np.hypot(dx, dy)),
            )
        )


def carried(heading: float, increment: Array) -> tuple[Array, Array]:
    """Return what an increment (3,) from a pose of that heading [rad] does to errors: (3, 3) of the pose before, and
    (3, 3) of the increment itself."""
    dx, dy, _ = increment.tolist()
    cos, sin = math.cos(heading), math.sin(heading)
    carry = np.array(((1.0, 0.0, -sin * dx - cos * dy), (0.0, 1.0, cos * dx - sin * dy), (0.0, 0.0, 1.0)))
    return carry, np.array(((cos, -sin, 0.0), (sin, cos, 0.0), (0.0, 0.0, 1.0)))


def turned(covariance: Array, angles: ArrayLike) -> Array:
    """Return `covariance` (3, 3) of a pose in frames turned by `angles` (...), as (..., 3, 3)."""
    cos, sin = np.cos(angles), np.sin(angles)
    turns = np.zeros((*np.shape(angles), 3, 3))
    turns[..., 0, 0] = turns[..., 1, 1] = cos
    turns[..., 1, 0] = sin
    turns[..., 0, 1] = -sin
    turns[..., 2, 2] = 1.0
    return turns @ covariance @ turns.swapaxes(-1, -2)


def turned_once(covariance: Array, angle: float) -> Array:
    """`turned` for one `angle` [rad], at a third of the cost."""
    cos, sin = math.cos(angle), math.sin(angle)
    turn = np.array(((cos, -sin, 0.0), (sin, cos, 0.0), (0.0, 0.0, 1.0)))
    return turn @ covariance @ turn.T
