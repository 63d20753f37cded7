"""Reinforcement on compiled worlds, and the follower that comes of it."""

import json
from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason='training needs the extra "learn"')
pytest.importorskip("stable_baselines3", reason='training needs the extra "learn"')

from tagalong.agents import make_follower  # noqa: E402
from tagalong.agents.reinforced.policy import load_reinforced  # noqa: E402
from tagalong.agents.training.worlds.preset import WorldKind, WorldsPreset  # noqa: E402
from tagalong.agents.training.worlds.run import WorldsRun, WorldsRunConfig  # noqa: E402
from tagalong.agents.training.worlds.vec_env import WorldsVecEnv  # noqa: E402
from tagalong.envs.task import FollowInterface  # noqa: E402
from tagalong.slam import InputError  # noqa: E402

KINDS = (
    WorldKind(name="corridor", count=3, people=2, episodes=4),
    WorldKind(name="meeting_room", count=2, people=2, episodes=4),
)
TINY = WorldsPreset(kinds=KINDS, env={"beams": 90}, steps=80, rollout=4, batch=10, epochs=1, width=8, most_steps=6)


def trained(folder, preset=TINY, **settings):
    lines = []
    progress = WorldsRun(WorldsRunConfig(preset=preset, **settings), folder, lines.append).train()
    return progress, lines


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    return folder, *trained(folder)


def test_the_same_command_makes_the_same_bytes_with_any_number_of_threads(whole, tmp_path):
    folder, progress, lines = whole
    trained(tmp_path / "again", workers=2)
    for name in ("policy.npz", "policy.safetensors", "policy.json"):
        assert (folder / name).read_bytes() == (tmp_path / "again" / name).read_bytes()
    assert progress.steps == 80
    assert any(line.startswith("80/80 steps: tours done 0.00") for line in lines)


def test_a_run_that_was_stopped_goes_on_with_what_it_had_learned(tmp_path):
    stopped, _ = trained(tmp_path, max_minutes=1e-9)
    assert 0 < stopped.steps < 80
    before = load_reinforced(tmp_path)[0]
    resumed, _ = trained(tmp_path)
    assert resumed.steps >= 80
    assert resumed.rollouts == resumed.steps // 20
    after = load_reinforced(tmp_path)[0]
    assert before.keys() == after.keys()
    assert np.abs(before["layer.0.weight"] - after["layer.0.weight"]).max() < 0.1  # no new beginning
    with pytest.raises(InputError, match="other settings"):
        trained(tmp_path, replace(TINY, width=16))


@pytest.mark.parametrize("name", ["", "+guard"])
def test_what_was_trained_drives_with_and_without_the_safety_filter(whole, name):
    interface = FollowInterface(bearings=np.deg2rad(np.linspace(-135.0, 135.0, 181)))
    follower = make_follower(f"{whole[0]}{name}", interface)
    observation = {
        "scan": np.ones(181, np.float32),
        "leader": np.array([2.0, 0.0, 0.0, 0.0, 1.0, 1.0], np.float32),
        "people": np.zeros((6, 6), np.float32),
        "velocity": np.zeros(2, np.float32),
    }
    follower.reset()
    first = [follower.act(observation) for _ in range(3)]
    follower.reset()
    assert np.array_equal(first, [follower.act(observation) for _ in range(3)])
    assert np.abs(np.diff([[0.0, 0.0], *first], axis=0)).max() < 0.2  # its acceleration is limited


def test_training_begins_with_quick_steering_and_ends_with_that_of_the_card():
    preset = WorldsPreset(quick=2.0)
    first, last = preset.steering_at(0.0), preset.steering_at(1.0)
    assert last == preset.steering
    assert (first.settle_s, first.jerk) == (preset.steering.settle_s / 2.0, preset.steering.jerk * 4.0)
    assert first == preset.steering_at(1.0 / 3.0)
    assert last.settle_s > preset.steering_at(0.5).settle_s > first.settle_s
    with pytest.raises(InputError, match="`quick` from 1 to 10"):
        WorldsPreset(quick=0.5)


def test_who_is_nearer_to_a_thing_is_charged_more_and_who_is_far_from_all_nothing():
    env = WorldsVecEnv(TINY, 0, 1)
    told = env.reset()
    costs = []
    for gap in (0.0, 0.1, 0.3):
        told[:, : TINY.pooled.sectors] = np.exp(-gap / TINY.pooled.gap_scale)
        costs.append(env._clearance_cost(told)[0])
    assert costs == pytest.approx([TINY.clearance, TINY.clearance / 4.0, 0.0], abs=1e-5)
    env.close()


def test_a_done_tour_is_cut_short_and_a_contact_is_an_end(monkeypatch):
    env = WorldsVecEnv(TINY, 0, 1)
    env.reset()
    for part, (ending, success) in zip(env._parts, (("tour_done", True), ("collision_static", False)), strict=True):
        step = part.step

        def ended(actions, step=step, ending=ending, success=success):
            told, rewards, over, cut, info = step(actions)
            over, n = np.ones_like(over), len(over)
            info["final_info"] = {"ending": np.array([ending] * n), "is_success": np.array([success] * n)}
            return told, rewards, over, cut, {**info, "final_obs": told}

        monkeypatch.setattr(part, "step", ended)
    *_, infos = env.step(np.zeros((5, 2)))
    assert [info["TimeLimit.truncated"] for info in infos] == [True] * 3 + [False] * 2
    env.close()


def test_a_card_or_arrays_that_do_not_fit_are_told_in_one_line(whole, tmp_path):
    card = json.loads((whole[0] / "policy.json").read_text())
    (tmp_path / "policy.npz").write_bytes((whole[0] / "policy.npz").read_bytes())
    for change, told in (
        ({"pooled": {**card["pooled"], "sectors": 61}}, "layer 0 must take 124 numbers"),
        ({"pooled": {**card["pooled"], "sectors": 1.5}}, "`pooled.sectors` must be a whole number, got 1.5"),
        ({"steering": None}, "`steering` must hold fields with values"),
        ({"max_speed": -1}, "must be positive"),
    ):
        (tmp_path / "policy.json").write_text(json.dumps({**card, **change}))
        with pytest.raises(InputError, match=told):
            make_follower(str(tmp_path), FollowInterface())
