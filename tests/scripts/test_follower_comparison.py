"""Followers compared: figures of each, paired tests, and the plot of tours done over jerk."""

import numpy as np
import pytest
from tagalong.scripts.experiments.follower_comparison import FIGURES, compare, draw_trade_off


def rows(follower, jerk, done):
    """One episode for each entry; whatever is not jerk is equal for all."""
    same = dict.fromkeys(FIGURES, 0.5) | {"adnn_truth_to_map_m": None}
    return [
        {"follower": follower, "suite": "office", "episode": k, "ending": "tour_done" if ok else "leader_lost"}
        | same
        | {"jerk_rms_mps3": value}
        for k, (value, ok) in enumerate(zip(jerk, done, strict=True))
    ]


@pytest.fixture
def result():
    rng = np.random.default_rng(0)
    smooth = rows("smooth", rng.normal(1.0, 0.1, 20), [True] * 18 + [False] * 2)
    rough = rows("rough", rng.normal(2.5, 0.1, 21), [True] * 21)
    return compare(smooth + rough, ["smooth", "rough"])


def test_only_episodes_that_all_have_driven_are_compared(result):
    assert result["office"]["episodes"] == 20
    assert result["office"]["figures"]["smooth"]["success"]["mean"] == pytest.approx(0.9)
    assert result["office"]["figures"]["smooth"]["endings"] == {"leader_lost": 2, "tour_done": 18}
    paired = result["office"]["paired"]["rough"]
    assert paired["jerk_rms_mps3"]["p"] < 1e-4
    assert paired["jerk_rms_mps3"]["median_difference"] == pytest.approx(-1.5, abs=0.15)
    assert paired["sparc"]["p"] == 1.0
    assert paired["adnn_truth_to_map_m"]["n"] == 0  # driven without SLAM


def test_the_trade_off_is_drawn(result, tmp_path):
    pytest.importorskip("matplotlib")
    file = draw_trade_off(result, tmp_path / "trade_off.png")
    assert file.stat().st_size > 5000
