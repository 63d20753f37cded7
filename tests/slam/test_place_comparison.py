"""Where the robot is held against the other places that are believed in."""

import numpy as np
from tagalong.slam.graph.recovery.place_comparison import judge_belief
from tagalong.slam.localization.global_search import GlobalSearchConfig
from tagalong.slam.localization.place_belief import PlaceBelief


def believed(*places):
    """Return the belief in `places`: pose, logarithm of the likelihood over the first's, share explained."""
    poses, ratios, explained = zip(*places, strict=True)
    needed = np.log(10.0) * (1.0 + 10.0 * max(0.0, 0.85 - explained[0]))
    sure = len(places) < 2 or -ratios[1] > needed
    return PlaceBelief(np.array(poses), np.array(ratios), np.array(explained), sure)


def test_a_place_that_explains_half_and_is_likelier_than_any_other_is_a_rival_and_surpasses_where_it_is_sure():
    config, here, there, third = GlobalSearchConfig(), (0.0, 0.0, 0.0), (0.0, 4.0, 3.1), (5.0, 0.0, 0.0)
    for places, rivalled, surpassed in (
        ([(there, 0.0, 0.74), (here, -4.0, 0.58)], True, False),  # a half-turn seen in a meeting room
        ([(there, 0.0, 0.74), (here, -6.0, 0.58)], True, True),
        ([(there, 0.0, 0.74), (here, -2.0, 0.58)], False, False),  # about as likely, and explained badly: people
        ([(there, 0.0, 0.74), (third, -1.0, 0.7)], False, False),  # not mapped: it looks a little like many places
        ([(there, 0.0, 0.45), (here, -4.0, 0.4)], False, False),
        ([(here, 0.0, 0.9), (there, -2.0, 0.86)], True, False),
        ([(here, 0.0, 0.9), (there, -9.0, 0.86)], False, False),
    ):
        outcome = judge_belief(np.array(here), believed(*places), config, 1.0, 0.0)
        assert (outcome.has_rival, outcome.other_is_sure) == (rivalled, surpassed), places
        assert not outcome.other_explains_well


def test_a_place_as_near_as_drift_leads_is_beside():
    belief = believed(((0.9, 0.0, 0.1), 0.0, 0.9))
    config = GlobalSearchConfig()
    near = [judge_belief(np.zeros(3), belief, config, 1.0, drift).best_is_near for drift in (0.0, 0.8, 1.0)]
    assert near == [False, False, True]


def test_a_place_that_only_trust_keeps_first_is_outweighed_by_what_was_seen():
    here, there = (0.0, 0.0, 0.0), (0.0, 4.0, 3.1)
    for places, trust, outweighed in (
        ([(here, 0.0, 0.9), (there, -5.6, 0.98)], 5000.0, True),  # 18 times likelier by the scans
        ([(here, 0.0, 0.9), (there, -5.6, 0.98)], 1000.0, False),
        ([(here, 0.0, 0.9), (there, -5.6, 0.98)], 1.0, False),
        ([(there, 0.0, 0.9), (here, -3.0, 0.8)], 1.0, True),
        ([(here, 0.0, 0.9)], 5000.0, False),
        ([(there, 0.0, 0.9)], 1.0, True),
    ):
        outcome = judge_belief(np.array(here), believed(*places), GlobalSearchConfig(), trust, 0.0)
        assert outcome.scans_favour_other == outweighed, (places, trust)
