"""Whether a robot's odometry can be believed now."""

import math

_BREAKS, _HEALS = 0.001, 0.5  # probability that sound odometry fails with the next scan, and that a fault ends
_CHANCE = 0.1  # share of faulty motions that agree with both predictions
_SUREST = 1e-6  # never is it surer than this that odometry is sound, or is not


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
