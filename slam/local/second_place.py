"""A second place where the robot may be, followed for some scans beside the first.

Where a scan fits as if the odometry had failed, and hardly where the odometry has the robot, odometry that hardly ever
fails is believed all the same. One scan cannot decide that; the next ones do, each of which fits again at the one place
and not at the other: multiple hypothesis tracking (Reid 1979), of two. Meanwhile scans are drawn at the first place,
which speaks for it: what is new there fits from then on.
"""

import math

from ..scan_to_grid.scan_matcher import DOUBT
from .hypothesis_matching import Look, are_apart
from .switching_motion import SwitchingMotion, likeliest

_SCANS = 5  # it is followed for so many: by then nearly all have been decided
_HOPELESS = 8.0  # nats behind


class SecondPlace:
    """A second place where the robot may be.

    Args:
        motion: The motion up to the scan that began it, which becomes that of the robot at the second place.
        look: What was found at that scan, a rival among it.

    Attributes:
        motion: The motion of the robot if it is there.
    """

    def __init__(self, motion: SwitchingMotion, look: Look) -> None:
        assert look.rival
        hypothesis, match, self._behind = look.rival
        self.motion, self._left = motion, _SCANS
        motion.take(look.hypotheses, hypothesis, match.pose, -math.inf if hypothesis.sound else math.inf, match)

    def weigh(self, first: Look, here: Look) -> None:
        """Take note of what was found of the next scan at the `first` place and `here`."""
        self._behind += here.cost - first.cost
        self._left -= 1
        if here.match and first.match and not are_apart(here.match, first.match):
            self._behind = math.inf  # the two have become one

    def follow(self, here: Look) -> None:
        """Go on to where the scan was found `here`."""
        if here.in_question or here.match is None:
            motion = likeliest(self.motion, here.hypotheses)
            self.motion.take([motion], motion, motion.prediction.pose, None)
        else:
            self.motion.take(here.hypotheses, here.motion, here.match.pose, here.lead, here.match)

    @property
    def is_likelier(self) -> bool:
        """Whether the robot is here rather than at the first place."""
        return self._behind < -DOUBT

    @property
    def is_over(self) -> bool:
        """Whether it need not be followed any longer."""
        return self._left <= 0 or self._behind > _HOPELESS
