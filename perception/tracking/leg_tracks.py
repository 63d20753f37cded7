"""All leg tracks as one array: predicted, matched and corrected together."""

import numpy as np
from numpy.typing import NDArray

from . import leg_kernels
from . import track_kernels as kernels
from .config import TrackerConfig
from .people import SeenLegs

Array = NDArray[np.float64]

LEG = np.dtype(
    [
        ("x", np.float64, 4),  # state (x, y, vx, vy) in the odometry frame
        ("p", np.float64, 3),  # covariance, see kalman.py
        ("confidence", np.float64),
        ("seen", np.float64, 2),  # where it was last seen
        ("first", np.float64, 2),  # where the track began
        ("low", np.float64, 2),  # smallest x and y it has been at [m]
        ("high", np.float64, 2),  # largest
        ("age_s", np.float64),
        ("unseen_s", np.float64),
        ("owned_s", np.float64),  # time as this person's leg; 0: nobody's
    ]
)


class LegTracks:
    """Leg tracks in rows, and how far each stays from each other over the last steps.

    Attributes:
        rows: (n,) of `LEG`.
        apart: (n, n, 2) running mean of the vector between two tracks [m]. The legs of one person swing past each
            other, so their mean is a step's width; legs of two people side by side keep their distance.
    """

    def __init__(self, config: TrackerConfig) -> None:
        self._config = config
        self.rows = np.zeros(0, dtype=LEG)
        self.apart = np.zeros((0, 0, 2))

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def positions(self) -> Array:
        """(n, 2) in the odometry frame [m]."""
        return self.rows["x"][:, :2]

    @property
    def moved(self) -> Array:
        """(n,) size of the area a track has been in: diagonal of the box around it [m]."""
        return leg_kernels.moved(self.rows)

    def spread(self) -> Array:
        """Return (n, n) lengths of `apart` [m]."""
        return np.sqrt(self.apart[..., 0] ** 2 + self.apart[..., 1] ** 2)

    def predict(self, dt: float) -> None:
        """Move all tracks `dt` seconds ahead."""
        rows = self.rows
        kernels.predict(
            rows["x"], rows["p"], rows["age_s"], rows["unseen_s"], dt, self._config.motion.process_variance(dt)
        )

    def cost(self, z: Array, centres: Array) -> tuple[Array, Array]:
        """Return (n, m) distances to detections `z` (m, 2), `inf` where they cannot be, and the gates (n,) [m].

        The first 2 k tracks are legs of people at `centres` (k, 2), who reach no farther than the configuration says.
        """
        config = self._config
        gates = np.minimum(
            config.gating.gate + config.gating.gate_speed * self.rows["unseen_s"], config.gating.gate_max
        )
        cost = np.empty((len(self.rows), len(z)))
        kernels.leg_costs(self.rows, centres, z, config.gating.reach, config.gating.anchor_s, gates, cost)
        return cost, gates

    def correct(self, match: NDArray[np.intp], z: Array, d: Array, dt: float) -> None:
        """Correct the tracks with detections `z` (m, 2) of confidence `d` (m,); `match` (n,) is a detection or -1.

        Tracks without a detection stay predicted; their scan counts as confidence 0 (eq. 6).
        """
        kernels.correct_legs(self.rows, match, z, d, self._config.motion.r, self._config.motion.confidence_weight(dt))

    def seen_now(self, people: int) -> SeenLegs:
        """Return the legs seen in the last scan; the first 2 `people` tracks are those of people."""
        rows, owner = leg_kernels.seen_now(self.rows, people)
        return SeenLegs(self.rows["seen"][rows], self.rows["confidence"][rows], owner)

    def measure_apart(self, dt: float) -> None:
        """Take the present distances into their running means."""
        kernels.average_apart(self.rows["x"], self.rows["age_s"], self.apart, dt, self._config.pairing.stride_s)

    def begin(self, positions: Array, confidence: Array) -> None:
        """Add tracks at `positions` (k, 2) with zero velocity (eq. 5) and the detections' `confidence` (k,)."""
        if len(positions) == 0:
            return
        fresh = np.zeros(len(positions), dtype=LEG)
        fresh["x"][:, :2] = positions
        fresh["seen"] = fresh["first"] = fresh["low"] = fresh["high"] = positions
        fresh["p"] = (self._config.motion.initial_variance, 0.0, self._config.motion.initial_variance)
        fresh["confidence"] = confidence
        self.rows = np.concatenate((self.rows, fresh))
        self.apart = kernels.with_fresh(self.apart, self.rows["x"])

    def restart_moving(self, index: NDArray[np.intp]) -> None:
        """Let the tracks `index` (k,) begin here, as if they had not moved yet."""
        for name in ("first", "low", "high"):
            self.rows[name][index] = self.positions[index]

    def take(self, order: NDArray[np.intp]) -> None:
        """Keep the tracks `order` (k,), in that order."""
        if len(order) == len(self.rows) and (order == np.arange(len(order))).all():
            return
        self.rows = self.rows[order]
        self.apart = kernels.taken(self.apart, order)
