"""The error model of the tracker: what fits it finds what it was made of; the command writes what environments read."""

import json

import gymnasium as gym
import numpy as np
import pytest
from tagalong.scripts.cli import main
from tagalong.scripts.training import tracker_errors
from tagalong.scripts.training.tracker_drives import DriveSetting
from tagalong.scripts.training.tracker_fit import TOO_FEW, correlation_s, mean_weights, rate_weights


def sights(rng, count):
    """How `count` people are seen, how far their tracks are off, for how long they were seen, and the way come."""
    return np.column_stack(
        (rng.uniform(0.5, 8.0, count), rng.uniform(0.0, 2.0, count), rng.random(count), rng.random(count) < 0.2,
         rng.uniform(0.0, 2.0, count), rng.uniform(0.0, 0.5, count), rng.uniform(0.0, 0.3, count),
         rng.uniform(0.0, 5.0, count), rng.uniform(0.0, 0.5, count))
    )  # fmt: skip


def test_weights_of_a_rate_are_found_again():
    rng, made = np.random.default_rng(0), np.array([-1.0, -0.2, 0.6, -2.0, -0.5, 0.3, 2.0, 1.0, -0.3, 1.5])
    rows = sights(rng, 160_000)
    rate = np.exp(made[0] + rows @ made[1:])
    found = rate_weights(rows, rng.random(len(rows)) < 1.0 - np.exp(-0.1 * rate), 0.1)
    assert found == pytest.approx(made, abs=0.5)
    assert np.exp(found[0] + rows @ found[1:]).mean() == pytest.approx(rate.mean(), rel=0.05)


def test_weights_of_a_mean_are_found_again():
    rng, made = np.random.default_rng(0), np.array([-4.0, 0.1, -0.3, 1.0, 0.0, 0.2, 0.5, 0.0, 0.0, 0.0])
    rows = sights(rng, 20_000)
    found = mean_weights(rows, rng.exponential(np.exp(made[0] + rows @ made[1:])))
    assert found == pytest.approx(made, abs=0.2)


def test_a_correlation_time_is_found_again():
    class Drive:
        phase, dt = np.ones((20_000, 1), dtype=int), 0.1

    rng, error = np.random.default_rng(0), np.zeros((20_000, 1, 2))
    for k in range(1, len(error)):
        error[k] = np.exp(-0.1 / 0.4) * error[k - 1] + rng.normal(0.0, 1.0, 2)
    assert correlation_s([Drive()], lambda drive: error) == pytest.approx(0.4, rel=0.1)  # pyright: ignore


def test_the_command_writes_numbers_that_an_environment_reads(tmp_path, capsys, monkeypatch):
    here = (DriveSetting(name="corridor", env="Corridor", arguments={"people_count": 3, "beams": 180}),)
    monkeypatch.setattr(tracker_errors, "FITTED", here)
    monkeypatch.setattr(tracker_errors, "CHECKED", here)
    words = ["train", "tracker-errors", "--seeds", "1", "--check-seeds", "2", "--steps", "120", "--out", str(tmp_path)]
    assert main(words) == 0
    assert "tours done" in capsys.readouterr().out
    path = tmp_path / "tracker_errors.json"
    card = json.loads(path.read_text())
    assert card["command"] == "tagalong train tracker-errors --seeds 1 --check-seeds 2 --steps 120"
    born = card["errors"]["weights"]["born_per_s"]
    assert born["way_m"] != 0.0
    assert born["off_m"] == born["seen_log2"] == 0.0
    env = gym.make("tagalong/Corridor-v0", people="modelled", slam=None, tracker_errors=str(path), beams=90)
    env.reset(seed=0)
    env.step(np.zeros(2))
    env.close()
    assert main(["train", "tracker-errors", "--seeds", "0", "--out", str(tmp_path)]) == 2


def test_drives_on_which_nobody_is_lost_are_told_to_be_too_few(tmp_path, capsys):
    words = ["train", "tracker-errors", "--seeds", "1", "--check-seeds", "1", "--steps", "3"]
    assert main([*words, "--out", str(tmp_path / "out")]) == 2
    said = [line for line in capsys.readouterr().err.splitlines() if line.startswith("tagalong: ")]
    assert said == [f"tagalong: {TOO_FEW}"]
    assert not (tmp_path / "out").exists()
