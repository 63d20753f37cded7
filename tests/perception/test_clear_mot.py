"""CLEAR MOT on cases with known answers."""

import numpy as np
import pytest
from tagalong.perception.metrics.clear_mot import ClearMot


def test_clear_mot_counts_misses_false_tracks_and_switches():
    judge, truth = ClearMot(), np.array([[0.0, 0.0], [3.0, 0.0]])
    every, ids = np.ones(2, dtype=bool), np.array([4, 5])
    judge.add(truth, every, truth, ids, every)
    judge.add(truth, every, truth[::-1], ids, every)  # both numbers changed hands
    judge.add(truth, every, np.array([[0.1, 0.0], [9.0, 9.0]]), ids[::-1], every)  # one missed, one false
    assert (judge.truths, judge.misses, judge.false, judge.switches) == (6, 1, 1, 2)
    assert judge.mota == pytest.approx(1 - 4 / 6)
    assert judge.motp == pytest.approx(0.02)


def test_a_track_on_a_person_who_does_not_count_is_not_false():
    judge, place = ClearMot(), np.zeros((1, 2))
    judge.add(place, np.array([False]), place, np.array([1]), np.array([True]))
    assert (judge.truths, judge.false) == (0, 0)
