"""The verdict on a kidnap hypothesis, by how two places explain the last scans: the believed one, and the best other.

Where a scan was inconsistent with the one before, the robot may have been kidnapped, or people stepped into view. Where
all scans were consistent with those before, nobody can have kidnapped it: scans that contradict the submap are seen
where people walk and where short rays let local SLAM drift, and in a building that repeats itself another place then
explains them better. Only scans that cannot belong to the newest submap at all are believed to show a kidnapping then.
"""

from ..local.match_monitor import MatchMonitor
from .kidnap_hypothesis import SCANS, KidnapHypothesis, Verdict
from .place_comparison import PlaceComparison

BLOCKED = 0.05  # share of the beams that walls of the map would stop, of those that people and drift make
_EXPLAINED = 0.5  # share of the beams that must end at walls of the map where the robot is believed to have stayed


def verdict(hypothesis: KidnapHypothesis, monitor: MatchMonitor, comparison: PlaceComparison | None) -> Verdict:
    """Weigh the place where local SLAM has put the scans of a hypothesis against the rest of the map.

    Args:
        hypothesis: With its scans.
        monitor: What the newest submap says of them.
        comparison: How the place fared; None: hardly anything is mapped yet.
    """
    if comparison is None:
        return Verdict.KIDNAPPED if monitor.clearly_lost else Verdict.UNSURE
    if hypothesis.inconsistency:
        return _after_inconsistent_scans(hypothesis, monitor, comparison)
    return _after_consistent_scans(monitor, comparison)


def _after_inconsistent_scans(
    hypothesis: KidnapHypothesis, monitor: MatchMonitor, comparison: PlaceComparison
) -> Verdict:
    if _surely_elsewhere(comparison) and _believed_place_refuted(hypothesis, comparison):
        return Verdict.KIDNAPPED
    # The scans fit neither the newest submap nor the map where the robot is thought to be: it is in another building.
    if monitor.clearly_lost and not _explained_here(comparison):
        return Verdict.KIDNAPPED
    if _stayed(hypothesis, comparison):
        # Only trust, not what was seen, keeps the believed place first: wait for more scans.
        return Verdict.UNSURE if comparison.scans_favour_other else Verdict.HERE
    # A strong inconsistency that is still open: kidnapped where the believed place explains little of what was seen.
    out_of_time = hypothesis.count >= SCANS
    return Verdict.KIDNAPPED if out_of_time and comparison.explained_here < _EXPLAINED else Verdict.UNSURE


def _after_consistent_scans(monitor: MatchMonitor, comparison: PlaceComparison) -> Verdict:
    if _surely_here(comparison) or not (comparison.has_rival or monitor.alarmed):
        return Verdict.HERE
    # People all around make a scan unlike the submap, too; but then no other place explains it well.
    other = not _explained_here(comparison) or comparison.other_explains_well or _surely_elsewhere(comparison)
    return Verdict.KIDNAPPED if monitor.clearly_lost and other else Verdict.UNSURE


def _surely_here(comparison: PlaceComparison) -> bool:
    """Return whether no other place comes into question, be it that the map knows nothing around the believed one."""
    return comparison.here_is_best and (comparison.belief.sure or not len(comparison.belief.poses))


def _surely_elsewhere(comparison: PlaceComparison) -> bool:
    """Return whether another place is sure, farther away than drift can have led local SLAM."""
    return comparison.other_is_sure and not comparison.best_is_near


def _explained_here(comparison: PlaceComparison) -> bool:
    return comparison.explained_if_likely >= _EXPLAINED


def _believed_place_refuted(hypothesis: KidnapHypothesis, comparison: PlaceComparison) -> bool:
    """Return whether the believed place is not just one that is not mapped yet.

    What is new may look like what is mapped already. So the other place must explain the scans well and walls of the
    map must stop beams at the believed one, unless so much changed between two scans that people cannot have done it.
    """
    return hypothesis.strong or (comparison.other_explains_well and comparison.blocked >= BLOCKED)


def _stayed(hypothesis: KidnapHypothesis, comparison: PlaceComparison) -> bool:
    """Return whether nothing speaks for a kidnapping (any more): weak inconsistencies are forgotten after a while."""
    if _surely_here(comparison) or (_explained_here(comparison) and not comparison.has_rival):
        return True
    return hypothesis.count >= SCANS and not hypothesis.strong
