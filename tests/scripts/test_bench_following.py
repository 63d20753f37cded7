"""What `tagalong bench following` says of recordings with a clicked person."""

import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.scripts.benchmarks.following import judge_following
from tagalong.slam import InputError

OUTDOOR = Path(os.environ.get("TAGALONG_DATA", "")) / "legs" / "person_following_outdoor_1.npz"


def test_recordings_without_clicks_are_refused(tmp_path):
    np.savez(tmp_path / "s.npz", ranges=np.ones((2, 9)), angle_min=0, angle_increment=0.1, range_min=0, range_max=9)
    with pytest.raises(InputError, match="needs clicked positions"):
        judge_following(tmp_path / "s.npz", "recorded", "real")


@pytest.mark.slow
@pytest.mark.skipif(not OUTDOOR.is_file(), reason="TAGALONG_DATA names no folder with person_following_outdoor_1.npz")
@pytest.mark.parametrize(("preset", "held", "false"), [("recorded", 0.97, 0.15)])
def test_the_person_of_the_outdoor_recording_is_held(preset, held, false):
    figures = judge_following(OUTDOOR, preset, "real")
    assert figures["held"] >= held
    assert figures["switches"] <= 5
    assert figures["false"] <= false
