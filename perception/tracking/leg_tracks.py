"""All leg tracks as one array: predicted, matched and corrected together."""

import numpy as np
from numpy.typing import NDArray

from ..config import PerceptionConfig
from . import kalman
from .association import distances

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

    def __init__(self, config: PerceptionConfig) -> None:
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
        size = self.rows["high"] - self.rows["low"]
        return np.sqrt(size[:, 0] ** 2 + size[:, 1] ** 2)

    def spread(self) -> Array:
        """Return (n, n) lengths of `apart` [m]."""
        return np.sqrt(self.apart[..., 0] ** 2 + self.apart[..., 1] ** 2)

    def predict(self, dt: float) -> None:
        """Move all tracks `dt` seconds ahead."""
        rows = self.rows
        rows["x"], rows["p"] = kalman.predict(rows["x"], rows["p"], dt, self._config.process_variance(dt))
        rows["age_s"] += dt
        rows["unseen_s"] += dt

    def cost(self, z: Array) -> tuple[Array, Array]:
        """Return (n, m) distances to detections `z` (m, 2), `inf` beyond a track's gate, and the gates (n,) [m]."""
        config, unseen_s = self._config, self.rows["unseen_s"]
        cost = distances(self.positions, z)
        fresh = unseen_s <= config.gate_anchor_s
        cost[fresh] = np.minimum(cost[fresh], distances(self.rows["seen"][fresh], z))
        gates = np.minimum(config.gate + config.gate_speed * unseen_s, config.gate_most)
        cost[cost >= gates[:, None]] = np.inf
        return cost, gates

    def correct(self, match: NDArray[np.intp], z: Array, d: Array, dt: float) -> None:
        """Correct the tracks with detections `z` (m, 2) of confidence `d` (m,); `match` (n,) is a detection or -1.

        Tracks without a detection stay predicted; their scan counts as confidence 0 (eq. 6).
        """
        rows, seen = self.rows, np.flatnonzero(match >= 0)
        found = match[seen]
        x, p = kalman.update(rows["x"][seen], rows["p"][seen], z[found], self._config.r)
        rows["x"][seen], rows["p"][seen] = x, p
        gain = self._config.confidence_weight(dt)
        rows["confidence"] *= 1.0 - gain
        rows["confidence"][seen] += gain * d[found]
        rows["unseen_s"][seen] = 0.0
        rows["seen"][seen] = z[found]
        rows["low"][seen] = np.minimum(rows["low"][seen], z[found])
        rows["high"][seen] = np.maximum(rows["high"][seen], z[found])

    def measure_apart(self, dt: float) -> None:
        """Take the present distances into their running means."""
        together_s = np.minimum(self.rows["age_s"][:, None], self.rows["age_s"])
        weight = np.maximum(dt / self._config.stride_time_s, dt / np.maximum(together_s, dt))
        now = self.positions[:, None] - self.positions
        self.apart += np.minimum(weight, 1.0)[..., None] * (now - self.apart)

    def begin(self, positions: Array, confidence: Array) -> None:
        """Add tracks at `positions` (k, 2) with zero velocity (eq. 5) and the detections' `confidence` (k,)."""
        fresh = np.zeros(len(positions), dtype=LEG)
        fresh["x"][:, :2] = positions
        fresh["seen"] = fresh["first"] = fresh["low"] = fresh["high"] = positions
        fresh["p"] = (self._config.initial_variance, 0.0, self._config.initial_variance)
        fresh["confidence"] = confidence
        count = len(self.rows)
        self.rows = np.concatenate((self.rows, fresh))
        apart = self.positions[:, None] - self.positions
        apart[:count, :count] = self.apart
        self.apart = apart

    def restart_moving(self, index: NDArray[np.intp]) -> None:
        """Let the tracks `index` (k,) begin here, as if they had not moved yet."""
        for name in ("first", "low", "high"):
            self.rows[name][index] = self.positions[index]

    def take(self, order: NDArray[np.intp]) -> None:
        """Keep the tracks `order` (k,), in that order."""
        self.rows = self.rows[order]
        self.apart = self.apart[np.ix_(order, order)]
