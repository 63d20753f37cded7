"""Odometry that freezes, catches up, jumps: the robot goes on as it went, and matching decides."""

import numpy as np
import pytest
from tagalong.slam.geometry import between
from tagalong.slam.local.odometry_soundness import OdometrySoundness
from tagalong.slam.local.switching_motion import SwitchingMotion
from tagalong.slam.scan_to_grid.extrapolator import ExtrapolatorConfig
from tagalong.slam.scan_to_grid.scan_matcher import GridMatch

STEP_S = 0.2
CLEAR = np.diag([1e5, 1e5, 1e6])  # information of a scan that tells the place to millimetres


def matched(pose, curvature):
    return GridMatch(pose, curvature, 0.6, False)


def driven(told, truth):
    """Feed a model with odometry `told` (n, 3) and perfect matches at `truth` (n, 3); return it and what it chose."""
    model, chosen = SwitchingMotion(ExtrapolatorConfig()), []
    for k, (odometry, pose) in enumerate(zip(told, truth, strict=True)):
        hypotheses = model.predict(odometry, STEP_S * k)
        costs = [motion.cost_at(pose, CLEAR) for motion in hypotheses]
        best = hypotheses[int(np.argmin(costs))]
        model.take(hypotheses, best, pose, min(costs[:-1] or costs) - costs[-1], matched(pose, CLEAR))
        model.leave_open(np.zeros(2))
        chosen.append(best)
    return model, chosen


def straight(scans, step=0.2):
    """Return (scans, 3) poses along x."""
    return np.stack((step * np.arange(scans), np.zeros(scans), np.zeros(scans)), axis=-1)


def test_sound_odometry_is_the_only_hypothesis():
    model, chosen = driven(straight(20), straight(20))
    assert all(motion.sound for motion in chosen)
    assert model.faults == 0
    np.testing.assert_array_equal(model.odometry, straight(20)[-1])


def test_odometry_that_freezes_and_catches_up_is_not_believed_at_either_end():
    truth, told = straight(30), straight(30)
    told[12:17] = told[11]
    model, chosen = driven(told, truth)
    assert not any(motion.sound for motion in chosen[12:18])
    assert all(motion.sound for motion in chosen[22:])
    np.testing.assert_allclose(between(model.odometry, truth[-1]), 0.0, atol=1e-9)


@pytest.mark.parametrize("jump", [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (-0.5, 0.8, -0.4)])
def test_a_jump_of_the_odometry_moves_nothing_and_its_motions_after_it_are_believed(jump):
    truth, told = straight(30), straight(30)
    told[15:] += jump
    told[15:, :2] = told[15, :2] + (told[15:, :2] - told[15, :2]) @ np.array(
        [[np.cos(jump[2]), np.sin(jump[2])], [-np.sin(jump[2]), np.cos(jump[2])]]
    )
    _, chosen = driven(told, truth)
    assert [k for k, motion in enumerate(chosen) if not motion.sound] == [15]


def test_a_robot_that_stops_is_not_taken_for_frozen_odometry():
    truth = np.concatenate((straight(10), np.repeat(straight(10)[-1:], 10, axis=0)))
    model, _ = driven(truth, truth)
    assert model.faults == 0


def test_a_robot_without_odometry_is_sought_no_farther_than_its_usual_steps_lead():
    model, _ = driven(straight(30), straight(30))
    assert model.anywhere is not None
    np.testing.assert_allclose(model.anywhere.pose, straight(30)[-1])
    assert 0.5 < model.anywhere.sigma[0] < 0.5 + 3.0 * 0.2 + 1e-9


def test_a_gap_in_a_log_is_no_slip():
    told = straight(30)
    told[20:, 0] += 12.0
    model, _ = driven(told[:20], told[:20])
    model.predict(told[20], STEP_S * 20 + 60.0)
    assert model.anywhere is None


def test_stamps_that_hardly_differ_tell_no_velocity():
    model = SwitchingMotion(ExtrapolatorConfig())
    for k, pose in enumerate(straight(5)):
        hypotheses = model.predict(pose, 1e-310 * k)
        assert all(np.array_equal(each.prediction.pose, pose) for each in hypotheses)
        model.take(hypotheses, hypotheses[0], pose, -9.0)


def test_odometry_that_has_caught_up_with_a_robot_of_which_no_scan_told_is_believed():
    """While it stands still there are two hypotheses, from where the robot was seen last; afterwards one again."""
    truth, told = straight(30, step=0.6), straight(30, step=0.6)
    told[12:15] = told[11]
    model, counts = SwitchingMotion(ExtrapolatorConfig()), []
    for k, (odometry, pose) in enumerate(zip(told, truth, strict=True)):
        hypotheses = model.predict(odometry, STEP_S * k)
        counts.append(sum(not motion.sound for motion in hypotheses))
        matched = not 12 <= k < 15
        model.take(
            hypotheses, hypotheses[0], pose if matched else hypotheses[0].prediction.pose, 0.0 if matched else None
        )
        if k == 14:
            np.testing.assert_allclose(hypotheses[-1].prediction.pose, truth[14], atol=1e-9)
    assert counts == [0] * 12 + [1] * 3 + [0] * 15
    assert model.faults == 0


def test_without_stamps_the_robot_goes_on_by_the_scan():
    model, told = SwitchingMotion(ExtrapolatorConfig()), straight(10, step=0.8)
    told[9] = told[8]
    for _k, pose in enumerate(told[:9]):
        hypotheses = model.predict(pose, 0.0)
        model.take(hypotheses, hypotheses[0], pose, -9.0)
    hypotheses = model.predict(told[9], 0.0)
    np.testing.assert_allclose(hypotheses[-1].prediction.pose, [7.2, 0.0, 0.0], atol=1e-9)


def test_stamps_that_jitter_make_no_fault_of_a_robot_that_slows_down():
    """Full ACES log, scan 4087: 0.22 m in 0.12 s, it says, and 0.05 m in 0.36 s."""
    told, stamps = straight(20, step=0.22), STEP_S * np.arange(20.0)
    told[19, 0], stamps[18] = told[18, 0] + 0.05, stamps[18] - 0.08
    model = SwitchingMotion(ExtrapolatorConfig())
    for pose, stamp in zip(told, stamps, strict=True):
        hypotheses = model.predict(pose, stamp)
        assert all(motion.sound for motion in hypotheses)
        model.take(hypotheses, hypotheses[0], pose, -9.0)


@pytest.mark.parametrize("last_s", [0.02, 5.0])
def test_how_far_a_robot_may_speed_up_is_told_by_the_usual_time_between_scans(last_s):
    model, told = SwitchingMotion(ExtrapolatorConfig()), straight(20, step=0.8)
    for k, pose in enumerate(told[:19]):
        hypotheses = model.predict(pose, STEP_S * k)
        model.take(hypotheses, hypotheses[0], pose, -9.0)
    coasting = model.predict(told[18], STEP_S * 18 + last_s)[-1]
    usual, config = STEP_S + 0.1 * (min(last_s, 3.0 * STEP_S) - STEP_S), ExtrapolatorConfig()
    least = [config.sigma(np.array([way, 0.0, 0.0]))[0] for way in (0.0, 0.8)]
    np.testing.assert_allclose(coasting.prediction.pose, told[19], atol=1e-9)
    np.testing.assert_allclose(coasting.prediction.sigma[0], np.linalg.norm([*least, usual**2]))


def test_odometry_whose_predictions_hold_is_taken_for_precise_and_now_and_then_for_as_rough_as_its_model():
    model, _ = driven(straight(120), straight(120))
    ahead = straight(121)[-1]
    precise, rough = model.predict(ahead, STEP_S * 120)
    usual = ExtrapolatorConfig().sigma(np.array([0.2, 0.0, 0.0]))
    np.testing.assert_allclose(rough.prediction.sigma, usual)
    assert np.all(precise.prediction.sigma < 0.3 * usual)
    assert precise.cost_at(ahead, CLEAR) < rough.cost_at(ahead, CLEAR)
    slipped = ahead - [2.0 * usual[0], 0.0, 0.0]  # two standard deviations of the model, ten of this odometry
    assert rough.cost_at(slipped, CLEAR) < precise.cost_at(slipped, CLEAR)


def test_odometry_that_errs_as_its_model_says_is_not_taken_for_precise():
    rng, truth = np.random.default_rng(3), straight(300)
    sigma = ExtrapolatorConfig().sigma(np.array([0.2, 0.0, 0.0]))
    told = np.cumsum(np.diff(truth, axis=0, prepend=0.0) + rng.normal(0.0, sigma[[0, 0, 1]] * [1, 1, 0.2], (300, 3)), 0)
    model, _ = driven(told, truth)
    hypotheses = model.predict(told[-1] + [0.2, 0.0, 0.0], STEP_S * 300)
    assert hypotheses[0].prediction.sigma[0] > 0.75 * sigma[0]


def test_odometry_that_errs_more_than_its_model_says_is_taken_for_as_rough_as_it_is():
    rng, truth = np.random.default_rng(3), straight(300)
    usual = ExtrapolatorConfig().sigma(np.array([0.2, 0.0, 0.0]))
    told = np.cumsum(np.diff(truth, axis=0, prepend=0.0) + rng.normal(0.0, 2.5 * usual[0], (300, 3)) * [1, 1, 0], 0)
    model, chosen = driven(told, truth)
    assert all(motion.sound for motion in model.copy().predict(told[-1] + [0.52, 0.0, 0.0], STEP_S * 300))
    first, rough, *_ = model.predict(told[-1] + [0.2, 0.0, 0.0], STEP_S * 300)
    assert np.all(rough.prediction.sigma >= first.prediction.sigma)
    assert 1.7 * usual[0] < first.prediction.sigma[0] < 3.3 * usual[0]
    assert first.prediction.sigma[1] < 0.3 * usual[1]
    assert np.mean([motion.sound for motion in chosen[100:]]) > 0.9


def test_what_a_scan_cannot_tell_does_not_count_against_a_hypothesis_that_leaves_it_open():
    model, told = driven(straight(30), straight(30))[0], straight(30)[-1]
    sound, *_, fault = model.predict(told, STEP_S * 30)  # frozen
    corridor = np.diag([0.0, 1e5, 1e6])

    def open_costs(information):
        return [motion.cost_at(motion.prediction.pose, information) - motion.cost for motion in (sound, fault)]

    blind = open_costs(np.zeros((3, 3)))
    assert blind == [0.0, 0.0]
    known, along = open_costs(CLEAR), open_costs(corridor)
    assert known[0] < along[0] + known[0] < known[1]
    assert along[1] < known[1] - 2.0  # the fault leaves most of the way open


def test_odometry_that_does_not_move_does_not_recover_and_one_that_thaws_probably_has():
    told = straight(30)
    told[12:20] = told[11]
    model, chosen = driven(told, straight(30))
    assert not any(motion.sound for motion in chosen[12:21])
    soundness = OdometrySoundness()
    soundness.weigh(20.0)
    lost = soundness.probability
    for _ in range(10):
        soundness.advance(moves=False)
    assert soundness.probability <= lost
    soundness.advance(moves=True)
    assert soundness.probability == pytest.approx(0.5, abs=0.01)
    assert model.faults == 9


def test_odometry_that_was_frozen_tells_in_the_end_where_the_robot_went_whatever_matching_made_of_it():
    truth = straight(30)
    told = truth.copy()
    told[12:17] = told[11]
    found = truth.copy()
    found[14:17] = found[13]  # in a corridor, a match fits as well where the robot seems to stand
    model = driven(told[:17], found[:17])[0]
    hypotheses = model.predict(told[17], STEP_S * 17)
    off = [np.abs(between(motion.prediction.pose, truth[17])).max() for motion in hypotheses if motion.sound]
    assert min(off) < 1e-9
    assert off[0] > 0.1  # by the odometry's motion alone


def test_what_odometry_tells_of_the_way_during_a_fault_is_forgotten_once_it_has_been_sound_for_long():
    told = straight(40)
    told[12:] += [1.0, 0.0, 0.0]
    model, chosen = driven(told, straight(40))
    assert [k for k, motion in enumerate(chosen) if not motion.sound] == [12]
    assert len(model.predict(told[-1] + [0.2, 0.0, 0.0], STEP_S * 40)) == 2  # precise, and as rough as the model


def frozen_from(scans, still):
    """Return a model of a robot that drives on while its odometry stands still, before the next scan, and its truth."""
    truth = straight(scans + still + 1)
    told = truth.copy()
    told[scans:] = told[scans - 1]
    return driven(told[:-1], truth[:-1])[0], told, truth


def test_odometry_that_stands_still_has_not_caught_up():
    model, told, _ = frozen_from(12, 4)
    *sound, fault = model.predict(told[-1], STEP_S * 16)
    assert not fault.sound
    for motion in sound:
        np.testing.assert_allclose(motion.prediction.pose, sound[0].prediction.pose, atol=1e-9)


def test_after_a_pause_a_robot_without_odometry_goes_on_by_the_scan():
    model, told, truth = frozen_from(12, 4)
    fault = model.predict(told[-1], STEP_S * 15 + 60.0)[-1]
    assert not fault.sound
    np.testing.assert_allclose(fault.prediction.pose, truth[-1], atol=1e-6)


def test_a_match_after_which_nothing_agrees_with_the_odometry_does_not_make_it_sound():
    model, told, truth = frozen_from(12, 4)
    for k in range(16, 26):  # so long without a match that it is not known any more how the robot went
        hypotheses = model.predict(told[-1], STEP_S * k)
        model.take(hypotheses, hypotheses[0], hypotheses[0].prediction.pose, None)
    hypotheses = model.predict(told[-1], STEP_S * 26)
    assert all(motion.sound for motion in hypotheses)
    model.take(hypotheses, hypotheses[0], truth[-1], -5.0)
    assert model.predict(told[-1], STEP_S * 27)[0].cost > hypotheses[0].cost - 0.1


def test_a_rougher_guess_is_needless_where_the_match_of_the_precise_one_asked_for_no_more_room():
    model = driven(straight(60), straight(60))[0]
    precise, rough = model.predict(straight(61)[-1], STEP_S * 60)
    near, far = straight(61)[-1], straight(61)[-1] + [0.05, 0.0, 0.0]
    assert rough.is_needless(precise, near)
    assert not rough.is_needless(precise, far)


def test_no_wheels_lead_to_a_place_that_only_looks_alike():
    model, _ = driven(straight(30, step=1.0), straight(30, step=1.0))
    model.predict(straight(31, step=1.0)[-1], STEP_S * 30)

    def cost(x, y, turn=0.0):
        pose = np.array([x, y, turn])
        return model.found(pose).cost_at(pose, CLEAR)

    stood, went = cost(29.0, 0.0), cost(30.0, 0.0)
    assert stood == pytest.approx(went)
    assert cost(30.3, 0.1, 0.1) < went + 1.0  # a slip
    assert cost(29.5, 0.0) < went + 1.0  # the wheels held only half of the way
    assert cost(30.0, 4.0) > went + 15.0  # the next room
    assert cost(26.0, 0.0) > went + 8.0
    assert cost(30.0, 0.0, 2.0) > went + 15.0


def test_what_was_before_a_fault_is_forgotten_with_the_first_scan_that_tells():
    truth, told = straight(30), straight(30)
    told[15:] += np.array([0.0, 3.0, 0.0])  # a jump that is never taken back
    model, _ = driven(told[:17], truth[:17])
    assert len(model.predict(told[17] + np.array([0.0, 0.5, 0.0]), STEP_S * 17)) <= 3
    assert model._before is None


@pytest.mark.parametrize(("pause_s", "gap"), [(60.0, True), (STEP_S, False)])
def test_after_a_gap_no_place_around_the_last_match_counts_and_a_jump_without_time_is_a_fault(pause_s, gap):
    """ACES with a tenth of its scans missing: thirty metres on, a scan fitted best where the robot had been before."""
    told = straight(32)
    told[20:, 0] += 12.0
    model, _ = driven(told[:20], told[:20])
    for k in (20, 21):  # the first scan after it tells nothing
        hypotheses = model.predict(told[k], STEP_S * k + pause_s)
        assert all(motion.sound for motion in hypotheses) == gap
        assert (model.anywhere is None) == gap
        model.take(hypotheses, hypotheses[0], hypotheses[0].prediction.pose, None)
    for k in range(22, 32):  # and those after that do
        hypotheses = model.predict(told[k], STEP_S * k + pause_s)
        model.take(hypotheses, hypotheses[0], told[k], 0.0)
    assert model.anywhere is not None


@pytest.mark.parametrize(("pause_s", "way"), [(20.0, 20.0), (4.0, 12.2)])
def test_over_a_gap_a_robot_may_have_driven_as_far_as_it_usually_does_in_that_time(pause_s, way):
    told = straight(32)
    told[20:, 0] += 12.0
    model, _ = driven(told[:20], told[:20])
    before, speed = model.driven, straight(2)[1, 0] / STEP_S
    assert before == pytest.approx(19 * STEP_S * speed)
    model.predict(told[20], STEP_S * 20 + pause_s)
    assert model.driven - before == pytest.approx(max(speed * (pause_s + STEP_S), told[20, 0] - told[19, 0]), rel=0.15)
    assert model.copy().driven == model.restarted(told[20], told[20]).driven == model.driven


def test_a_robot_that_stands_drives_nowhere():
    model, _ = driven(straight(20), straight(20))
    before, place = model.driven, straight(20)[-1]
    for k in range(20, 60):
        hypotheses = model.predict(place, STEP_S * k)
        model.take(hypotheses, hypotheses[0], place, -9.0)
    assert model.driven == before


def test_without_stamps_a_way_beyond_all_usual_ones_is_a_gap():
    told, model = straight(21), SwitchingMotion(ExtrapolatorConfig())
    told[20, 0] += 12.0
    for pose in told[:20]:
        hypotheses = model.predict(pose, 0.0)
        model.take(hypotheses, hypotheses[0], pose, -9.0)
    assert all(motion.sound for motion in model.predict(told[20], 0.0))


def test_a_copy_of_the_motion_learns_nothing_from_what_comes_after():
    model, _ = driven(straight(30), straight(30))
    before, reach = model.copy(), model.anywhere.sigma[0]
    for k in range(30, 40):
        pose = np.array([straight(30)[-1, 0] + 1.0 * (k - 29), 0.0, 0.0])
        hypotheses = model.predict(pose, STEP_S * k)
        model.take(hypotheses, hypotheses[0], pose, -9.0)
    assert model.anywhere.sigma[0] > reach + 0.5
    assert before.anywhere.sigma[0] == reach


def test_a_way_of_many_scans_without_a_match_is_no_gap():
    model, told = SwitchingMotion(ExtrapolatorConfig()), straight(30)
    for k, pose in enumerate(told):
        hypotheses = model.predict(pose, STEP_S * k)
        matched = k < 20
        model.take(hypotheses, hypotheses[0], pose, -9.0 if matched else None)
        assert model.anywhere is not None or k == 0
