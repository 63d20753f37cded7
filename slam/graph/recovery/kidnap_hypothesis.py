"""What a robot in doubt makes of its last scans: it is where it was thought to be, it has been carried, or it waits."""

from enum import Enum

import numpy as np
from numpy.typing import NDArray

from ...scan import LaserScan
from ..local.match_monitor import MatchMonitor
from .place_comparison import PlaceComparison

Array = NDArray[np.float64]

SCANS = 9
"""So many of the last scans are weighed."""

_EVERY = 3  # a doubt is weighed with each so many scans, once it has `SCANS` of them with each so many
_WIDE = 0.3  # share of the returns that people who step into view do not make contradict
_TRUST, _TRUST_WIDE = 5000.0, 10.0  # a robot is hardly ever carried, and narrow tears are frequent
_BLOCKED = 0.05  # share of the beams that walls of the map would stop, of those that people and drift make
_EXPLAINED = 0.5  # share of the beams that must end at walls of the map where the robot is believed to have stayed


class Verdict(Enum):
    """HERE: where it was thought to be. UNSURE: it may be elsewhere. KIDNAPPED: it is elsewhere."""

    HERE = "here"
    UNSURE = "unsure"
    KIDNAPPED = "carried"


class KidnapHypothesis:
    """The scans since something began to be wrong.

    Attributes:
        scans: Odometry poses T_odom_robot (3,) and scans, the last ones.
        count: How many scans there were in all.
        torn: Share of the returns by which it began with a scan that did not go on from the one before; 0: it did.
        unsure: Whether the robot may be elsewhere.
        nodes: So many nodes there were before a tear: what was mapped since proves nothing.
    """

    def __init__(self) -> None:
        self.scans: list[tuple[Array, LaserScan]] = []
        self.count = 0
        self.torn, self.unsure = 0.0, False
        self.nodes: int | None = None

    def begin(self) -> None:
        """Keep scans from the next one on."""
        self.scans, self.count = [], 0

    def tear(self, share: float, nodes: int) -> None:
        """Begin with the next scan; a wider tear than the one before says more.

        Args:
            share: Of its returns, and of those of the one before, so many contradict the other.
            nodes: There were so many nodes by then.
        """
        self.begin()
        self.torn, self.nodes = share, nodes if self.nodes is None else self.nodes
        self.unsure |= self.wide

    def add(self, odometry: Array, scan: LaserScan) -> None:
        """Keep a scan."""
        self.scans = [*self.scans, (odometry, scan)][-SCANS:]
        self.count += 1

    def conclude(self, outcome: Verdict) -> None:
        """Take a verdict: a tear is mended once the robot is where it was thought to be."""
        self.unsure = outcome is not Verdict.HERE
        if outcome is Verdict.HERE:
            self.torn, self.nodes = 0.0, None

    @property
    def wide(self) -> bool:
        """Whether it began with a tear that people who step into view do not make."""
        return self.torn >= _WIDE

    @property
    def trust(self) -> float:
        """How many times likelier the robot is where it was thought to be than elsewhere, before scans are weighed."""
        return _TRUST_WIDE if self.wide else _TRUST

    @property
    def due(self) -> bool:
        """Whether a tear should be weighed now."""
        return self.torn > 0.0 and self.count % (_EVERY if self.count <= SCANS else SCANS) == 0


def verdict(doubt: KidnapHypothesis, watch: MatchMonitor, outcome: PlaceComparison | None) -> Verdict:
    """Weigh the place where local SLAM has put the scans of a doubt against the rest of the map.

    Where a scan did not go on from the one before, the robot may have been carried. So it was where another place is
    sure and, unless the tear was wide, explains well what was seen, while walls of the map would stop some beams where
    it was thought to be: what is not mapped yet may look like what is. It stayed where that place explains half of the
    beams, and no other place is likely. If that is still open after `SCANS` scans, it stayed unless the tear was wide;
    then it was carried where the place explains less. While the scans alone speak for another place, it is not sure
    that it stayed.

    Where all scans went on from those before, nobody has carried it: scans that fit badly are seen where people walk
    and where short rays let local SLAM drift, and in a building that repeats itself another place then explains them
    better. Only scans that cannot belong to the newest submap at all are believed to show that all the same.

    Args:
        doubt: With its scans.
        watch: What the newest submap says of them.
        outcome: How the place fared; None: hardly anything is mapped yet.
    """
    if outcome is None:
        return Verdict.KIDNAPPED if watch.plainly_lost else Verdict.UNSURE
    surely_here = outcome.stays and (outcome.belief.sure or not len(outcome.belief.poses))
    explained = outcome.explained >= _EXPLAINED
    elsewhere = outcome.surpassed and not outcome.beside
    if doubt.torn:
        refuted = doubt.wide or (outcome.moved and outcome.blocked >= _BLOCKED)
        if (elsewhere and refuted) or (watch.plainly_lost and not explained):
            return Verdict.KIDNAPPED
        if surely_here or (explained and not outcome.rivalled) or (doubt.count >= SCANS and not doubt.wide):
            return Verdict.UNSURE if outcome.outweighed else Verdict.HERE
        return Verdict.KIDNAPPED if doubt.count >= SCANS and outcome.fits < _EXPLAINED else Verdict.UNSURE
    if surely_here or not (outcome.rivalled or watch.alarmed):
        return Verdict.HERE
    lost = watch.plainly_lost and (not explained or outcome.moved or elsewhere)
    return Verdict.KIDNAPPED if lost else Verdict.UNSURE
