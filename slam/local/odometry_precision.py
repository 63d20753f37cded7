"""How precise a robot's odometry is while it is sound, learned from what scans make of its predictions.

A scan that tells little ends where the odometry has it, whatever that is worth: how far matches are from predictions
says nothing then, and an odometry that is judged by it is believed the more, the less scans can tell. So what counts is
where the scan alone has the robot, and how far off that is likely to be. Each share of the error model's standard
deviations, from far more precise to far rougher, is as likely as it explains the newest of those.
"""

import math

import numpy as np
from numpy.typing import NDArray

from ..scan_to_grid.extrapolator import Prediction
from ..scan_to_grid.scan_matcher import GridMatch
from ..view_kernel import kernel

Array = NDArray[np.float64]

ROUGH = 0.3
"""Share of sound motions with errors as in the model, as where a wheel slips a little."""

_MEMORY = 100.0  # scans; what was seen so long ago counts for 1/e
_SHARES = np.geomspace(0.2, 5.0, 17)  # odometry errs the same way for long: none is taken for more precise than that
_USUAL = 0.3  # five robots' odometry has 0.1 to 0.9, that of worlds drawn 0.02 to 0.4
_BEFOREHAND = -0.5 * np.log(_SHARES / _USUAL) ** 2
_ODD = 1e-6  # likelihood of what no share explains: a match may be wrong altogether [1/m, 1/rad]
_TOLD = 1e-6  # a scan tells nothing where it knows less than so much of what the odometry does


class OdometryPrecision:
    """Learns the precision of sound odometry, of translations and of rotations.

    Attributes:
        shares: (2,) standard deviations of most motions [of those of the error model: translation, rotation].
    """

    def __init__(self) -> None:
        self._odds = np.stack((_BEFOREHAND, _BEFOREHAND))  # logarithms, of the shares of each
        self.shares = _expected(self._odds)

    def learn(self, model: Prediction, before: Array, used: Prediction, match: GridMatch) -> None:
        """Learn from a match.

        Args:
            model: By the odometry from where the last match was, as rough as its error model.
            before: (2,) standard deviations of that last match, and of what else is no error of this motion [m, rad].
            used: The prediction beside which the scan was matched, at the same place.
            match: Where that ended.
        """
        x, y, turn = (match.pose - model.pose).tolist()
        off = np.array((x, y, math.remainder(turn, 2.0 * math.pi)))
        self._odds = _weighed(self._odds, off, model.sigma, before, used.sigma, match.curvature)
        self.shares = _expected(self._odds)


def _expected(odds: Array) -> Array:
    """Return the geometric mean of the shares by each row of `odds` (2, n)."""
    weights = np.exp(odds - odds.max(axis=1, keepdims=True))
    return np.exp(weights @ np.log(_SHARES) / weights.sum(axis=1))


@kernel
def _weighed(odds: Array, off: Array, sigma: Array, before: Array, used: Array, curvature: Array) -> Array:
    """Return the `odds` (2, n) after a match that is `off` (3,) the prediction; see `OdometryPrecision.learn`."""
    keep = 1.0 - 1.0 / _MEMORY
    weighed = np.empty_like(odds)
    for i in range(2):
        weighed[i] = keep * odds[i] + (1.0 - keep) * _BEFOREHAND
    a, b, c = curvature[0, 0], curvature[0, 1], curvature[1, 1]
    angle = 0.5 * np.arctan2(2.0 * b, a - c)  # of the direction of which the scan tells most
    cos, sin = np.cos(angle), np.sin(angle)
    root = np.sqrt(0.25 * (a - c) ** 2 + b * b)
    _explain(weighed[0], cos * off[0] + sin * off[1], 0.5 * (a + c) + root, sigma[0], before[0], used[0])
    _explain(weighed[0], cos * off[1] - sin * off[0], 0.5 * (a + c) - root, sigma[0], before[0], used[0])
    _explain(weighed[1], off[2], curvature[2, 2], sigma[1], before[1], used[1])
    return weighed


@kernel
def _explain(odds: Array, off: float, told: float, sigma: float, before: float, used: float) -> None:
    """Add to `odds` (n,) how each share explains that a scan that knows `told` [1/m^2] moved the robot by `off`.

    A motion may be rough in one direction only: a wheel that slips errs along the way.
    """
    held = 1.0 / (used * used)
    if told <= _TOLD * held:
        return
    alone = off * (told + held) / told
    square, known = alone * alone, before * before + 1.0 / told
    for i in range(len(odds)):
        share = _SHARES[i]
        precise, rough = (share * sigma) ** 2 + known, (max(share, 1.0) * sigma) ** 2 + known
        likelihood = (1.0 - ROUGH) * np.exp(-0.5 * square / precise) / np.sqrt(precise)
        likelihood += ROUGH * np.exp(-0.5 * square / rough) / np.sqrt(rough)
        odds[i] += np.log(likelihood + _ODD)
