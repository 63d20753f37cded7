"""What wheels of the wrong size do to odometry, learned while driving: scale, turn and a turn with the way.

A robot's odometry rests on the diameters of its wheels and the distance between them, and both are known to some per
cent only: it tells too much or too little of the way, of its turns, and turns where the robot drives straight (Borenstein,
Feng 1996). These three factors stay as they are for long, so they are estimated from matched scans, by recursive
regression on each step, weighted by what the scan tells: in a corridor the walls say nothing of the way along it.
"""

import math

import numpy as np
from numpy.typing import NDArray

from .geometry import between, compose, wrap_one

Array = NDArray[np.float64]

_USUAL = np.array([1.0, 1.0, 0.0])  # [of the way, of a turn, rad/m] an odometry that is calibrated ...
_SPREAD = np.array([0.1, 0.1, 0.05])  # ... and how far odometries are from that, standard deviations
_MEMORY = 100.0  # way after which what was learned counts for 1/e: tyres lose air, floors change [m]
_FREEDOM = 4.0  # of the t distribution of a step's errors: wheels slip now and then


class OdometryCalibration:
    """Turns the odometry that a robot tells into what it would tell if its wheels were known well.

    Attributes:
        factors: (3,) the way by the way that is told, the turn by the turn that is told, and the turn that is not told
            by the way [rad/m].
    """

    def __init__(self) -> None:
        self.factors = _USUAL
        self._information = np.diag(_SPREAD**-2.0)
        self._told: Array | None = None  # odometry as the robot tells it ...
        self._odometry = np.zeros(3)  # ... and calibrated
        self._step = np.zeros(3)  # told since the last scan

    def apply(self, odometry: Array) -> Array:
        """Return the calibrated T_odom_robot (3,) of a scan that the robot tells as `odometry` (3,)."""
        if self._told is None:
            self._odometry = self._told = odometry
        self._step, self._told = between(self._told, odometry), odometry
        self._odometry = compose(self._odometry, self._model(self._step) @ self.factors)
        return self._odometry

    def learn(self, step: Array, information: Array, sigma: Array) -> None:
        """Learn from two scans that were matched, the last and the one before.

        Args:
            step: (3,) how the robot moved between them by the matches, in its frame [m, m, rad].
            information: (3, 3) inverse covariance of that as far as the scan alone tells it.
            sigma: (2,) standard deviations of the odometry's other errors in this step [m, rad].
        """
        model = self._model(self._step)
        error = step - model @ self.factors
        error[2] = wrap_one(error.item(2))
        variance = np.square(sigma).tolist()
        noise = np.diag([variance[0], variance[0], variance[1]])
        weights = information @ np.linalg.inv(np.eye(3) + noise @ information)  # inverse of the sum of both covariances
        off = float(error @ weights @ error)
        weights *= (_FREEDOM + 3.0) / (_FREEDOM + off)
        self._forget(math.hypot(self._step[0], self._step[1]))
        self._information = self._information + model.T @ weights @ model
        self.factors = self.factors + np.linalg.solve(self._information, model.T @ (weights @ error))

    def _forget(self, way: float) -> None:
        kept = math.exp(-way / _MEMORY)
        prior = (1.0 - kept) * np.diag(_SPREAD**-2.0)
        self._information = kept * self._information + prior
        self.factors = self.factors + np.linalg.solve(self._information, prior @ (_USUAL - self.factors))

    @staticmethod
    def _model(step: Array) -> Array:
        """Return (3, 3) how a told `step` (3,) makes a motion of the factors."""
        x, y, turn = step.tolist()
        return np.array([[x, 0.0, 0.0], [y, 0.0, 0.0], [0.0, turn, math.hypot(x, y)]])
