"""Numbers of the tracker of Ye et al. 2021."""

from dataclasses import dataclass, field
from typing import Annotated

from ...slam.bounds import Share, Within, check_numbers, check_positive
from ...slam.errors import InputError
from .config import MotionConfig


@dataclass(frozen=True, kw_only=True)
class Ye2021Config:
    """Table II, and what the paper is silent about.

    Attributes:
        motion: Prediction and correction (q, r); 5 Hz, where the paper prints no rate: so a person survives a full
            occlusion of one second under epsilon (at 10 Hz: 0.7 s).
        gate: A detection farther than this from a track is none of it; as far as delta [m].
        confidence_gain: Weight of a new detection's confidence (eq. 6) at the reference rate.
        distance: Largest distance between the two legs that start a person [m].
        delta: Both legs must have moved this far before they start a person [m].
        epsilon: A track ends when the first element of its covariance exceeds this [m^2].
        c_min: And when its confidence, by eq. 6, falls below this, in [0, 1].
        resolution: Side of a cell of the grid of what is not human [m].
        still_s: Time under points that are not human until a cell counts as occupied [s].
        forget_s: A cell that was not hit for so long is free again [s].
        clearance: Points this close to a person do not mark the grid (zeta) [m].
    """

    motion: MotionConfig = field(default_factory=MotionConfig)
    gate: float = 0.5
    confidence_gain: Share = 0.05
    distance: float = 0.9
    delta: float = 0.5
    epsilon: float = 0.9
    c_min: Share = 0.1
    resolution: Annotated[float, Within(0.01, 100.0)] = 0.05
    still_s: float = 0.15
    forget_s: float = 2.0
    clearance: float = 0.35

    def __post_init__(self) -> None:
        check_numbers(self)
        numbers = set(vars(self)) - {"motion"}
        check_positive(self, *sorted(numbers))
        for name in ("confidence_gain", "c_min"):
            if getattr(self, name) >= 1.0:
                raise InputError(f"`{name}` must be below 1, got {getattr(self, name)}")

    def confidence_weight(self, dt: float) -> float:
        """Return the gain of eq. 6 for `dt` seconds, so that its memory lasts equally long at any scan rate."""
        return 1.0 - (1.0 - self.confidence_gain) ** (dt * self.motion.reference_rate_hz)
