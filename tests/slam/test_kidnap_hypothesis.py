"""What a doubt comes to, by how the drive was torn, how long ago, and how the place fares on the map."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.slam.graph.recovery.kidnap_hypothesis import SCANS, KidnapHypothesis, Verdict, verdict
from tagalong.slam.graph.recovery.place_comparison import PlaceComparison
from tagalong.slam.localization.global_search import PlaceBelief

NARROW, WIDE = 0.1, 0.4


def doubt(torn=0.0, count=3):
    made = KidnapHypothesis()
    if torn:
        made.tear(torn, 100)
    for _ in range(count):
        made.add(np.zeros(3), SimpleNamespace())
    return made


def watch(alarmed=False, plainly=False):
    return SimpleNamespace(alarmed=alarmed or plainly, plainly_lost=plainly)


def contest(sure=False, **fields):
    belief = PlaceBelief(np.zeros((1, 3)), np.zeros(1), np.ones(1), sure)
    return PlaceComparison(**({"stays": False, "moved": False, "rivalled": True, "belief": belief} | fields))


ELSEWHERE = contest(sure=True, moved=True, surpassed=True, blocked=0.2)
HERE = contest(sure=True, stays=True, rivalled=False, explained=0.9, fits=0.9)
OPEN = contest(stays=True, explained=0.9, fits=0.9)
NOTHING_FITS = contest(rivalled=False)


@pytest.mark.parametrize("torn", [NARROW, WIDE])
def test_after_a_tear_a_place_that_is_sure_says_where_the_robot_is(torn):
    assert verdict(doubt(torn), watch(), ELSEWHERE) is Verdict.KIDNAPPED
    assert verdict(doubt(torn), watch(), HERE) is Verdict.HERE


@pytest.mark.parametrize("missing", [{"blocked": 0.0}, {"moved": False}])
def test_people_tear_scans_too_and_what_is_new_looks_like_another_place_or_drift_blocks_the_beams(missing):
    outcome = replace(ELSEWHERE, **missing)
    assert verdict(doubt(NARROW), watch(), outcome) is Verdict.UNSURE
    assert verdict(doubt(WIDE), watch(), outcome) is Verdict.KIDNAPPED


def test_without_a_tear_nobody_is_carried_unless_no_scan_can_belong_there():
    assert verdict(doubt(), watch(alarmed=True), ELSEWHERE) is Verdict.UNSURE
    assert verdict(doubt(), watch(plainly=True), ELSEWHERE) is Verdict.KIDNAPPED
    assert verdict(doubt(), watch(plainly=True), HERE) is Verdict.HERE


def test_drift_leads_to_a_place_beside_and_nobody_was_carried_there():
    beside = contest(sure=True, surpassed=True, beside=True, explained=0.6, fits=0.6)
    assert verdict(doubt(NARROW), watch(), beside) is Verdict.UNSURE
    assert verdict(doubt(), watch(plainly=True), beside) is Verdict.UNSURE
    apart = contest(sure=True, surpassed=True, explained=0.6)
    assert verdict(doubt(), watch(plainly=True), apart) is Verdict.KIDNAPPED


@pytest.mark.parametrize(
    ("torn", "outcome", "then"),
    [
        (NARROW, OPEN, Verdict.HERE),
        (NARROW, NOTHING_FITS, Verdict.HERE),
        (WIDE, OPEN, Verdict.UNSURE),
        (WIDE, NOTHING_FITS, Verdict.KIDNAPPED),
    ],
)
def test_what_is_still_open_after_some_scans_ends_by_how_wide_the_tear_was(torn, outcome, then):
    assert verdict(doubt(torn, SCANS - 1), watch(), outcome) is Verdict.UNSURE
    assert verdict(doubt(torn, SCANS), watch(), outcome) is then


@pytest.mark.parametrize("count", [3, SCANS])
def test_while_the_scans_alone_speak_for_another_place_nobody_is_sure_to_have_stayed(count):
    for outcome in (HERE, OPEN):
        assert verdict(doubt(NARROW, count), watch(), replace(outcome, outweighed=True)) is Verdict.UNSURE


def test_scans_that_cannot_belong_there_and_fit_nowhere_are_of_another_building():
    for torn in (0.0, NARROW, WIDE):
        assert verdict(doubt(torn), watch(plainly=True), NOTHING_FITS) is Verdict.KIDNAPPED
        assert verdict(doubt(torn), watch(plainly=True), None) is Verdict.KIDNAPPED
        assert verdict(doubt(torn), watch(alarmed=True), None) is Verdict.UNSURE
    half = contest(rivalled=False, explained=0.6, fits=0.6)
    assert verdict(doubt(), watch(plainly=True), half) is Verdict.UNSURE  # people all around


def test_a_tear_is_weighed_with_each_third_scan_and_later_with_each_ninth_until_it_is_mended():
    made, due = doubt(WIDE, 0), []
    for count in range(1, 30):
        made.add(np.zeros(3), SimpleNamespace())
        due += [count] if made.due else []
    assert due == [3, 6, 9, 18, 27]
    assert len(made.scans) == SCANS
    made.conclude(Verdict.UNSURE)
    assert (made.unsure, made.nodes) == (True, 100)
    made.conclude(Verdict.HERE)
    assert (made.unsure, made.nodes, made.torn, made.due) == (False, None, 0.0, False)
    assert not doubt(count=3).due


def test_a_second_tear_is_weighed_by_scans_since_then_on_the_map_before_the_first():
    made = doubt(NARROW)
    made.tear(WIDE, 120)
    assert (made.torn, made.nodes, made.count, made.scans, made.unsure) == (WIDE, 100, 0, [], True)


def test_a_wide_tear_makes_it_unsure_at_once_and_its_place_is_trusted_less():
    assert doubt(WIDE).unsure
    assert not doubt(NARROW).unsure
    assert doubt(WIDE).trust < doubt(NARROW).trust == doubt().trust
