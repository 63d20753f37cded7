import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.perception.metrics.clear_mot import ClearMot
from tagalong.scripts.benchmarks.following import judge_following
from tagalong.slam import InputError

OUTDOOR = Path(os.environ.get("TAGALONG_DATA", "")) / "legs" / "person_following_outdoor_1.npz"


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


def test_recordings_without_clicks_are_refused(tmp_path):
    np.savez(tmp_path / "s.npz", ranges=np.ones((2, 9)), angle_min=0, angle_increment=0.1, range_min=0, range_max=9)
    with pytest.raises(InputError, match="needs clicked positions"):
        judge_following(tmp_path / "s.npz", "table2", "real")


@pytest.mark.slow
@pytest.mark.skipif(not OUTDOOR.is_file(), reason="TAGALONG_DATA names no folder with person_following_outdoor_1.npz")
@pytest.mark.parametrize(("preset", "held"), [("table2", 0.80), ("outdoor", 0.96)])
def test_the_person_of_the_outdoor_recording_is_held(preset, held):
    figures = judge_following(OUTDOOR, preset, "real")
    assert figures["held"] >= held
    assert figures["switches"] <= 5
    assert figures["false"] <= 0.02
