"""How far a robot's odometry can be believed: whether it is sound now, and how precise it is when it is."""

import math
import statistics

import numpy as np
from numpy.typing import NDArray

from ..geometry import between
from ..scan_to_grid.extrapolator import Prediction

Array = NDArray[np.float64]

_BREAKS, _HEALS = 0.001, 0.5  # probability that sound odometry fails with the next scan, and that a fault ends
_CHANCE = 0.1  # share of faulty motions that agree with both predictions
_SUREST = 1e-6  # never is it surer than this that odometry is sound, or is not
_ERRORS = 20  # so many of the newest tell how precise the odometry is; at first, they are those of its model
_MOST_PRECISE = 0.2  # of the error model's standard deviations: below, a match errs as much
_ROUGHEST = 5.0  # times those: beyond, it tells hardly anything
_MEDIAN = (1.177, 0.6745)  # of normal errors of standard deviation 1, in the plane and on a line


class OdometrySoundness:
    """The probability that odometry is sound, a hidden state that mostly stays as it was.

    Attributes:
        probability: Of being sound.
    """

    def __init__(self) -> None:
        self.probability = 1.0

    def advance(self, moves: bool) -> None:
        """Go on to the next scan; `moves` says whether the odometry has told any motion since the last one."""
        heals = _HEALS if moves else 0.0  # what is frozen, and does not move, is frozen still
        self.probability += (1.0 - self.probability) * heals - self.probability * _BREAKS

    def weigh(self, lead: float) -> None:
        """Learn from a match; `lead` is the logarithm of how many times likelier a fault explains it."""
        probability = 1.0 / (1.0 + math.exp(min(max(lead, -700.0), 700.0)))
        self.probability = min(max(probability, _SUREST), 1.0 - _SUREST)

    def agree(self) -> None:
        """Learn from a match that odometry moves the robot as it moved before."""
        self.probability /= self.probability + _CHANCE * (1.0 - self.probability)
        self.probability = min(self.probability, 1.0 - _SUREST)


class OdometryPrecision:
    """How precisely sound odometry predicts the next match: a median of the newest errors, which minds no slips.

    Attributes:
        shares: (2,) standard deviations of most motions [of those of the error model: translation, rotation].
    """

    def __init__(self) -> None:
        self.shares = np.ones(2)
        self._errors = [(1.0, 1.0)] * _ERRORS  # of translation and rotation

    def learn(self, prediction: Prediction, pose: Array) -> None:
        """Learn from what matching, `pose` (3,), made of a `prediction` by the error model."""
        x, y, turn = between(prediction.pose, pose).tolist()
        linear, angular = prediction.sigma.tolist()
        error = math.hypot(x, y) / (_MEDIAN[0] * linear), abs(turn) / (_MEDIAN[1] * angular)
        self._errors = [*self._errors[1:], error]
        medians = (statistics.median(errors) for errors in zip(*self._errors, strict=True))
        self.shares = np.array([min(max(share, _MOST_PRECISE), _ROUGHEST) for share in medians])
