"""A doubt where the robot is: local SLAM's opinion against the map of before, by all scans since the doubt began."""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry import between, compose
from ...localization.beam_fit import BeamFit, Sight
from ...localization.hypotheses import HypothesesConfig, near
from ...localization.localizer import Localizer, LocalizerConfig
from ...localization.place_map import PlaceMap
from ...localization.prepared_scan import ScanPreparation
from ...scan import LaserScan

Array = NDArray[np.float64]

# The map is of a minute ago, by the same laser: what fits it badly is elsewhere, and few scans tell what is usual. How
# the robot moved is not asked of local SLAM, which is what is doubted. Mapping goes on for a robot that is off the map,
# so only where on it the robot may be is asked. With `fresh` of 1 m a ring of like rooms was torn, undisturbed.
_HERE = HypothesesConfig(evidence=4.0, level_scans=2.0, off_map=False)
_LOCALIZER = LocalizerConfig(local=None, hypotheses=_HERE, fresh=2.5)
_AGREE = 1.0, 0.35  # [m, rad] by which local SLAM may have drifted since, or the map
_DRIFT = np.array([0.3, 0.1])  # [m, rad] standard deviations of that: where it has the robot is refined so far
_VOUCHED = 3  # scans in a row that fit the map where local SLAM has the robot end the doubt
_KNOWN = 0.5  # share of the beams of which the map must know something to vouch for a place
_CONFIRMED = 3  # scans in a row that find it elsewhere
_PROBATION = 3.0, 10  # [m, scans] for which the robot must be followed elsewhere before it is believed to be there


@dataclass(frozen=True, eq=False)
class _Judged:
    """A scan, where local SLAM had the robot in its own frame (3,), how badly it fits the map there, and the share of
    its beams that end where the map knows something."""

    sight: Sight
    pose_local: Array
    misfit: float
    known: float

    def back_to(self, before: "_Judged") -> list[Array]:
        """Return (3,) T_robot_before by the odometry and by local SLAM."""
        return [between(self.sight.odometry, before.sight.odometry), between(self.pose_local, before.pose_local)]


class Doubt:
    """Weighs where local SLAM has the robot on a map, and once that is refuted searches the map for it.

    Where the map knows nothing no scan can contradict it, nor vouch for it: a scan counts by the share of its beams of
    which the map knows something there.

    Args:
        around: The map before the doubt around the robot; None: hardly anything is mapped, and nothing can be said.
        whole: Draws all of that map, which takes long: only once the robot must be searched for.
        known: Scans of before and (3,) T_map_robot of each: so well do scans usually fit.
        closable: How far off local SLAM may be for loop closure to find that by itself [m, rad].
        lost: Whether local SLAM has no opinion where on the map the robot is: then it is refuted from the beginning.

    Attributes:
        travelled: How far the robot has driven since [m].
        scans: So many scans there were since.
        elsewhere: (3,) T_map_robot where it seems to be instead; None: not known, or nowhere else.
        vouched: Whether the last scan fits the map where local SLAM has the robot.
    """

    def __init__(
        self,
        around: PlaceMap | None,
        whole: Callable[[], PlaceMap | None],
        known: Sequence[tuple[LaserScan, Array]],
        closable: tuple[float, float],
        lost: bool = False,
    ) -> None:
        self._config, self._closable, self._whole = _LOCALIZER, closable, whole
        self._localizer: Localizer | None = None  # once refuted
        self._preparation = ScanPreparation(self._config.voxel_filter)
        self._before: Array | None = None  # T_local_robot at the last scan
        self._lost, self._against = lost, 0.0  # by how much another place is likelier, as a logarithm
        self._misfit = self._known = 0.0  # sums over what was weighed: misfit, and share of which the map knows
        self._unweighed, self._fitting = np.inf, 0  # way since a scan was weighed; scans in a row that fit
        self._followed = 0.0  # how long it was followed elsewhere [m] ...
        self._there = deque[tuple[float, float]](maxlen=_PROBATION[1])  # ... and how its last scans fit there
        self._judged: list[_Judged | None] = []  # None: too few returns
        self.travelled, self.scans = 0.0, 0
        self.vouched = False
        self.elsewhere: Array | None = None
        self._place = around
        if around is not None:
            self._judge_on(around)
            self._level = self._usual(known)

    def _judge_on(self, place: PlaceMap) -> None:
        self._fit = BeamFit(place, self._config.fit)
        self._lenient = BeamFit(place, replace(self._config.fit, unseen=1.0))

    def _usual(self, known: Sequence[tuple[LaserScan, Array]]) -> float:
        """Return how much scans misfit the map where they were taken."""
        config = self._config.hypotheses
        misfits = [
            float(self._fit.judge(sight, pose[None])[0][0])
            for scan, pose in known
            if (sight := self._sight(np.zeros(3), scan)) is not None
        ]
        return float(np.clip(np.mean(misfits or config.level), config.least_level, config.most_level))

    def _sight(self, odometry: Array, scan: LaserScan) -> Sight | None:
        """Return a scan made ready; None: it has too few returns to say anything."""
        prepared = self._preparation.prepare(odometry, scan)
        if len(prepared.points) < self._config.min_points:
            return None
        return self._fit.sight(odometry, prepared.points, prepared.sensor)

    def weigh(self, odometry: Array, scan: LaserScan, pose_local: Array, T_map_local: Array) -> None:
        """Take a scan.

        Args:
            odometry: (3,) T_odom_robot.
            scan: The scan.
            pose_local: (3,) T_local_robot: where local SLAM has the robot in its own frame, which loop closures leave.
            T_map_local: (3,) where that frame lies by now.
        """
        pose = compose(T_map_local, pose_local)
        moved = np.zeros(3) if self._before is None else between(self._before, pose_local)
        way = float(np.hypot(moved[0], moved[1]))
        self._before, self.travelled, self.scans = pose_local, self.travelled + way, self.scans + 1
        if self._place is None:
            return
        if not self._lost:
            self._judge(odometry, scan, pose, pose_local, way + abs(float(moved[2])))
        if self.refuted and self._localizer is None and (whole := self._whole()):
            self._judge_on(whole)
            self._localizer = Localizer(whole, self._config)
        if self._localizer:
            self._search(self._localizer, odometry, scan, pose, way)
        self._fitting = self._fitting + 1 if self.vouched else 0

    def _judge(self, odometry: Array, scan: LaserScan, pose: Array, pose_local: Array, moved: float) -> None:
        """Add up how much worse than usual the scan fits the map where local SLAM has it."""
        self._unweighed += moved
        sight = self._sight(odometry, scan)
        self.vouched = False
        if sight is None:
            self._judged.append(None)
            return
        misfit, known = self._fits(sight, pose)
        self._judged.append(_Judged(sight, pose_local, misfit, known))
        self.vouched = known > _KNOWN and self._excess(misfit, known) < 0.0
        if self.scans > _VOUCHED and self._unweighed < self._config.step:
            return
        fresh = 1.0 if self.scans <= _VOUCHED else min(1.0, self._unweighed / self._config.fresh)
        self._against += fresh * self._config.hypotheses.evidence * self._excess(misfit, known) / self._level
        self._misfit, self._known = self._misfit + fresh * misfit, self._known + fresh * known
        self._unweighed = 0.0

    def _fits(self, sight: Sight, pose: Array) -> tuple[float, float]:
        """Return how badly a scan fits near `pose` (3,), and what share of its beams the map knows of."""
        here = self._refined(sight, pose)
        misfit, strict = (float(fit.judge(sight, here)[0][0]) for fit in (self._lenient, self._fit))
        return misfit, min(1.0, max(0.0, 1.0 - (strict - misfit) / self._fit.unseen))

    def _excess(self, misfit: float, known: float) -> float:
        """Return how much worse what the map knows of a scan fits than it may, at a place where the robot is."""
        return misfit - known * (self._level + self._config.hypotheses.excess)

    def _refined(self, sight: Sight, pose: Array) -> Array:
        """Return (1, 3) where near `pose` (3,) a scan fits the map best."""
        return self._fit.follow(sight, pose[None], np.zeros(3), _DRIFT)[0]

    @property
    def changed(self) -> int:
        """The scan from which on the robot was elsewhere: those before fit better where local SLAM had it.

        The robot is followed back from where it was found, by the odometry or by local SLAM, whichever fits.
        """
        gains = np.zeros(len(self._judged))  # of that way over where local SLAM had it
        there, after = self.elsewhere, None
        for k in range(len(self._judged) - 1, -1, -1):
            judged = self._judged[k]
            if there is None or judged is None:
                continue
            steps = [np.zeros(3)] if after is None else after.back_to(judged)
            ways = [self._refined(judged.sight, compose(there, step)) for step in steps]
            misfits = [float(self._lenient.judge(judged.sight, way)[0][0]) for way in ways]
            best = int(np.argmin(misfits))
            gains[k], there, after = judged.misfit - judged.known * misfits[best], ways[best][0], judged
        return int(np.argmax(np.append(np.cumsum(gains[::-1])[::-1], 0.0)))

    def _search(self, localizer: Localizer, odometry: Array, scan: LaserScan, pose: Array, way: float) -> None:
        """Look for the robot on all of the map."""
        found = localizer.update(odometry, scan).pose
        here = beside = False
        if found is not None and not self._lost:
            here, beside = bool(near(pose[None], found, _AGREE)[0]), bool(near(pose[None], found, self._closable)[0])
        self.vouched |= here
        if found is None or not self.refuted or here or beside:
            self._followed, self.elsewhere = 0.0, None
            self._there.clear()
            return
        self._followed += way
        if (sight := self._sight(odometry, scan)) is not None:
            self._there.append(self._fits(sight, found))
        self.elsewhere = found if len(self._there) >= _CONFIRMED else None

    @property
    def refuted(self) -> bool:
        """Whether the map rules out that the robot is where local SLAM has it."""
        config = self._config.hypotheses
        return self._lost or self._against > -config.jump - np.log(1.0 - config.sure)

    @property
    def settled(self) -> bool:
        """Whether the map says that the robot is where local SLAM has it: for long, where it was found elsewhere, too,
        for then two places look alike."""
        return not self._lost and self._fitting >= (_VOUCHED if self.elsewhere is None else _PROBATION[1])

    @property
    def _contradicted(self) -> bool:
        """Whether hardly anything fits that the map knows of: people may surround a laser, but not hide it all."""
        most = -0.5 * np.log(self._config.fit.stray)  # where half the beams end away from all walls
        return self._lost or self._misfit > most * self._known

    @property
    def impossible(self) -> bool:
        """Whether hardly anything on a stretch of the drive fits."""
        way, scans = _PROBATION
        return self._contradicted and self.travelled >= way and self.scans >= scans

    @property
    def possible(self) -> bool:
        """Whether the robot may well be where local SLAM has it: at worst people hide a part of what the map knows."""
        return self.vouched or not (self.refuted and self._contradicted)

    @property
    def followed(self) -> bool:
        """Whether the robot has been followed `elsewhere` for some scans."""
        return self.elsewhere is not None and len(self._there) == self._there.maxlen

    @property
    def found(self) -> bool:
        """Whether the robot is `elsewhere` beyond doubt: what it saw there fits on the whole, and at last."""
        if not self.followed or self._followed < _PROBATION[0]:
            return False
        misfit, known = np.mean(self._there, axis=0).tolist()
        return known > _KNOWN and max(self._excess(misfit, known), self._excess(*self._there[-1])) < 0.0
