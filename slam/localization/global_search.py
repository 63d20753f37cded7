"""Where on the map the robot may be, by all that it has seen lately: hypotheses that live until one stands out."""

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ..bounds import Cell, Share, Step, Within, check_numbers
from ..errors import InputError
from ..geometry import between, transform_points, wrap_angle
from ..scan_to_grid.voxel_filter import voxel_first
from ..search.branch_and_bound import SearchWindow, Separation, branch_and_bound
from .evidence import Evidence
from .place_belief import PlaceBelief
from .place_map import PlaceMap
from .prepared_scan import PreparedScan

Array = NDArray[np.float64]

_FINE = 0.05  # [m] side of cells from which a scan counts in full


@dataclass(frozen=True, kw_only=True)
class GlobalSearchConfig:
    """Settings of `GlobalSearch`.

    Attributes:
        angular_step: Step between the headings that are tried [rad].
        maxima: A search keeps at most so many distinct maxima.
        separation: When two maxima are distinct, and how much worse than the best a maximum may score.
        least_score: Mean worth of a point, in [0, 1], below which nothing is found.
        points: A search uses about so many points ...
        voxel: ... of the last scans together, one in each voxel of this side [m].
        scans: So many scans are remembered.
        search_every: A search for each so many metres, or half as many radians, of motion.
        fresh: Scans are independent when the robot moves so far between them, or turns by as many radians [m, rad].
        independent_beams: A scan counts as so many independent beams, however many it has; fewer where the cells of
            the map are larger than 5 cm, as they tell places apart less well.
        independent_scans: All remembered scans count as no more independent ones than this: what is wrong about the
            map is so in all of them.
        sure_ratio: The best hypothesis must be so many times as likely as the best distinct rival.
        well_explained: That suffices where so large a share of the beams ends at walls of the map; for each tenth
            less it must be `sure_ratio` times more likely still.
        least_explained: A hypothesis that explains a smaller share is never sure.
        same: Hypotheses nearer than this are one [m, rad].
        hopeless: Hypotheses less likely than the best by this factor are forgotten.
    """

    angular_step: Step = float(np.radians(2.5))
    maxima: Annotated[int, Within(1, 1000)] = 20
    separation: Separation = field(default_factory=lambda: Separation(linear=0.5, angular=0.35, least_share=0.75))
    least_score: Share = 0.5
    points: Annotated[int, Within(1, 10_000)] = 120
    voxel: Cell = 0.15
    scans: Annotated[int, Within(1, 1000)] = 20
    search_every: float = 0.25
    fresh: float = 0.5
    independent_beams: float = 12.0
    independent_scans: float = 3.0
    sure_ratio: float = 10.0
    well_explained: Share = 0.85
    least_explained: Share = 0.5
    same: tuple[float, float] = (0.25, 0.1)
    hopeless: Annotated[float, Within(1.0, 1e300)] = 1e8

    def __post_init__(self) -> None:
        check_numbers(self)
        for name in ("maxima", "points", "voxel", "scans", "search_every", "fresh", "independent_beams"):
            if not getattr(self, name) > 0:
                raise InputError(f"`{name}` must be positive, got {getattr(self, name)}")
        if not self.hopeless > self.sure_ratio > 1.0:
            raise InputError(f"need `hopeless` > `sure_ratio` > 1, got {self.hopeless} and {self.sure_ratio}")


_NOTHING = PlaceBelief(np.empty((0, 3)), np.empty(0), np.empty(0), False)


class GlobalSearch:
    """Searches the whole map and weighs what it finds over the last scans.

    Each scan adds to the logarithm of a hypothesis' likelihood the mean of its beams, times `independent_beams` and how
    fresh the scan is. A hypothesis that is found late is followed back through the remembered scans, so that all are
    judged by the same ones.

    Args:
        place: The map.
        evidence: Judge of poses on it.
        config: Settings.
    """

    def __init__(self, place: PlaceMap, evidence: Evidence, config: GlobalSearchConfig) -> None:
        self._place, self._evidence, self._config = place, evidence, config
        self.forget()

    def forget(self) -> None:
        """Drop all scans and hypotheses."""
        self._scans: list[PreparedScan] = []
        self._freshness: list[float] = []
        self._poses = np.empty((0, 3))
        self._priors = np.empty(0)  # log-likelihoods before any scan
        self._tables = np.empty((0, 0, 2))  # hypotheses x scans x (mean log-likelihood, share explained)
        self._since_search = np.inf

    def remember(self, scan: PreparedScan) -> None:
        """Take a scan without a search; hypotheses follow the odometry and are judged."""
        freshness = 1.0
        if self._scans:
            motion = between(self._scans[-1].odometry, scan.odometry)
            moved = float(np.hypot(motion[0], motion[1])) + abs(float(motion[2]))
            freshness = min(1.0, moved / self._config.fresh)
            self._since_search += float(np.hypot(motion[0], motion[1])) + 0.5 * abs(float(motion[2]))
            self._poses = self._evidence.follow(scan.points, self._poses, motion)
        self._scans.append(scan)
        self._freshness.append(freshness)
        judged = np.stack(self._evidence.judge(scan, self._poses), axis=-1)
        self._tables = np.concatenate((self._tables, judged[:, None]), axis=1)
        if len(self._scans) > self._config.scans:
            del self._scans[0], self._freshness[0]
            self._freshness[0] = 1.0
            self._tables = self._tables[:, 1:]

    def propose(self, poses: Array, prior: float = 1.0) -> None:
        """Add hypotheses T_map_robot (k, 3), followed back through the remembered scans.

        Args:
            poses: The hypotheses.
            prior: How many times likelier each is than any other place before the scans are looked at.
        """
        poses = poses[~self._known(poses)]
        if not len(poses):
            return
        table = np.empty((len(poses), len(self._scans), 2))
        now, then = self._scans[-1], poses
        for k in range(len(self._scans) - 1, -1, -1):
            scan = self._scans[k]
            if scan is not now:
                then = self._evidence.follow(scan.points, then, between(now.odometry, scan.odometry))
                now = scan
            table[:, k] = np.stack(self._evidence.judge(scan, then), axis=-1)
        self._poses = np.concatenate((self._poses, poses))
        self._priors = np.concatenate((self._priors, np.full(len(poses), np.log(prior))))
        self._tables = np.concatenate((self._tables, table))
        self._merge()

    def update(self, scan: PreparedScan) -> PlaceBelief:
        """Take a scan, search the map if the robot has moved, and return what is believed now."""
        self.remember(scan)
        return self.search()

    def search(self) -> PlaceBelief:
        """Search the map if the robot has moved since the last search, and return what is believed now."""
        self._merge()
        if self._since_search >= self._config.search_every:
            self._since_search = 0.0
            self.propose(self._found())
        if len(self._poses):
            self.propose(self._moved_along(self._poses[0]))
        return self.belief()

    def belief(self) -> PlaceBelief:
        """Return what is believed now."""
        if not len(self._poses):
            return _NOTHING
        totals, explained = self._totals()
        ratios = totals - totals[0]
        config = self._config
        missing = max(0.0, config.well_explained - float(explained[0]))
        needed = np.log(config.sure_ratio) * (1.0 + 10.0 * missing)
        clear = len(ratios) < 2 or -ratios[1] > needed
        sure = bool(clear and explained[0] >= config.least_explained)
        return PlaceBelief(self._poses.copy(), ratios, explained, sure)

    def _found(self) -> Array:
        """Return (k, 3) refined maxima of a search of the whole map, for the last scans together."""
        place, config = self._place, self._config
        last = self._scans[-1]
        points = np.concatenate(
            [last.points]
            + [transform_points(between(last.odometry, s.odometry), s.points) for s in self._scans[-2::-1]]
        )
        points = points[voxel_first(points, config.voxel)]
        thinned = points[np.linspace(0, len(points) - 1, min(config.points, len(points))).astype(np.int64)]
        window = SearchWindow(linear=place.half_side, angular=np.pi, angular_step=config.angular_step)
        centre = np.append(place.centre, 0.0)
        found = branch_and_bound(
            place.pyramid, thinned, centre, window,
            min_score=config.least_score, maxima=config.maxima, separation=config.separation,
        )  # fmt: skip
        poses = np.array([maximum.pose for maximum in found.maxima]).reshape(-1, 3)
        poses = self._evidence.refine(points, poses, coarse=True)
        return self._evidence.refine(last.points, poses)

    def _moved_along(self, pose: Array) -> Array:
        """Return (2, 3) `pose` moved both ways along its degenerate direction: in a corridor, rivals are there."""
        points = self._scans[-1].points
        way = 1.5 * self._config.same[0] * self._evidence.degenerate_direction(points, pose)
        moved = pose + np.array([[*way, 0.0], [*-way, 0.0]])
        return self._evidence.refine(points, moved, coarse=True)

    def _totals(self) -> tuple[Array, Array]:
        """Return (k,) log-likelihoods and (k,) shares explained, over the remembered scans."""
        weights = np.array(self._freshness)
        means = np.einsum("ksc,s->kc", self._tables, weights / weights.sum())
        beams = self._config.independent_beams * min(1.0, _FINE / self._place.resolution)
        count = beams * min(float(weights.sum()), self._config.independent_scans)
        return self._priors + count * means[:, 0], means[:, 1]

    def _merge(self) -> None:
        """Sort the hypotheses, join equal ones, drop hopeless ones and those that stand in walls or the unknown."""
        stand = self._place.is_free(self._poses[:, :2])
        self._poses, self._priors, self._tables = self._poses[stand], self._priors[stand], self._tables[stand]
        totals, _ = self._totals()
        kept: list[int] = []
        for k in np.argsort(-totals, kind="stable").tolist():
            if totals[k] < totals[kept[0] if kept else k] - np.log(self._config.hopeless):
                break
            if not kept or not self._same(self._poses[kept], self._poses[k]).any():
                kept.append(k)
        self._poses, self._priors, self._tables = self._poses[kept], self._priors[kept], self._tables[kept]

    def _known(self, poses: Array) -> NDArray[np.bool_]:
        return np.array([self._same(self._poses, pose).any() for pose in poses], dtype=np.bool_)

    def _same(self, poses: Array, pose: Array) -> NDArray[np.bool_]:
        linear, angular = self._config.same
        near = np.hypot(*(poses[:, :2] - pose[:2]).T) <= linear
        return near & (np.abs(wrap_angle(poses[:, 2] - pose[2])) <= angular)
