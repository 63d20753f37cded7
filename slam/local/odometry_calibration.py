"""What wheels of the wrong size do to odometry, learned while driving: scale, turn, and a turn with the way.

A robot's odometry rests on the diameters of its wheels and the distance between them, and both are known to some per
cent only: it tells too much or too little of the way and of its turns, and turns where the robot drives straight
(Borenstein, Feng 1996). These three factors stay as they are for long, so they are estimated from matched scans, by
recursive regression, stretch by stretch. What matching finds along a stretch may be wrong as a whole, as among walls
that look alike, so that one stretch tells no more than is known of odometry beforehand, however many scans it has.
"""

import math

import numpy as np
from numpy.typing import NDArray

from ..geometry import between, compose, turning

Array = NDArray[np.float64]

_USUAL = np.array([1.0, 1.0, 0.0])  # [of the way, of a turn, rad/m] an odometry that is calibrated ...
_SPREAD = np.array([0.1, 0.1, 0.05])  # ... and how far odometries are from that, standard deviations
_STRETCH = 5.0  # [m]
_UNKNOWN = np.square(_SPREAD[[0, 2]] * _STRETCH)  # [m^2, rad^2] mean squared error of a stretch by any odometry ...
_WORTH = 0.1  # ... which counts as so many stretches of the robot's own: odometries differ by a factor of ten
_MEMORY = 100.0  # way after which what was learned counts for 1/e: tyres lose air, floors change [m]
_FREEDOM = 4.0  # of the t distribution of a stretch's errors: wheels slip, and matches fail, now and then


class OdometryCalibration:
    """Turns the odometry that a robot tells into what it would tell if its wheels were known well.

    Attributes:
        factors: (3,) the way by the way that is told, the turn by the turn that is told, and the turn that is not told
            by the way ahead [rad/m].
    """

    def __init__(self) -> None:
        self.factors: Array = _USUAL
        self._information = np.diag(_SPREAD**-2.0)
        self._squared, self._learned = _WORTH * _UNKNOWN, _WORTH  # of stretches: what they were off by, squared; number
        self._told: Array | None = None  # odometry as the robot tells it ...
        self._odometry = np.zeros(3)  # ... and calibrated
        self._step = np.zeros(3)  # told since the last scan
        self._begin()

    def _begin(self) -> None:
        """Begin a stretch."""
        self._went = np.zeros(3)  # by the matches ...
        self._expected = np.zeros(3)  # ... and by the calibrated odometry
        self._model = np.zeros((3, 3))  # derivative of that by the factors, which stay as they are meanwhile
        self._seen = np.zeros((3, 3))  # sum of the scans' informations of the pose ...
        self._scans = 0  # ... and of how many
        self._way = self._turned = 0.0  # told [m, rad]

    def apply(self, odometry: Array) -> Array:
        """Return the calibrated T_odom_robot (3,) of a scan that the robot tells as `odometry` (3,)."""
        if self._told is None:
            self._odometry = self._told = odometry
        self._step, self._told = between(self._told, odometry), odometry
        self._odometry = compose(self._odometry, _calibrated(self._step, self.factors)[0])
        return self._odometry

    def learn(self, step: Array, information: Array) -> None:
        """Learn from two scans that were matched, the last and the one before.

        Args:
            step: (3,) how the robot moved between them by the matches, in its frame at the first [m, m, rad].
            information: (3, 3) inverse covariance of that as far as the scan alone tells it, in the same frame.
        """
        rotation = turning(self._went.item(2))
        expected, model = _calibrated(self._step, self.factors)
        self._model += rotation @ model
        self._expected += rotation @ expected
        self._went += rotation @ step
        self._seen += rotation @ information @ rotation.T
        self._scans += 1
        self._way += math.hypot(self._step[0], self._step[1])
        self._turned += abs(self._step.item(2))
        if self._way >= _STRETCH:
            self._regress()
            self._begin()

    def drift(self, way: float) -> Array:
        """Return (2,) how far off odometry leads over a `way` [m] without a scan, standard deviations [m, rad].

        Each stretch has an error of its own, and what the factors are off by is the same in all. Where on the way the
        robot made a turn is not known, so that one which odometry does not tell cannot be made good. A heading that
        goes off evenly leads aside by its mean, as a random walk's, by a share 1 / sqrt(3) of the way.
        """
        stretches = way / _STRETCH
        errors = np.sqrt(self._squared / self._learned * (stretches + stretches**2 / max(self._learned, 1.0)))
        turn = math.hypot(errors[1], self.factors[2] * way)
        return np.array([math.hypot(errors[0], min(turn, 1.0) * way / math.sqrt(3.0)), turn])

    def _regress(self) -> None:
        """Learn from a stretch."""
        error = self._went - self._expected - self._model @ self._forget()
        along, turn, drift = (_SPREAD * (self._way, self._turned, self._way)).tolist()
        noise = np.diag([along**2, along**2, turn**2 + drift**2])
        seen = self._seen / self._scans
        before = self._model @ np.linalg.solve(self._information, self._model.T)
        expected = seen @ np.linalg.inv(np.eye(3) + (noise + before) @ seen)
        weights = seen @ np.linalg.inv(np.eye(3) + noise @ seen)  # inverse of the sum of both covariances
        x, y, turned = (np.square(error) + np.diag(noise - noise @ weights @ noise)).tolist()  # and what is not told
        self._squared = self._squared + np.array([0.5 * (x + y), turned]) * _STRETCH / self._way
        self._learned += 1.0
        weights *= (_FREEDOM + 3.0) / (_FREEDOM + float(error @ expected @ error))
        self._information = self._information + self._model.T @ weights @ self._model
        self.factors = self.factors + np.linalg.solve(self._information, self._model.T @ (weights @ error))

    def _forget(self) -> Array:
        """Return (3,) by how much the factors change, since what was learned long ago counts for less."""
        kept = math.exp(-self._way / _MEMORY)
        prior = (1.0 - kept) * np.diag(_SPREAD**-2.0)
        self._information = kept * self._information + prior
        self._squared = kept * self._squared + (1.0 - kept) * _WORTH * _UNKNOWN
        self._learned = kept * self._learned + (1.0 - kept) * _WORTH
        before = self.factors
        self.factors = before + np.linalg.solve(self._information, prior @ (_USUAL - before))
        return self.factors - before


def _calibrated(step: Array, factors: Array) -> tuple[Array, Array]:
    """Return the motion (3,) that a told `step` (3,) was by the factors, and its derivative (3, 3) by them.

    A robot turns on its way: what it turns more than it tells leads it aside by half of that.
    """
    x, y, turn = step.tolist()
    way, by_turn, by_way = factors.tolist()
    turned = by_turn * turn + by_way * x
    aside = 0.5 * (turned - turn)
    cos, sin = math.cos(aside), math.sin(aside)
    x_way, y_way = cos * x - sin * y, sin * x + cos * y
    x_aside, y_aside = -0.5 * way * y_way, 0.5 * way * x_way
    model = [[x_way, turn * x_aside, x * x_aside], [y_way, turn * y_aside, x * y_aside], [0.0, turn, x]]
    return np.array([way * x_way, way * y_way, turned]), np.array(model)
