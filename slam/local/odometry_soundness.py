"""Whether a robot's odometry can be believed now, and how often it fails."""

import math

_FAILS, _HEALS = 0.001, 0.5  # probability that sound odometry fails with the next scan, and that a fault ends
_WORTH = 200.0  # scans for which that first counts beside those of the robot: wheels that slip once will slip again
_CHANCE = 0.1  # share of faulty motions that agree with both predictions
_SUREST = 1e-6  # never is it surer than this that odometry is sound, or is not


class OdometrySoundness:
    """The probability that odometry is sound, a hidden state that mostly stays as it was.

    How often it fails is learned: the mean of a beta distribution, which begins with what is known of any odometry.

    Attributes:
        probability: Of being sound.
    """

    def __init__(self) -> None:
        self.probability = 1.0
        self._failures, self._scans = _FAILS * _WORTH, _WORTH
        self._new = 0.0  # probability that a fault, if there is one, has begun with the last scan

    def advance(self, moves: bool) -> None:
        """Go on to the next scan; `moves` says whether the odometry has told any motion since the last one."""
        heals = _HEALS if moves else 0.0  # what is frozen, and does not move, is frozen still
        self._scans += 1.0
        begins = self.probability * self._failures / self._scans
        goes_on = (1.0 - self.probability) * (1.0 - heals)
        self._new, self.probability = begins / (begins + goes_on), 1.0 - begins - goes_on

    def weigh(self, lead: float) -> None:
        """Learn from a match; `lead` is the logarithm of how many times likelier a fault explains it."""
        probability = 1.0 / (1.0 + math.exp(min(max(lead, -700.0), 700.0)))
        self.probability = min(max(probability, _SUREST), 1.0 - _SUREST)
        self._failures += self._new * (1.0 - self.probability)

    def agree(self) -> None:
        """Learn from a match that odometry moves the robot as it moved before."""
        self.probability /= self.probability + _CHANCE * (1.0 - self.probability)
        self.probability = min(self.probability, 1.0 - _SUREST)
