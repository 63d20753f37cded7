"""What is known of the leader at one scan."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LeaderEstimate:
    """The leader as known at one scan.

    Attributes:
        id: The leader's number, the same for the whole drive, whatever track carries it.
        track_id: The tracked person who is the leader now; -1 while it is lost.
        position: (2,) in the odometry frame, predicted while it is lost [m].
        velocity: (2,) [m/s].
        visible: Whether a leg of it was seen in this scan.
        confidence: Of its track; 0 while it is lost.
        unseen_s: Time since a leg of it was last seen [s].
    """

    id: int
    track_id: int
    position: Array
    velocity: Array
    visible: bool
    confidence: float
    unseen_s: float
