"""The verdict on a kidnap hypothesis: by how inconsistent scans were, how long ago, and how the place fares."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.slam.graph.recovery.kidnap_hypothesis import SCANS, KidnapHypothesis, Verdict
from tagalong.slam.graph.recovery.place_comparison import PlaceComparison
from tagalong.slam.graph.recovery.verdict import verdict
from tagalong.slam.localization.place_belief import PlaceBelief

WEAK, STRONG = 0.1, 0.4


def hypothesis(inconsistency=0.0, count=3):
    made = KidnapHypothesis()
    if inconsistency:
        made.begin(inconsistency, 100)
    for _ in range(count):
        made.add(np.zeros(3), SimpleNamespace())
    return made


def monitor(alarmed=False, lost=False):
    return SimpleNamespace(alarmed=alarmed or lost, clearly_lost=lost)


def comparison(sure=False, **fields):
    belief = PlaceBelief(np.zeros((1, 3)), np.zeros(1), np.ones(1), sure)
    return PlaceComparison(
        **({"here_is_best": False, "other_explains_well": False, "has_rival": True, "belief": belief} | fields)
    )


ELSEWHERE = comparison(sure=True, other_explains_well=True, other_is_sure=True, blocked=0.2)
HERE = comparison(sure=True, here_is_best=True, has_rival=False, explained_if_likely=0.9, explained_here=0.9)
OPEN = comparison(here_is_best=True, explained_if_likely=0.9, explained_here=0.9)
NOTHING_FITS = comparison(has_rival=False)


@pytest.mark.parametrize("inconsistency", [WEAK, STRONG])
def test_after_inconsistent_scans_a_place_that_is_sure_says_where_the_robot_is(inconsistency):
    assert verdict(hypothesis(inconsistency), monitor(), ELSEWHERE) is Verdict.KIDNAPPED
    assert verdict(hypothesis(inconsistency), monitor(), HERE) is Verdict.HERE


@pytest.mark.parametrize("missing", [{"blocked": 0.0}, {"other_explains_well": False}])
def test_people_make_scans_inconsistent_too_and_what_is_new_looks_like_another_place_or_drift_blocks_the_beams(missing):
    outcome = replace(ELSEWHERE, **missing)
    assert verdict(hypothesis(WEAK), monitor(), outcome) is Verdict.UNSURE
    assert verdict(hypothesis(STRONG), monitor(), outcome) is Verdict.KIDNAPPED


def test_after_consistent_scans_nobody_was_kidnapped_unless_no_scan_can_belong_there():
    assert verdict(hypothesis(), monitor(alarmed=True), ELSEWHERE) is Verdict.UNSURE
    assert verdict(hypothesis(), monitor(lost=True), ELSEWHERE) is Verdict.KIDNAPPED
    assert verdict(hypothesis(), monitor(lost=True), HERE) is Verdict.HERE


def test_drift_leads_to_a_place_beside_and_nobody_was_kidnapped_there():
    beside = comparison(sure=True, other_is_sure=True, best_is_near=True, explained_if_likely=0.6, explained_here=0.6)
    assert verdict(hypothesis(WEAK), monitor(), beside) is Verdict.UNSURE
    assert verdict(hypothesis(), monitor(lost=True), beside) is Verdict.UNSURE
    apart = comparison(sure=True, other_is_sure=True, explained_if_likely=0.6)
    assert verdict(hypothesis(), monitor(lost=True), apart) is Verdict.KIDNAPPED


@pytest.mark.parametrize(
    ("inconsistency", "outcome", "then"),
    [
        (WEAK, OPEN, Verdict.HERE),
        (WEAK, NOTHING_FITS, Verdict.HERE),
        (STRONG, OPEN, Verdict.UNSURE),
        (STRONG, NOTHING_FITS, Verdict.KIDNAPPED),
    ],
)
def test_what_is_still_open_after_some_scans_ends_by_how_inconsistent_they_were(inconsistency, outcome, then):
    assert verdict(hypothesis(inconsistency, SCANS - 1), monitor(), outcome) is Verdict.UNSURE
    assert verdict(hypothesis(inconsistency, SCANS), monitor(), outcome) is then


@pytest.mark.parametrize("count", [3, SCANS])
def test_while_the_scans_alone_speak_for_another_place_nobody_is_sure_to_have_stayed(count):
    for outcome in (HERE, OPEN):
        assert verdict(hypothesis(WEAK, count), monitor(), replace(outcome, scans_favour_other=True)) is Verdict.UNSURE


def test_scans_that_cannot_belong_there_and_fit_nowhere_are_of_another_building():
    for inconsistency in (0.0, WEAK, STRONG):
        assert verdict(hypothesis(inconsistency), monitor(lost=True), NOTHING_FITS) is Verdict.KIDNAPPED
        assert verdict(hypothesis(inconsistency), monitor(lost=True), None) is Verdict.KIDNAPPED
        assert verdict(hypothesis(inconsistency), monitor(alarmed=True), None) is Verdict.UNSURE
    half = comparison(has_rival=False, explained_if_likely=0.6, explained_here=0.6)
    assert verdict(hypothesis(), monitor(lost=True), half) is Verdict.UNSURE  # people all around


def test_a_hypothesis_is_weighed_with_each_third_scan_and_later_with_each_ninth_until_it_is_dropped():
    made, due = hypothesis(STRONG, 0), []
    for count in range(1, 30):
        made.add(np.zeros(3), SimpleNamespace())
        due += [count] if made.due else []
    assert due == [3, 6, 9, 18, 27]
    assert len(made.scans) == SCANS
    made.conclude(Verdict.UNSURE)
    assert (made.unsure, made.trusted_nodes) == (True, 100)
    made.conclude(Verdict.HERE)
    assert (made.unsure, made.trusted_nodes, made.inconsistency, made.due) == (False, None, 0.0, False)
    assert not hypothesis(count=3).due


def test_a_second_inconsistency_is_weighed_by_scans_since_then_on_the_map_before_the_first():
    made = hypothesis(WEAK)
    made.begin(STRONG, 120)
    assert (made.inconsistency, made.trusted_nodes, made.count, made.scans, made.unsure) == (STRONG, 100, 0, [], True)


def test_a_strong_inconsistency_makes_it_unsure_at_once_and_its_place_is_trusted_less():
    assert hypothesis(STRONG).unsure
    assert not hypothesis(WEAK).unsure
    assert hypothesis(STRONG).trust < hypothesis(WEAK).trust == hypothesis().trust
