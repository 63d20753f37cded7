"""The card of the shipped follower is made of figures, by a command, and of nothing else."""

import json
from dataclasses import replace

import pytest
from tagalong.agents.learned import PilotConfig, pilot_config
from tagalong.scripts.training import ship_follower


def part(episodes, learned, pid, jerk=1.0, off=0.2, maps=None):
    """One suite of a comparison, each follower's endings by name; PID's jerk is 2.5, its error 0.4, its maps' 0.03."""
    figures = {
        who: {
            "endings": endings,
            "jerk_rms_mps3": {"mean": a},
            "distance_error_rms_m": {"mean": b},
            "adnn_truth_to_map_m": {"mean": None if maps is None else c, "n": 0 if maps is None else episodes},
        }
        for who, endings, a, b, c in (("learned", learned, jerk, off, maps), ("pid", pid, 2.5, 0.4, 0.03))
    }
    return {
        "episodes": episodes,
        "figures": figures,
        "paired": {"pid": {"adnn_truth_to_map_m": {"p": 0.271, "n": episodes}}},
    }


SUITES = {
    "office": part(
        40,
        {"tour_done": 36, "leader_lost": 3, "collision_static": 1},
        {"tour_done": 39, "collision_person": 1},
        jerk=1.2,
    ),
    "corridor": part(40, {"tour_done": 40}, {"tour_done": 38, "leader_lost": 2}, jerk=0.8, maps=0.02),
}


def test_the_limits_say_in_words_what_the_figures_show():
    done, lost, smooth, maps = ship_follower.measured_limits(SUITES)
    assert "76 of 80, PID 77: office 36 of 40 (PID 39); corridor 40 of 40 (PID 38)" in done
    assert done.endswith("reached in: corridor.")
    assert "Of the 4 tours" in lost
    assert "in 3; contacts: 1, PID 1" in lost
    assert "0.40 of PID's" in smooth
    assert "0.20 m, PID 0.40 m" in smooth
    assert maps.endswith("[cm]: corridor 2.0 (PID 3.0, p 0.27, 40 episodes); not measured in: office.")
    assert ship_follower.measured_limits({}) == []


@pytest.fixture
def shipped(tmp_path, monkeypatch):
    """A folder of shipped policies with one card, of a network that is told 30 sectors and driven by a narrow guard."""
    card = json.loads((ship_follower.SHIPPED / "follower.json").read_text())
    card["pilot"]["features"]["sectors"], card["pilot"]["guard"]["margin"] = 30, 0.5
    del card["pilot"]["swerve"]
    (tmp_path / "follower.json").write_text(json.dumps({**card, "minutes": 7.0}))
    monkeypatch.setattr(ship_follower, "SHIPPED", tmp_path)
    return tmp_path


def test_a_renewed_card_keeps_the_training_and_takes_the_figures_and_what_surrounds_the_network(shipped, tmp_path):
    (tmp_path / "results.json").write_text(json.dumps({"suites": SUITES}))
    assert ship_follower.main(["--comparison", str(tmp_path)]) == 0
    card = json.loads((shipped / "follower.json").read_text())
    assert card["minutes"] == 7.0
    assert card["suites"] == SUITES
    assert card["suites_command"].endswith("--plot --episodes 40 (--maps: office 0, corridor 40)")
    config = pilot_config(card["pilot"])
    assert config == replace(PilotConfig(), features=replace(PilotConfig().features, sectors=30))


def test_a_runs_policy_is_shipped_with_its_own_card(shipped, tmp_path):
    run = tmp_path / "run"
    run.mkdir()
    (run / "policy.json").write_text(json.dumps({"algorithm": "sac", "preset": "corridor", "seed": 4, "pilot": {}}))
    for name in ("policy.npz", "policy.onnx"):
        (run / name).write_text(name)
    assert ship_follower.main(["--run", str(run)]) == 0
    assert (shipped / "follower.npz").read_text() == "policy.npz"
    card = json.loads((shipped / "follower.json").read_text())
    assert card["command"] == "tagalong train follower --algo sac --preset corridor --seed 4"
    assert card["suites"] == {}
