"""A second place where the robot may be, that the next scans decide for or against."""

import numpy as np
import pytest
from tagalong.slam.geometry import compose
from tagalong.slam.local.held_scans import Due
from tagalong.slam.local.hypothesis_matching import Look, Rival
from tagalong.slam.local.local_slam import LocalSlam, LocalSlamConfig
from tagalong.slam.local.second_place import SecondPlace
from tagalong.slam.local.switching_motion import MotionHypothesis, SwitchingMotion
from tagalong.slam.scan_to_grid.extrapolator import ExtrapolatorConfig, Prediction
from tagalong.slam.scan_to_grid.scan_matcher import GridMatch
from walls import cast

WALLS = np.array([[-4.0, -3.0, 5.0, -3.0], [5.0, -3.0, 5.0, 4.0], [5.0, 4.0, -4.0, 4.0], [-4.0, 4.0, -4.0, -3.0]])
BEARINGS = np.deg2rad(np.arange(-135.0, 135.0, 0.75))
ASIDE = np.array([0.0, 0.6, 0.0])


def fits(pose, score=0.6):
    """Return a match that tells its place to a centimetre."""
    return GridMatch(np.array(pose), 1e4 * np.eye(3), score, False)


def guess(pose, sound=True, cost=0.0):
    """Return a hypothesis that the robot is at `pose`, to 5 cm."""
    return MotionHypothesis(np.array(pose), Prediction(np.array(pose), np.array([0.05, 0.02])), cost, sound)


def look(at, cost, rival=None):
    """Return that a scan fits `at` a place, at a `cost`."""
    hypotheses = [guess(at), guess(at, sound=False)]
    return Look(np.zeros((9, 2)), hypotheses, guess(at), fits(at), -np.inf, False, cost, rival, 0)


def second_place(behind=1.0, sound=False):
    """Return that a robot two metres on may be aside of there, and the motion that it has if it is not."""
    motion = SwitchingMotion(ExtrapolatorConfig())
    for x in (0.0, 1.0, 2.0):
        hypotheses = motion.predict(np.array([x, 0.0, 0.0]), x)
        motion.take(hypotheses, hypotheses[0], np.array([x, 0.0, 0.0]), None)
    rival = Rival(guess(ASIDE, sound), fits(ASIDE), behind)
    return SecondPlace(motion.copy(), look((2.0, 0.0, 0.0), 5.0, rival)), motion


def weighed(second, *costs, at=ASIDE):
    """Return whether the robot is rather at a second place, and whether that is over, after scans of two `costs`."""
    for first, here in costs:
        second.weigh(look((2.0, 0.0, 0.0), first), look(at, here))
    return second.is_likelier, second.is_over


def test_what_one_scan_leaves_open_the_next_decide():
    second, _ = second_place()
    assert weighed(second, (5.0, 2.0)) == (False, False)
    assert weighed(second, (5.0, 2.0)) == (True, False)


def test_a_place_that_falls_behind_is_given_up():
    second, _ = second_place()
    assert weighed(second, (2.0, 8.0)) == (False, False)
    assert weighed(second, (2.0, 8.0)) == (False, True)


def test_what_five_scans_do_not_decide_is_given_up():
    second, _ = second_place()
    assert weighed(second, *[(2.0, 2.0)] * 4) == (False, False)
    assert weighed(second, (2.0, 2.0)) == (False, True)


def test_two_places_that_have_become_one_are_one():
    second, _ = second_place()
    assert weighed(second, (9.0, 1.0), at=np.array([2.0, 0.05, 0.0])) == (False, True)


@pytest.mark.parametrize("sound", [False, True])
def test_the_robot_of_the_second_place_is_there_and_the_first_stays_where_it_is(sound):
    second, first = second_place(sound=sound)
    assert second.motion.pose.tolist() == ASIDE.tolist()
    assert (second.motion.soundness.probability > 0.5) == sound
    assert first.pose.tolist() == [2.0, 0.0, 0.0]
    second.follow(look(compose(ASIDE, [1.0, 0.0, 0.0]), 2.0))
    assert second.motion.pose[:2].tolist() == [1.0, 0.6]


def rivals(fit=0.6, at=ASIDE, cost=9.0, chosen=0.1, sound=False):
    """Return the rival of a place where a scan fits by `chosen`: one where it fits by `fit`."""
    slam = LocalSlam(LocalSlamConfig())
    slam._matcher.believe(fits((0.0, 0.0, 0.0)))
    here, there = (guess((0.0, 0.0, 0.0)), fits((0.0, 0.0, 0.0), chosen)), (guess(at, sound, cost), fits(at, fit))
    least = slam._matching._best([here], 20)[0].cost_at(here[1].pose, here[1].told) + slam._matcher.cost(here[1], 20)
    return slam._matching._rival([here, there], here, least, 20)


def test_a_rival_explains_the_scan_better_and_is_not_far_less_likely():
    rival = rivals()
    assert rival is not None
    assert rival.match.pose.tolist() == ASIDE.tolist()
    assert 0.0 < rival.behind < 4.0
    assert rivals(cost=13.0) is None  # it would have to have moved too oddly
    assert rivals(fit=0.2) is None  # it explains the scan badly
    assert rivals(chosen=0.5, cost=5.0) is None  # it explains the scan hardly better
    assert rivals(at=(0.05, 0.0, 0.0)) is None  # it is the same place
    assert rivals(sound=True) is None  # odometry is believed at either place


def test_a_robot_is_put_where_scan_after_scan_fits(monkeypatch):
    slam, rng = LocalSlam(LocalSlamConfig()), np.random.default_rng(0)
    poses = [np.array([-2.0 + 0.2 * k, 0.0, 0.0]) for k in range(16)]
    for pose in poses[:10]:
        slam.update(pose, cast(WALLS, pose, rng, bearings=BEARINGS))
    first = slam._motion

    def contested(motion, _scan, points, hypotheses):
        at, begins = hypotheses[0].prediction.pose, slam._second is None
        there = compose(at, ASIDE)
        rival = Rival(guess(there, sound=False), fits(there), 1.0) if begins else None
        cost = 9.0 if motion is first else 6.0
        return Look(points, hypotheses, hypotheses[0], fits(at), -np.inf, False, cost, rival, 0)

    monkeypatch.setattr(slam._matching, "match", contested)
    results = [slam.update(pose, cast(WALLS, pose, rng, bearings=BEARINGS)) for pose in poses[10:13]]
    aside = [result.pose[1] for result in results]
    assert aside == pytest.approx([0.0, 0.0, 0.6], abs=0.02)
    assert [result.odometry_fault for result in results] == [False, False, True]
    assert slam._motion is not first
    assert slam._second is None


def test_it_is_not_followed_over_a_bridge_nor_into_another_map():
    slam = LocalSlam(LocalSlamConfig())
    scan, second = cast(WALLS, np.zeros(3), np.random.default_rng(0)), second_place()[0]
    slam._second = second
    over = Due(ASIDE, scan, bridge=[(1.0, Prediction(ASIDE, np.array([0.1, 0.1])))])
    assert slam._second_thought(over, look(ASIDE, 1.0)) is None
    assert slam._second is None
    slam._second = second
    slam._leave_map()
    assert slam._second is None


def test_a_scan_that_fits_nowhere_costs_as_much_as_one_of_which_nothing_is_known():
    slam, rng = LocalSlam(LocalSlamConfig()), np.random.default_rng(0)
    for x in (-0.2, -0.1, 0.0):
        slam.update(np.array([x, 0.0, 0.0]), cast(WALLS, np.array([x, 0.0, 0.0]), rng, bearings=BEARINGS))
    elsewhere = cast(0.3 * WALLS, np.zeros(3), rng, bearings=BEARINGS)
    there = slam._looked(elsewhere, slam._motion, slam._motion.predict(np.zeros(3), 1.0))
    assert there.cost == slam._matching._nowhere(slam._matcher.independent(there.points))
