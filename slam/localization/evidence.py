"""How well scans fit a map at given poses: what hypotheses are weighed by and what tracking is judged by."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ..bounds import Reach, Rounds, Within, check_numbers
from ..errors import InputError
from ..geometry import compose, transform_points
from ..scan_to_grid.refine_kernels import refine_pose
from .evidence_kernels import UNSEEN, beam_likelihoods, count_blocked
from .place_map import PlaceMap
from .prepared_scan import PreparedScan

Array = NDArray[np.float64]

_CELLS = 1.6  # no wall is thought to be known better than to so many cells
_HOLD = np.diag([0.05**-2, 0.05**-2, 0.02**-2])  # [1/m^2, 1/rad^2] how the odometry holds a pose between two scans


@dataclass(frozen=True, kw_only=True)
class EvidenceConfig:
    """Settings of `Evidence`.

    Attributes:
        sigma: How far from a wall the end of a beam may lie [m]; at least 1.6 cells of the map.
        slack: A wall that a beam came through contradicts it only if it stands more than this before its end [m].
        hold: Information with which a pose is held where it is refined from [1/m^2, 1/rad^2].
        weight: Weight of a point's `1 - occupancy` beside that.
        iterations: Most steps of a refinement.
    """

    sigma: Annotated[float, Within(1e-3, 100.0)] = 0.08
    slack: Reach = 0.4
    hold: float = 1.0
    weight: float = 1.5
    iterations: Rounds = 12

    def __post_init__(self) -> None:
        check_numbers(self)
        for name, value in vars(self).items():
            if not value > 0:
                raise InputError(f"`{name}` must be positive, got {value}")


class Evidence:
    """Judges poses on one map.

    Args:
        place: The map.
        config: Settings.
    """

    def __init__(self, place: PlaceMap, config: EvidenceConfig) -> None:
        self._place, self._config = place, config
        self._sigma = max(config.sigma, _CELLS * place.resolution)

    def judge(self, scan: PreparedScan, poses: Array) -> tuple[Array, Array]:
        """Return (k,) mean log-likelihoods of the beams of a scan at `poses` (k, 3), and (k,) shares explained.

        A beam that ends where the map knows nothing counts as half explained.
        """
        likelihoods = np.empty((len(poses), len(scan.points)), np.float32)
        place = self._place
        beam_likelihoods(
            place.states, place.distances, place.outer_corner, place.resolution, scan.sensor, scan.points,
            np.ascontiguousarray(poses), self._sigma, self._config.slack, likelihoods,
        )  # fmt: skip
        if not len(scan.points):
            return np.zeros(len(poses)), np.zeros(len(poses))
        unseen = np.float32(UNSEEN)
        explained = 0.5 * ((likelihoods > unseen).mean(axis=1) + (likelihoods >= unseen).mean(axis=1))
        return np.log(likelihoods).mean(axis=1, dtype=np.float64), explained

    def blocked(self, scan: PreparedScan, pose: Array) -> float:
        """Return the share of the beams of a scan that come through walls, the robot at `pose` (3,)."""
        place, slack = self._place, self._config.slack
        rays = np.concatenate((scan.sensor[None], scan.points))
        cells = (transform_points(pose, rays) - place.outer_corner) / place.resolution
        return count_blocked(place.states, cells[0], cells[1:], slack / place.resolution) / max(len(scan.points), 1)

    def refine(self, points: Array, poses: Array, coarse: bool = False) -> Array:
        """Return `poses` (k, 3), each moved to where `points` (N, 2) of the robot frame fit the walls best nearby.

        Args:
            points: Robot frame [m].
            poses: T_map_robot.
            coarse: Whether the poses may be off by more than a wall's width; costs twice as much.
        """
        return np.array([self._refined(points, pose, coarse)[0] for pose in poses]).reshape(-1, 3)

    def follow(self, points: Array, poses: Array, motion: Array) -> Array:
        """Return `poses` (k, 3), moved on by a `motion` (3,) of the odometry to where `points` (N, 2) were seen.

        They are refined there, but held by the odometry: two places a step apart must not slide into each other.
        """
        moved = compose(poses, motion)
        return np.array([self._refined(points, pose, False, _HOLD)[0] for pose in moved]).reshape(-1, 3)

    def degenerate_direction(self, points: Array, pose: Array) -> Array:
        """Return (2,) the unit vector, map frame, along which `points` (N, 2) constrain a pose (3,) least."""
        _, curvature = self._refined(points, pose, False)
        # What is left of the translation's information when the heading is free, too.
        across = curvature[:2, 2:] @ curvature[2:, :2] / (curvature[2, 2] + 1e-9)
        return np.linalg.eigh(curvature[:2, :2] - across)[1][:, 0]

    def _refined(self, points: Array, pose: Array, coarse: bool, hold: Array | None = None) -> tuple[Array, Array]:
        place, config, curvature = self._place, self._config, np.eye(3)
        hold = config.hold * np.eye(3) if hold is None else hold
        for walls in (place.coarse_field, place.field) if coarse else (place.field,):
            pose, curvature, _, _ = refine_pose(
                walls, place.corner, place.resolution, points, pose, pose, hold, config.weight,
                config.iterations,
            )  # fmt: skip
        return pose, curvature
