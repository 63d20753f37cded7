"""The place where a robot is thought to be, compared with all others on the map, by all its last scans."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry import between
from ...localization.evidence import Evidence
from ...localization.global_search import GlobalSearch, GlobalSearchConfig
from ...localization.localizer import LocalizerConfig
from ...localization.place_belief import PlaceBelief
from ...localization.place_map import PlaceMap
from ...localization.prepared_scan import PreparedScan, ScanPreparation
from ...scan import LaserScan

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PlaceComparison:
    """How the believed place fared against all others.

    Attributes:
        here_is_best: Whether no other place is likelier; so, too, where the map knows nothing of the believed one.
        other_explains_well: Whether another place is likelier and explains the scans well.
        has_rival: Whether another place explains the scans well and is likelier, or nearly as likely; so, too, where
            it explains only half, and no third place is likely.
        belief: What is believed of all places.
        explained_if_likely: Share of the beams that end at walls of the map if the robot is at the believed place; 0
            where that is surely less likely than another place.
        best_is_near: Whether the likeliest place is so near to the believed one that a search would not tell the two
            apart, or that drift leads from the one to the other: nobody has to kidnap the robot.
        other_is_sure: Whether another place is surely where the robot is, however well it explains the scans.
        explained_here: As `explained_if_likely`, however likely the believed place is.
        scans_favour_other: Whether another place is surely likelier by the scans alone, were the believed one not
            trusted beforehand.
        blocked: Share of the beams that come through walls of the map if the robot is at the believed place.
    """

    here_is_best: bool
    other_explains_well: bool
    has_rival: bool
    belief: PlaceBelief
    explained_if_likely: float = 0.0
    best_is_near: bool = False
    other_is_sure: bool = False
    explained_here: float = 0.0
    scans_favour_other: bool = False
    blocked: float = 0.0


def compare_places(
    place: PlaceMap,
    scans: Sequence[tuple[Array, LaserScan]],
    here: Array,
    config: LocalizerConfig | None = None,
    trust: float | None = None,
    drift: float = 0.0,
) -> PlaceComparison:
    """Compare the believed place `here` (3,), T_map_robot at the last scan, with the rest of the map.

    Args:
        place: The map.
        scans: Odometry poses T_odom_robot (3,) and scans, the last ones.
        here: Where the robot is thought to be.
        config: Settings of localization.
        trust: How many times likelier that is than any other place beforehand; None: `config.trust`.
        drift: So far it may have been led astray [m].
    """
    config = config or LocalizerConfig()
    trust = config.trust if trust is None else trust
    evidence = Evidence(place, config.evidence)
    search, prepared = GlobalSearch(place, evidence, config.search), _prepared(scans, config)
    if not prepared or not place.is_free(here[None, :2])[0]:
        return PlaceComparison(True, False, False, search.belief())
    for scan in prepared:
        search.remember(scan)
    fitted = evidence.refine(prepared[-1].points, here[None], coarse=True)
    search.propose(fitted, trust)
    search.propose(here[None], trust)
    explained = float(search.belief().explained.max(initial=0.0))
    belief = search.search()
    if not len(belief.poses):
        return PlaceComparison(True, False, False, belief)
    comparison = judge_belief(here, belief, config.search, trust, drift)
    return replace(comparison, explained_here=explained, blocked=_blocked(evidence, prepared, fitted))


def _blocked(evidence: Evidence, scans: Sequence[PreparedScan], poses: Array) -> float:
    """Return the mean share of the beams of scans that come through walls; `poses` (1, 3) at the last one."""
    shares, now = [evidence.blocked(scans[-1], poses[0])], scans[-1]
    for scan in scans[-2::-1]:
        poses, now = evidence.follow(scan.points, poses, between(now.odometry, scan.odometry)), scan
        shares.append(evidence.blocked(scan, poses[0]))
    return float(np.mean(shares))


def _prepared(scans: Sequence[tuple[Array, LaserScan]], config: LocalizerConfig) -> list[PreparedScan]:
    """Return those scans that have enough points to say something, made ready for localization."""
    preparation = ScanPreparation(config.voxel_filter)
    prepared = [preparation.prepare(odometry, scan) for odometry, scan in scans]
    return [scan for scan in prepared if len(scan.points) >= config.min_points]


def judge_belief(
    here: Array, belief: PlaceBelief, config: GlobalSearchConfig, trust: float, drift: float
) -> PlaceComparison:
    """Say how the believed place `here` (3,) fared by what is believed of all places.

    Args:
        here: Where the robot is thought to be, T_map_robot.
        belief: At least one place.
        config: What counts as the same, as likely, as well explained.
        trust: How many times likelier it was taken to be beforehand.
        drift: So far it may have been led astray [m].
    """
    linear, angular = config.same
    off = between(here, belief.poses)
    same = (np.hypot(off[:, 0], off[:, 1]) <= linear) & (np.abs(off[:, 2]) <= angular)
    well_elsewhere = ~same & (belief.explained >= config.well_explained)
    likely = belief.log_ratios > -np.log(config.sure_ratio)
    apart = config.separation
    near = bool(np.hypot(*off[0, :2]) <= max(apart.linear, drift) and abs(off[0, 2]) <= apart.angular)
    alone = likely.sum() == 1 and belief.explained[0] >= config.least_explained
    lead = belief.log_ratios[~same].max(initial=-np.inf) - belief.log_ratios[same].max(initial=-np.inf)
    return PlaceComparison(
        here_is_best=bool(same[0]),
        other_explains_well=bool(well_elsewhere[0]),
        has_rival=bool((well_elsewhere & likely).any() or (alone and not same[0])),
        belief=belief,
        explained_if_likely=float(belief.explained[same & likely].max(initial=0.0)),
        best_is_near=near,
        other_is_sure=bool(not same[0] and belief.sure),
        scans_favour_other=bool(lead + np.log(trust) > np.log(config.sure_ratio)),
    )
