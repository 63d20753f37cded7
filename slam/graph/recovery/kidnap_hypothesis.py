"""The hypothesis that the robot was kidnapped: the scans that speak for it, and what is concluded from them."""

from enum import Enum

import numpy as np
from numpy.typing import NDArray

from ...scan import LaserScan

Array = NDArray[np.float64]

SCANS = 9
"""So many of the last scans are weighed."""

_EVERY = 3  # the hypothesis is weighed with each so many scans, once it has `SCANS` of them with each so many
_STRONG = 0.3  # share of the returns that people who step into view do not make contradict
_TRUST, _TRUST_STRONG = 5000.0, 10.0  # a robot is hardly ever kidnapped, and weak inconsistencies are frequent


class Verdict(Enum):
    """HERE: where it was thought to be. UNSURE: it may be elsewhere. KIDNAPPED: it is elsewhere."""

    HERE = "here"
    UNSURE = "unsure"
    KIDNAPPED = "kidnapped"


class KidnapHypothesis:
    """The scans since something began to be wrong.

    Attributes:
        scans: Odometry poses T_odom_robot (3,) and scans, the last ones.
        count: How many scans there were in all.
        inconsistency: Share of the returns that contradicted each other in the two scans with which it began; 0: those
            were consistent, and it began with scans that contradict the submap.
        unsure: Whether the robot may be elsewhere.
        trusted_nodes: So many nodes there were before the inconsistency: what was mapped since proves nothing.
    """

    def __init__(self) -> None:
        self.scans: list[tuple[Array, LaserScan]] = []
        self.count = 0
        self.inconsistency, self.unsure = 0.0, False
        self.trusted_nodes: int | None = None

    def restart(self) -> None:
        """Keep scans from the next one on."""
        self.scans, self.count = [], 0

    def begin(self, inconsistency: float, nodes: int) -> None:
        """Begin with the next scan, which is inconsistent with the one before.

        Args:
            inconsistency: Share of the returns of the two scans that contradict the other.
            nodes: There were so many nodes by then.
        """
        self.restart()
        self.inconsistency = inconsistency
        self.trusted_nodes = nodes if self.trusted_nodes is None else self.trusted_nodes
        self.unsure |= self.strong

    def add(self, odometry: Array, scan: LaserScan) -> None:
        """Keep a scan."""
        self.scans = [*self.scans, (odometry, scan)][-SCANS:]
        self.count += 1

    def conclude(self, outcome: Verdict) -> None:
        """Take a verdict: the hypothesis is dropped once the robot is where it was thought to be."""
        self.unsure = outcome is not Verdict.HERE
        if outcome is Verdict.HERE:
            self.inconsistency, self.trusted_nodes = 0.0, None

    @property
    def strong(self) -> bool:
        """Whether it began with an inconsistency that people who step into view do not make."""
        return self.inconsistency >= _STRONG

    @property
    def trust(self) -> float:
        """How many times likelier the robot is where it was thought to be than elsewhere, before scans are weighed."""
        return _TRUST_STRONG if self.strong else _TRUST

    @property
    def due(self) -> bool:
        """Whether it should be weighed now."""
        return self.inconsistency > 0.0 and self.count % (_EVERY if self.count <= SCANS else SCANS) == 0
