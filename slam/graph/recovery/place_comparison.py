"""Whether a robot is where it is thought to be, or somewhere else on the map: both by all its last views."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry import between
from ...localization.evidence import Evidence
from ...localization.global_search import GlobalSearch, GlobalSearchConfig, PlaceBelief
from ...localization.localizer import LocalizerConfig
from ...localization.place_map import PlaceMap
from ...localization.prepared_scan import PreparedScan, ScanPreparation
from ...scan import LaserScan

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PlaceComparison:
    """How a place fared against all others.

    Attributes:
        stays: Whether no other place is likelier; so, too, where the map knows nothing of the place.
        moved: Whether another place is likelier and explains what was seen well.
        rivalled: Whether another place explains what was seen well and is likelier, or nearly as likely; so, too, where
            it explains but half, and no third place is likely.
        surpassed: Whether another place is surely where the robot is, however well it explains what was seen.
        belief: What is believed of all places.
        explained: Share of the beams that end at walls of the map if the robot is where it was thought to be; 0 where
            that is surely less likely than another place.
        beside: Whether the likeliest place is so near to it that a search would not tell the two apart, or that drift
            leads from the one to the other: nobody has to carry the robot.
        fits: As `explained`, however likely that is.
        outweighed: Whether another place is surely likelier by what was seen alone, were it not trusted beforehand.
        blocked: Share of the beams that come through walls of the map if the robot is where it was thought to be.
    """

    stays: bool
    moved: bool
    rivalled: bool
    belief: PlaceBelief
    explained: float = 0.0
    beside: bool = False
    surpassed: bool = False
    fits: float = 0.0
    outweighed: bool = False
    blocked: float = 0.0


def compare_places(
    place: PlaceMap,
    scans: Sequence[tuple[Array, LaserScan]],
    here: Array,
    config: LocalizerConfig | None = None,
    trust: float | None = None,
    drift: float = 0.0,
) -> PlaceComparison:
    """Weigh `here` (3,), T_map_robot at the last scan, against the rest of the map.

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
    search, views = GlobalSearch(place, evidence, config.search), _views(scans, config)
    if not views or not place.is_free(here[None, :2])[0]:
        return PlaceComparison(True, False, False, search.belief())
    for view in views:
        search.remember(view)
    fitted = evidence.refine(views[-1].points, here[None], coarse=True)
    search.propose(fitted, trust)
    search.propose(here[None], trust)
    fits = float(search.belief().explained.max(initial=0.0))
    belief = search.look()
    if not len(belief.poses):
        return PlaceComparison(True, False, False, belief)
    outcome = weigh(here, belief, config.search, trust, drift)
    return replace(outcome, fits=fits, blocked=_blocked(evidence, views, fitted))


def _blocked(evidence: Evidence, views: Sequence[PreparedScan], poses: Array) -> float:
    """Return the mean share of the beams of views that come through walls; `poses` (1, 3) at the last one."""
    shares, now = [evidence.blocked(views[-1], poses[0])], views[-1]
    for view in views[-2::-1]:
        poses, now = evidence.carry(view.points, poses, between(now.odometry, view.odometry)), view
        shares.append(evidence.blocked(view, poses[0]))
    return float(np.mean(shares))


def _views(scans: Sequence[tuple[Array, LaserScan]], config: LocalizerConfig) -> list[PreparedScan]:
    """Return the views of those scans that say something."""
    maker = ScanPreparation(config.voxel_filter)
    views = [maker.view(odometry, scan) for odometry, scan in scans]
    return [view for view in views if len(view.points) >= config.min_points]


def weigh(here: Array, belief: PlaceBelief, config: GlobalSearchConfig, trust: float, drift: float) -> PlaceComparison:
    """Say how `here` (3,) fared by what is believed now.

    Args:
        here: Where the robot is thought to be, T_map_robot.
        belief: At least one place.
        config: What counts as the same, as likely, as well explained.
        trust: How many times likelier it was taken to be beforehand.
        drift: So far it may have been led astray [m].
    """
    linear, angular = config.same
    off = between(here, belief.poses)
    there = (np.hypot(off[:, 0], off[:, 1]) <= linear) & (np.abs(off[:, 2]) <= angular)
    well = ~there & (belief.explained >= config.well_explained)
    likely = belief.log_ratios > -np.log(config.sure_ratio)
    explained = float(belief.explained[there & likely].max(initial=0.0))
    apart = config.separation
    beside = bool(np.hypot(*off[0, :2]) <= max(apart.linear, drift) and abs(off[0, 2]) <= apart.angular)
    alone = likely.sum() == 1 and belief.explained[0] >= config.least_explained
    rivalled = bool((well & likely).any() or (alone and not there[0]))
    surpassed = bool(not there[0] and belief.sure)
    lead = belief.log_ratios[~there].max(initial=-np.inf) - belief.log_ratios[there].max(initial=-np.inf)
    return PlaceComparison(
        stays=bool(there[0]), moved=bool(well[0]), rivalled=rivalled, belief=belief, explained=explained,
        beside=beside, surpassed=surpassed, outweighed=bool(lead + np.log(trust) > np.log(config.sure_ratio)),
    )  # fmt: skip
