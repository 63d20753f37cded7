"""The people that the tracker believes in, after one scan."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.geometry import inverse, transform_points

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SeenLegs:
    """Legs seen in one scan, also those of nobody who is known.

    Attributes:
        positions: (k, 2) [m].
        confidence: (k,) how likely they are somebody's, in [0, 1].
        owner: (k,) row of the person whose leg it is; -1 for nobody's.
    """

    positions: Array
    confidence: Array
    owner: NDArray[np.intp]

    def __len__(self) -> int:
        return len(self.owner)


def no_legs() -> SeenLegs:
    """Return no legs at all."""
    return SeenLegs(np.zeros((0, 2)), np.zeros(0), np.zeros(0, dtype=np.intp))


@dataclass(frozen=True, eq=False)
class People:
    """Tracked people, in the odometry frame unless said otherwise.

    Attributes:
        time_s: Time of the scan [s].
        ids: (n,) numbers of the people; one who was lost and is met again soon keeps the number.
        positions: (n, 2) centres between the legs [m].
        velocities: (n, 2) of the centres [m/s].
        confidence: (n,) how likely each is a person, in [0, 1]; by the tracker of Ye 2021, that of eq. 6.
        legs: (n, 2, 2) positions of both legs, measured or believed [m].
        variance: (n,) first element of each covariance [m^2].
        unseen_s: (n,) time since a leg of the person was last seen; 0: in this scan [s].
        age_s: (n,) for how long each place has been known without a break, also before it was known as a person's [s].
        seen_legs: The legs that were seen in this scan, of those who likelier are people than not.
    """

    time_s: float
    ids: NDArray[np.int64]
    positions: Array
    velocities: Array
    confidence: Array
    legs: Array
    variance: Array
    unseen_s: Array
    age_s: Array
    seen_legs: SeenLegs = field(default_factory=no_legs)

    def __len__(self) -> int:
        return len(self.ids)

    @property
    def points(self) -> Array:
        """(3 n, 2) all centres and legs: what the people filter keeps clear."""
        return np.concatenate((self.positions, self.legs.reshape(-1, 2)))

    def in_frame_of(self, T_odom_robot: ArrayLike) -> "People":
        """Return the same people with positions and velocities in the frame of the robot at `T_odom_robot` (3,)."""
        T_robot_odom = inverse(T_odom_robot)
        turn = np.array([0.0, 0.0, T_robot_odom[2]])
        seen = self.seen_legs
        return People(
            time_s=self.time_s,
            ids=self.ids,
            positions=transform_points(T_robot_odom, self.positions),
            velocities=transform_points(turn, self.velocities),
            confidence=self.confidence,
            legs=transform_points(T_robot_odom, self.legs.reshape(-1, 2)).reshape(-1, 2, 2),
            variance=self.variance,
            unseen_s=self.unseen_s,
            age_s=self.age_s,
            seen_legs=SeenLegs(transform_points(T_robot_odom, seen.positions), seen.confidence, seen.owner),
        )


def nobody_tracked(time_s: float) -> People:
    """Return no people at all, at `time_s`."""
    none = np.zeros(0)
    return People(
        time_s=time_s,
        ids=np.zeros(0, dtype=np.int64),
        positions=np.zeros((0, 2)),
        velocities=np.zeros((0, 2)),
        confidence=none,
        legs=np.zeros((0, 2, 2)),
        variance=none,
        unseen_s=none,
        age_s=none,
    )
