"""Constraints between submaps and nodes, and how a node is matched against a finished submap."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import accumulate
from operator import attrgetter
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ...bounds import Angle, Share, Within, check_numbers
from ...errors import InputError
from ...geometry import between, compose
from ...local.submap import Submap
from ...recent import Recent
from ...scan_to_grid.match_kernels import information_in_node, match_nodes
from ...scan_to_grid.refine_kernels import refine_pose
from ...scan_to_grid.scan_matcher import DOUBT, heading_step
from ...search.branch_and_bound import SearchWindow, Separation, branch_and_bound
from ...search.score_pyramid import ScoreGrid, ScorePyramid, build_pyramid
from .blur_kernels import blurred_scores
from .slack import SIGMAS, Slack

Array = NDArray[np.float64]
Field = NDArray[np.float32]

_CERTAIN = 1e9  # [1/m^2, 1/rad^2] of a node that defines its submap
_FARTHEST = 40.0  # [m] to each side that are searched at most
_PLACE = 0.25, 0.35  # [m^2, rad] a place that a search tells from others
APART = 1.0, 0.35  # [m, rad] submaps do not quite agree: places nearer to each other are the same
_TOP = 6  # level of the search trees: blocks of 64 cells
_FIELDS = 16 << 20, 8  # bytes, or so many, of unpacked submaps ...
_PYRAMIDS = 64 << 20, 4  # ... and of their search trees that are kept, for the submaps around the robot


class Kind(Enum):
    """INTRA: the node stands in the submap; INTER: it was matched against it later (Konolige et al. 2010)."""

    INTRA = "intra"
    INTER = "inter"


@dataclass(frozen=True, eq=False, slots=True)
class Constraint:
    """Where a node stands, seen from a submap.

    Attributes:
        submap: Index of the submap.
        node: Index of the node.
        pose: (3,) T_submap_node [m, m, rad].
        information: (3, 3) inverse covariance of its error in the frame of the node.
        kind: INTRA or INTER.
        score: Mean occupancy under the node's points; of INTRA 1.
        searched: Whether a global search found it (a loop closure), not a match from a good guess.
    """

    submap: int
    node: int
    pose: Array
    information: Array
    kind: Kind
    score: float = 1.0
    searched: bool = False


@dataclass(frozen=True, kw_only=True)
class ConstraintConfig:
    """Settings of `ConstraintBuilder`.

    Attributes:
        weight: Weight of a point's `1 - occupancy`, as in local matching.
        independent: Share of the points that tell: beside each other they err alike.
        intra_sigma: Least standard deviation of INTRA constraints [m, rad].
        inter_sigma: Least standard deviation of INTER constraints [m, rad].
        min_score: Least score of a match from a good guess, as a share of the typical score of local matches.
        search_min_score: Likewise of a match by global search.
        drift_floor: Half side of the searched square, after no way by local SLAM [m] ...
        drift_per_metre: ... and what it grows by with each metre of the way ...
        search_linear: ... up to here [m].
        search_angular: Half range of the searched headings [rad].
        search_points: The search uses about so many points.
        max_shift: A match from a good guess must not move farther than this [m, rad].
    """

    weight: float = 1.5
    independent: Share = 0.25
    intra_sigma: tuple[float, float] = (0.003, 0.001)
    inter_sigma: tuple[float, float] = (0.01, 0.003)
    min_score: Share = 0.6
    search_min_score: Share = 0.7
    drift_floor: Annotated[float, Within(0.0, 100.0)] = 1.5
    drift_per_metre: Annotated[float, Within(0.0, 1.0)] = 0.03
    search_linear: Annotated[float, Within(0.0, 100.0)] = 4.0
    search_angular: Angle = 0.8
    search_points: Annotated[int, Within(1, 10_000)] = 300
    max_shift: Annotated[tuple[float, float], Within(0.0, 10.0)] = (0.25, 0.1)

    def __post_init__(self) -> None:
        check_numbers(self)
        for name, value in vars(self).items():
            if not np.all(np.asarray(value) > 0):
                raise InputError(f"`{name}` must be positive, got {value}")


@dataclass(frozen=True, eq=False, slots=True)
class Place:
    """Where a stretch of the drive may have been driven before.

    Attributes:
        pose: (3,) T_submap_node of its last node [m, m, rad].
        lead: Logarithm of how many times likelier that is than that it was driven nowhere before.
    """

    pose: Array
    lead: float


_nbytes = attrgetter("nbytes")  # of what is kept; no lambda, for copies of an engine are pickled


class ConstraintBuilder:
    """Matches nodes against finished submaps.

    Args:
        config: Settings.

    Attributes:
        typical_score: Mean score of local matches so far, which depends on the laser and the building.
    """

    def __init__(self, config: ConstraintConfig) -> None:
        self._config = config
        self._fields = Recent[Submap, Field](attrgetter("field"), _nbytes, *_FIELDS)
        self._pyramids = Recent[Submap, ScorePyramid](self._pyramid, _nbytes, *_PYRAMIDS)
        self.typical_score = 0.0

    @property
    def longest_way(self) -> float:
        """A longer way than this by local SLAM makes no search wider [m]."""
        return (self._config.search_linear - self._config.drift_floor) / self._config.drift_per_metre

    def intra(self, index: int, submap: Submap, node: int, pose_local: Array, known: Array | None) -> Constraint:
        """Return the constraint of a node at `pose_local` (3,) that was inserted into a submap.

        Args:
            index: Index of the submap.
            submap: The submap.
            node: Index of the node.
            pose_local: T_local_robot.
            known: (3, 3) inverse covariance of that, by its match or by its odometry; None: it defines the submap.
        """
        pose = between(submap.pose_local, pose_local)
        certain = known if known is not None else _CERTAIN * np.eye(3)
        information = information_in_node(certain, pose[2], self._config.intra_sigma)
        return Constraint(index, node, pose, information, Kind.INTRA)

    def track(
        self,
        index: int,
        submap: Submap,
        place: Array,
        nodes: Sequence[int],
        points: Sequence[Array],
        poses: Array,
        wide: bool,
    ) -> list[Constraint]:
        """Return the constraints of those `nodes` that match the submap near where the graph has them.

        Args:
            index: Index of the submap.
            submap: The submap.
            place: (3,) T_global_submap.
            nodes: Indices of n nodes.
            points: The (N, 2) points of each node, robot frame [m].
            poses: (n, 3) T_global_node.
            wide: Whether to search the surroundings first; otherwise the poses must be right to a cell.
        """
        config = self._config
        sizes = [len(p) for p in points]
        good, relative, information, scores = match_nodes(
            self._fields[submap],
            submap.corner,
            submap.config.resolution,
            np.concatenate(points),
            np.array([0, *accumulate(sizes)]),
            submap.pose_local,
            place,
            poses,
            config.weight,
            wide,
            config.max_shift,
            self.typical_score,
            config.min_score,
            config.inter_sigma,
        )
        return [
            Constraint(index, nodes[k], relative[k], information[k], Kind.INTER, float(scores[k]))
            for k in np.flatnonzero(good).tolist()
        ]

    def places(self, submap: Submap, points: Array, guess: Array, slack: Slack, way: float) -> list[Place]:
        """Return where on a submap `points` (N, 2) fit best near `guess` (3,), two places at most.

        The second is as likely as the first, but for a factor of twenty. They are sought as far off as drift on a `way`
        [m] by local SLAM, and three standard deviations of the `slack`, may lead.
        """
        config = self._config
        thinned = points[:: max(1, len(points) // config.search_points)]
        step = 1.5 * heading_step(submap.config.resolution, points)
        drift = min(config.drift_floor + config.drift_per_metre * way, config.search_linear)
        linear = min(drift + SIGMAS * slack.linear, _FARTHEST)
        angular = min(config.search_angular + SIGMAS * slack.angular, math.pi)
        window = SearchWindow(linear=linear, angular=angular, angular_step=step)
        # log-odds of points that fit and ones that fit nowhere; as of nothing known, half fit
        told = config.independent * config.weight * len(thinned)
        places = math.log(max(4.0 * linear**2 / _PLACE[0] * 2.0 * angular / _PLACE[1], 1.0))
        nowhere = 0.5 * self.typical_score + places / told
        found = branch_and_bound(
            self._pyramids[submap],
            thinned,
            compose(submap.pose_local, guess),
            window,
            min_score=nowhere + DOUBT / told,
            maxima=2,
            separation=Separation(linear=APART[0], angular=APART[1], least_share=1.0 - DOUBT / max(told, DOUBT)),
        )
        return [
            Place(between(submap.pose_local, np.array(place.pose)), told * (place.score - nowhere))
            for place in found.maxima
        ]

    def closure(self, index: int, submap: Submap, node: int, points: Array, guess: Array) -> Constraint | None:
        """Return the loop closure of a node whose stretch of `points` (N, 2) fits a submap near `guess` (3,).

        None: it fits too badly.
        """
        start = compose(submap.pose_local, guess)
        return self._closure(index, submap, node, points, start, self._config.search_min_score)

    def rematch(self, constraint: Constraint, submap: Submap, points: Array) -> Constraint | None:
        """Return a loop closure matched anew on the `submap` as it is drawn now; None: it does not fit any more.

        Args:
            constraint: The loop closure.
            submap: Its submap.
            points: (N, 2) points of its node, robot frame [m].
        """
        start = compose(submap.pose_local, constraint.pose)
        return self._closure(constraint.submap, submap, constraint.node, points, start, self._config.min_score)

    def _closure(
        self, index: int, submap: Submap, node: int, points: Array, start: Array, least: float
    ) -> Constraint | None:
        """Return the closure of a node near `start` (3,) in the local frame, if it scores `least` of the typical."""
        config = self._config
        place = self._fields[submap], submap.corner, submap.config.resolution
        pose, curvature, rest, _ = refine_pose(*place, points, start, start, np.eye(3), config.weight, 20)
        score = 1.0 - rest / len(points)
        if score < least * self.typical_score:
            return None
        pose = between(submap.pose_local, pose)
        information = information_in_node(config.weight * curvature, pose[2], config.inter_sigma)
        return Constraint(index, node, pose, information, Kind.INTER, score, True)

    def _pyramid(self, submap: Submap) -> ScorePyramid:
        h, corner = submap.config.resolution, submap.corner - 0.5 * submap.config.resolution
        grid = ScoreGrid(blurred_scores(self._fields[submap]), (float(corner[0]), float(corner[1])), h)
        return build_pyramid(grid, top_level=_TOP, margin=int(self._config.search_linear / h) + 1)
