"""How well a scan fits a map at hypotheses, and where they go from one scan to the next."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ..bounds import Reach, Rounds, Share, Within, check_numbers, check_positive
from ..geometry import compose, wrap_angle
from ..scan_to_grid.voxel_filter import AdaptiveVoxelConfig, AdaptiveVoxelFilter
from .beam_fit_kernels import BeamModel, beam_misfits, refine_poses
from .place_map import PlaceMap

Array = NDArray[np.float64]

_CELLS = 1.0  # no wall is known better than to its cell
_FAR_STEP = 0.3  # [m] from such a step of the odometry on a pose may be off by more than a wall's width
_FREE_HOLD = np.eye(3)  # [1/m^2, 1/rad^2] how weakly what a search found is held


@dataclass(frozen=True, kw_only=True)
class BeamFitConfig:
    """Settings of `BeamFit`.

    Attributes:
        sigma: How far from a wall the end of a beam may lie [m]; at least a cell of the map.
        slack: A wall that a beam came through counts only if it stands more than this before its end [m].
        stray: Likelihood of a beam that ends away from all walls, relative to one that ends at one: people, furniture.
        through: What is left of the likelihood of a beam that came through a wall: doors are opened, glass mirrors.
        unseen: Likelihood of a beam that ends where the map knows nothing.
        points: Poses are judged by about so many points or more, as even in space as these are: near walls, of which
            most beams come, look alike everywhere.
        spacing: Largest distance between those points [m].
        worth: Poses are refined by points that weigh as much as so many independent ones.
        iterations: Most steps of a refinement.
    """

    sigma: Annotated[float, Within(1e-3, 100.0)] = 0.08
    slack: Reach = 0.4
    stray: Share = 0.1
    through: Share = 0.5
    unseen: Share = 0.5
    points: Annotated[int, Within(1, 10_000)] = 60
    spacing: Annotated[float, Within(0.02, 100.0)] = 0.5
    worth: float = 27.0
    iterations: Rounds = 12

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self)


@dataclass(frozen=True, eq=False)
class Sight:
    """What hypotheses are weighed by.

    Attributes:
        odometry: (3,) T_odom_robot.
        points: (N, 2) returns, robot frame [m].
        even: (M, 2) some of them, even in space.
        sensor: (2,) place of the laser, robot frame [m].
    """

    odometry: Array
    points: Array
    even: Array
    sensor: Array


class BeamFit:
    """Judges and refines poses on one map.

    Args:
        place: The map.
        config: Settings.

    Attributes:
        unseen: Misfit of a scan all of whose beams end where the map knows nothing.
    """

    def __init__(self, place: PlaceMap, config: BeamFitConfig) -> None:
        self._place, self._config = place, config
        sigma = max(config.sigma, _CELLS * place.resolution)
        self._model = BeamModel(sigma, config.slack, config.stray, config.through, config.unseen)
        edges = AdaptiveVoxelConfig(min_points=config.points, max_edge=config.spacing)
        self._even = AdaptiveVoxelFilter(edges)
        self.unseen = -float(np.log(config.unseen))

    def sight(self, odometry: Array, points: Array, sensor: Array) -> Sight:
        """Return a scan of `points` (N, 2), seen from `sensor` (2,) at the odometry pose (3,), made ready."""
        return Sight(odometry, points, np.ascontiguousarray(self._even.apply(points)), sensor)

    def judge(self, sight: Sight, poses: Array) -> tuple[Array, Array]:
        """Return (k,) misfits, mean negative log-likelihoods of the beams at `poses` (k, 3), and shares explained."""
        place = self._place
        misfits, explained = np.empty(len(poses)), np.empty(len(poses))
        beam_misfits(
            place.states, place.distances, place.outer_corner, place.resolution, sight.sensor, sight.even,
            np.ascontiguousarray(poses), self._model, misfits, explained,
        )  # fmt: skip
        return misfits, explained

    def refine(self, sight: Sight, poses: Array) -> Array:
        """Return `poses` (k, 3), each moved to where the scan fits best nearby."""
        coarse = self._refined(sight, poses, _FREE_HOLD, self._place.coarse_field)
        return self._refined(sight, coarse, _FREE_HOLD, self._place.field)

    def follow(self, sight: Sight, poses: Array, motion: Array, sigma: Array) -> tuple[Array, Array]:
        """Return `poses` (k, 3) moved on to where the scan fits, and half the squared residuals of the odometry (k,).

        Args:
            sight: The scan.
            poses: T_map_robot before the motion.
            motion: (3,) of the odometry.
            sigma: (2,) standard deviations of its translation [m] and rotation [rad], which hold the poses.
        """
        expected = compose(poses, motion).reshape(-1, 3)
        hold, start = np.diag([sigma[0] ** -2, sigma[0] ** -2, sigma[1] ** -2]), expected
        if np.hypot(motion[0], motion[1]) > _FAR_STEP:
            start = self._refined(sight, expected, hold, self._place.coarse_field)
        refined = self._refined(sight, start, hold, self._place.field, expected)
        off = refined - expected
        off[:, 2] = wrap_angle(off[:, 2])
        return refined, 0.5 * np.einsum("ka,ab,kb->k", off, hold, off)

    def _refined(
        self, sight: Sight, poses: Array, hold: Array, field: NDArray[np.float32], expected: Array | None = None
    ) -> Array:
        place, refined = self._place, np.ascontiguousarray(poses, dtype=np.float64).copy()
        weight = self._config.worth / max(len(sight.points), 1)
        held = refined.copy() if expected is None else np.ascontiguousarray(expected)
        refine_poses(
            field, place.corner, place.resolution, sight.points, refined, held, hold, weight, self._config.iterations
        )
        return refined
