"""What every scan matcher takes and returns."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..scan import LaserScan


@dataclass(frozen=True, eq=False)
class Match:
    """What a matcher made of two scans.

    Attributes:
        pose: (3,) T_reference_new, the pose of the new scan's laser in the reference scan's laser frame [m, m, rad].
        covariance: (3, 3) of that pose, in the reference's frame. Directions that the two scans say nothing about, as
            along a corridor, have the variance of the matcher's prior, metres wide.
        score: Share of the new scan's points that meet a surface of the reference there, in [0, 1].
        converged: Whether the matcher believes in the pose: it came to rest, enough points agree, nothing else fits.
            See `is_blind` for what it cannot know.
        iterations: Steps of the refinement.
        evaluations: Poses scored by the search before it; 0 where there is none.
        ambiguous: Whether another pose, elsewhere, explains the scan about as well (only a search can tell).
        alternatives: (m, 3) such other poses, best first.
        searched: (3,) where the search before the refinement ended; None where there is none.
    """

    pose: NDArray[np.float64]
    covariance: NDArray[np.float64]
    score: float
    converged: bool
    iterations: int
    evaluations: int = 0
    ambiguous: bool = False
    alternatives: NDArray[np.float64] | None = None
    searched: NDArray[np.float64] | None = None

    @property
    def is_blind(self) -> bool:
        """Whether the scans leave a direction open, as along a corridor: a standard deviation above 0.5 m or rad.

        A blind match may have `converged`: it is right but for that direction.
        """
        return bool(np.linalg.eigvalsh(self.covariance)[-1] > 0.25)


class Matcher(Protocol):
    """Finds where a scan was taken, seen from another one."""

    def match(self, reference: LaserScan, new: LaserScan, guess: ArrayLike) -> Match:
        """Return the pose of `new` in the frame of `reference`, looking around `guess` (3,) [m, m, rad].

        What is computed from the reference alone is kept for the next call with the same reference.
        """
        ...
