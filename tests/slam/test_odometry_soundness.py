"""How often odometry fails is learned: wheels that slip once slip again."""

from copy import copy

import numpy as np
import pytest
from tagalong.slam.local.odometry_soundness import OdometrySoundness
from tagalong.slam.local.switching_motion import SwitchingMotion
from tagalong.slam.scan_to_grid.extrapolator import ExtrapolatorConfig

FAULT, SOUND = 20.0, -20.0
"""Leads of a fault over sound odometry that leave no doubt."""


def fails(soundness):
    """Return the probability that sound odometry fails with the next scan."""
    soundness = copy(soundness)
    soundness.probability = 1.0
    soundness.advance(moves=True)
    return 1.0 - soundness.probability


def after(leads):
    """Return what is thought of an odometry after matches with such `leads`."""
    soundness = OdometrySoundness()
    for lead in leads:
        soundness.advance(moves=True)
        soundness.weigh(lead)
    return soundness


def test_beforehand_one_scan_of_a_thousand_is_thought_to_fail():
    assert fails(OdometrySoundness()) == pytest.approx(0.001, rel=0.01)


def test_wheels_that_slip_are_expected_to_slip_again():
    assert fails(after(([FAULT] + 19 * [SOUND]) * 10)) == pytest.approx(10.2 / 400.0, rel=0.01)


def test_odometry_that_never_failed_is_disbelieved_less_easily():
    assert fails(after(200 * [SOUND])) == pytest.approx(0.2 / 400.0, rel=0.01)


def test_a_fault_of_many_scans_is_one_failure():
    assert fails(after(10 * [FAULT])) == pytest.approx(1.2 / 210.0, rel=0.01)


def test_a_robot_that_begins_anew_is_believed_and_how_often_its_odometry_fails_stays_known():
    motion, pose = SwitchingMotion(ExtrapolatorConfig()), np.zeros(3)
    motion.predict(pose, 0.0)
    motion.soundness = after([FAULT, SOUND, FAULT])
    anew = motion.restarted(pose, pose)
    assert anew.soundness.probability == 1.0
    assert fails(anew.soundness) == fails(motion.soundness)
    assert motion.soundness.probability < 0.5
    anew.soundness.weigh(FAULT)
    assert anew.soundness.probability < 0.5
