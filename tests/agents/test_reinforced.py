"""Reinforcement on compiled worlds, and the follower that comes of it."""

import json
from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason='training needs the extra "learn"')
pytest.importorskip("stable_baselines3", reason='training needs the extra "learn"')

from tagalong.agents import make_follower  # noqa: E402
from tagalong.agents.learned.steering import SteeringConfig, steer_many  # noqa: E402
from tagalong.agents.reinforced.policy import DenseNetwork, load_reinforced  # noqa: E402
from tagalong.agents.training.worlds.export import policy_arrays  # noqa: E402
from tagalong.agents.training.worlds.pooled_tensors import PooledTensors, as_tensors  # noqa: E402
from tagalong.agents.training.worlds.ppo import Learner, Rollout, log_probability  # noqa: E402
from tagalong.agents.training.worlds.preset import WorldsPreset, preset_for  # noqa: E402
from tagalong.agents.training.worlds.run import EndedEpisodes, WorldsRun, WorldsRunConfig  # noqa: E402
from tagalong.agents.training.worlds.tensor_worlds import TRUTH, Outcome, TensorWorlds, steered  # noqa: E402
from tagalong.envs import CompiledVectorEnv  # noqa: E402
from tagalong.envs.task import FollowInterface  # noqa: E402
from tagalong.envs.wrappers import PooledConfig, PooledVectorObservation  # noqa: E402
from tagalong.slam import InputError  # noqa: E402

KINDS = ({"scene": "corridor", "people": 2}, {"scene": "meeting_room", "people": 2})
TINY = WorldsPreset(
    kinds=KINDS, worlds=5, episodes=8, env={"beams": 90}, steps=80, rollout=4, batch=10, epochs=1, width=8, most_steps=6
)  # fmt: skip


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


def test_the_card_names_the_command_with_all_that_was_set(whole):
    command = json.loads((whole[0] / "policy.json").read_text())["command"]
    assert command == "tagalong train follower --device cpu --seed 0 --steps 80 --set beams=90"


def test_people_are_known_by_the_tracker_where_its_kernels_run():
    assert preset_for("cpu").env["people"] == "tracker"
    assert preset_for("cuda").env["people"] == "modelled"


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


@pytest.mark.parametrize("name", ["", "+guard", "-alone"])
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
    assert (preset.deviation_at(0.0), preset.deviation_at(1.0)) == (preset.deviation, preset.last_deviation)
    assert preset.deviation_at(0.5) ** 2 == pytest.approx(preset.deviation * preset.last_deviation)
    for wrong, told in (
        ({"quick": 0.5}, "`quick` from 1 to 10"),
        ({"kinds": ()}, "at least one kind of episodes"),
        ({"worlds": 0}, "at least one world"),
        ({"last_deviation": 0.0}, "`deviation` >= `last_deviation` > 0"),
        ({"smoothness": -1.0}, "`clearance_speed` and `smoothness` >= 0"),
    ):
        with pytest.raises(InputError, match=told):
            WorldsPreset(**wrong)


def test_who_is_nearer_to_a_thing_or_quicker_there_is_charged_more_and_who_is_far_from_all_nothing():
    worlds = TensorWorlds(TINY, 0, 1, "cpu")
    told, _ = worlds.reset(0)
    costs = []
    for gap, speed in ((0.0, 0.0), (0.15, 0.0), (0.15, 0.5), (0.4, 1.0)):
        told[:, : TINY.pooled.sectors] = np.exp(-gap / TINY.pooled.gap_scale)
        worlds._commanded[:, 0] = -speed
        costs.append(float(worlds._clearance_cost(told)[0]))
    quarter = TINY.clearance / 4.0
    assert costs == pytest.approx([4.0 * quarter, quarter, quarter * (1.0 + 0.5 * TINY.clearance_speed), 0.0], abs=1e-5)
    worlds.close()


def test_a_done_or_cut_tour_is_over_but_not_failed_and_a_contact_is_both(monkeypatch):
    worlds = TensorWorlds(TINY, 0, 1, "cpu")
    worlds.reset(0)
    step = worlds._env.step
    endings = np.array(["tour_done", "collision_static", "leader_lost", "", ""], dtype=object)

    def ended(actions):
        told, reward, _, _, info = step(actions)
        terminated, truncated = endings != "", np.array([False, False, False, True, False])
        return told, reward, terminated.astype(bool), truncated, {**info, "ending": endings}

    monkeypatch.setattr(worlds._env, "step", ended)
    outcome = worlds.step(torch.zeros(5, 2))
    assert outcome.over.tolist() == [True, True, True, True, False]
    assert outcome.failed.tolist() == [False, True, True, False, False]
    assert outcome.begun.tolist() == [False] * 5
    monkeypatch.setattr(worlds._env, "step", step)
    after = worlds.step(torch.ones(5, 2))
    assert after.begun.tolist() == outcome.over.tolist()
    assert after.reward[:4].tolist() == [0.0] * 4
    assert worlds._commanded[:4].abs().max() == 0.0
    worlds.close()


CONFIGS = [PooledConfig(gap_scale=0.5), PooledConfig(stack=3, people=8, actions=0, sectors=50), PooledConfig(people=2)]


@pytest.mark.parametrize("config", CONFIGS, ids=["as trained", "stacked", "few"])
def test_tensors_tell_what_the_wrapper_tells(config):
    count = 6
    given = {"episodes_ahead": 8, "people_count": 4, "beams": 121, "people": "modelled", "scene": "corridor"}
    raw, other = (CompiledVectorEnv(count, workers=1, max_episode_steps=25, **given) for _ in range(2))
    wrapped, tensors = PooledVectorObservation(other, config), PooledTensors(config, raw.interface, count, "cpu")
    (batch, _), (wanted, _) = raw.reset(seed=3), wrapped.reset(seed=3)
    told = tensors.update(as_tensors(batch, "cpu"), torch.zeros(count, 2), torch.ones(count, dtype=torch.bool))
    begun, rng = np.zeros(count, bool), np.random.default_rng(0)
    for _ in range(60):
        assert np.abs(told.numpy() - wanted).max() < 1e-6
        actions = rng.uniform(0.0, 1.0, (count, 2)).astype(np.float32)
        batch, _, terminated, truncated, _ = raw.step(actions)
        wanted = wrapped.step(actions)[0]
        told = tensors.update(as_tensors(batch, "cpu"), torch.as_tensor(actions), torch.as_tensor(begun))
        begun = terminated | truncated
    wrapped.close()


def test_tensors_are_steered_as_arrays_are():
    states, wishes = np.random.default_rng(1).normal(size=(50, 4)), np.random.default_rng(2).normal(size=(50, 2))
    ours = steered(torch.as_tensor(states), torch.as_tensor(wishes), 0.1, SteeringConfig())
    assert ours.numpy() == pytest.approx(steer_many(states, wishes, 0.1, SteeringConfig()), abs=1e-6)


def rollout_of(learner, rewards, over, failed, begun):
    """A rollout of one world in which nothing is told."""
    told, truth = torch.zeros(1, TINY.pooled.size()), torch.zeros(1, TRUTH)
    rollout = Rollout.of(len(rewards), told, truth, 0.5)
    for t, (reward, *flags) in enumerate(zip(rewards, over, failed, begun, strict=True)):
        learner.explore(rollout, t)
        marks = [torch.tensor([bool(flag)]) for flag in flags]
        rollout.put(t, Outcome(told, truth, torch.tensor([reward]), *marks, torch.zeros(1, dtype=torch.long)))
    return rollout


def test_advantages_end_with_an_episode_and_keep_the_value_behind_a_cut():
    learner, gamma, lam = Learner(TINY, 0, "cpu"), TINY.gamma, TINY.gae_lambda
    value = 0.7
    with torch.no_grad():
        learner.model.critic.last.zero_()
        learner.model.critic.last_bias.fill_(value)
    rewards = [1.0, 2.0, 0.0, 4.0]
    for failed in (False, True):
        rollout = rollout_of(learner, rewards, [0, 1, 0, 0], [0, failed, 0, 0], [0, 0, 1, 0])
        advantages = learner._advantages(rollout)[0][:, 0].tolist()
        end = 2.0 + (0.0 if failed else gamma * value) - value
        last = 4.0 + gamma * value - value
        assert advantages[1] == pytest.approx(end, rel=1e-5)
        assert advantages[0] == pytest.approx(1.0 + gamma * value - value + gamma * lam * end, rel=1e-5)
        assert advantages[3] == pytest.approx(last, rel=1e-5)


def test_what_is_rewarded_is_done_more_and_steps_without_a_choice_teach_nothing():
    preset = replace(TINY, worlds=1, rollout=64, batch=64, epochs=8)
    learner = Learner(preset, 0, "cpu")
    told = torch.zeros(1, preset.pooled.size())
    before = learner.model.actor(told).detach().clone()
    for _ in range(12):
        rollout = rollout_of(learner, [0.0] * 64, [1] * 64, [1] * 64, [0, 1] * 32)
        rollout.reward[:] = rollout.outputs[..., 0]
        rollout.reward[1::2] = -10.0 * rollout.outputs[1::2, :, 0]
        figures = learner.learn(rollout, 0.0)
    assert figures["rate"] > 0.0
    assert float((learner.model.actor(told) - before).detach()[0, 0]) > 0.1


def test_outputs_that_change_from_a_step_to_the_next_are_smoothed_but_not_across_episodes():
    learner = Learner(TINY, 0, "cpu")
    now, later = torch.randn(2, 6, TINY.pooled.size(), generator=torch.Generator().manual_seed(1))
    nothing, mean = torch.zeros(6), learner.model.actor(now).detach()

    def change():
        return float((learner.model.actor(now) - learner.model.actor(later)).square().sum().detach())

    def descend(goes_on):
        likely = log_probability(mean, mean, 0.5)
        rest = now, torch.zeros(6, TRUTH), mean, likely, mean, nothing, nothing, later
        for _ in range(30):
            learner._descend([*rest, torch.full((6,), goes_on)], 0.5)

    before = change()
    descend(0.0)
    assert change() == pytest.approx(before, rel=1e-6)
    descend(1.0)
    assert change() < 0.5 * before


def test_a_policy_drives_in_a_mirror_as_it_drives_whatever_its_weights():
    learner = Learner(TINY, 3, "cpu")
    told = torch.randn(4, TINY.pooled.size(), generator=torch.Generator().manual_seed(1))
    with torch.no_grad():
        for weights in learner.model.parameters():
            weights.add_(torch.randn(weights.shape, generator=torch.Generator().manual_seed(2)))
        mirror, truth = TINY.pooled.mirror(), torch.rand(4, TRUTH)
        seen = told[:, list(mirror.order)] * torch.tensor(mirror.signs)
        torch.testing.assert_close(learner.model.actor(seen), learner.model.actor(told) * torch.tensor([1.0, -1.0]))
        torch.testing.assert_close(learner.model.value(seen, truth), learner.model.value(told, truth))
        assert float(learner.model.actor(told).std(dim=0).min()) > 0.1
        exported = DenseNetwork(policy_arrays(learner.model.actor))
        expected = learner.model.actor(told[0]).clamp(-1.0, 1.0).numpy()
        np.testing.assert_allclose(exported(told[0].numpy()), expected, atol=1e-5)


def test_a_policy_that_has_moved_far_already_is_not_moved_further_by_the_same_rollout():
    learner = Learner(TINY, 0, "cpu")
    told = torch.zeros(2, TINY.pooled.size())
    mean = learner.model.actor(told).detach()
    likely, certain = log_probability(mean, mean, 0.5), torch.tensor([1.0, -1.0])
    for ratio, moves in ((torch.tensor([2.0, 0.5]), False), (torch.tensor([0.5, 2.0]), True)):
        learner.optimizer.zero_grad()
        learner._descend(
            [told, torch.zeros(2, TRUTH), mean + 0.1, likely - ratio.log(), mean, certain, torch.zeros(2), told,
             torch.zeros(2)], 0.5,
        )  # fmt: skip
        moved = max(float(p.grad.abs().max()) for p in learner.model.actor.parameters() if p.grad is not None)
        assert (moved > 1e-6) == moves


def test_the_divergence_is_counted_in_deviations():
    learner, told, nothing = (
        Learner(TINY, 0, "cpu"),
        torch.zeros(4, TINY.pooled.size()),
        torch.zeros(4),
    )
    before = learner.model.actor(told).detach() - 0.5
    rest = torch.zeros(4, TRUTH), before, nothing, before, nothing, nothing, told, nothing
    assert learner._descend([told, *rest], 0.25)[0] == pytest.approx(0.5 * 2 * (0.5 / 0.25) ** 2, rel=1e-4)


def test_the_outputs_are_forward_and_turn():
    for output, sign in ((torch.tensor([1.0, 0.0]), (1, 0)), (torch.tensor([-1.0, -1.0]), (-1, -1))):
        worlds = TensorWorlds(TINY, 0, 1, "cpu")
        worlds.reset(0)
        worlds.step(output.repeat(5, 1))
        assert torch.sign(worlds._commanded[0, [0, 2]]).tolist() == list(sign)
        worlds.close()


def test_ended_episodes_are_counted_with_their_own_returns():
    tally, returns = EndedEpisodes.of(torch.device("cpu")), torch.tensor([1.0, 10.0, 100.0])
    over = torch.tensor([True, False, True])
    nothing = torch.zeros(3, dtype=torch.bool)
    told = torch.zeros(3, 1)
    outcome = Outcome(told, told, torch.ones(3), over, nothing, nothing, torch.tensor([3, 0, 0]))
    assert tally.count(outcome, returns).tolist() == [0.0, 11.0, 0.0]
    assert (float(tally.returns), tally.episodes) == (103.0, 2)
    assert tally.endings.tolist()[:4] == [1, 0, 0, 1]


def test_a_run_explores_less_and_less(tmp_path, monkeypatch):
    seen, of = [], Rollout.of
    monkeypatch.setattr(Rollout, "of", staticmethod(lambda *given: seen.append(given[3]) or of(*given)))
    trained(tmp_path)
    assert seen == [TINY.deviation_at(share) for share in (0.0, 0.25, 0.5, 0.75)]


def test_who_moves_too_far_in_a_step_learns_slower_and_who_hardly_moves_faster():
    learner = Learner(TINY, 0, "cpu")
    rate = learner.optimizer.param_groups[0]["lr"]
    learner._adapt_rate(3.0 * TINY.divergence, 1.0)
    assert learner.optimizer.param_groups[0]["lr"] == pytest.approx(rate / 1.5)
    learner._adapt_rate(0.1 * TINY.divergence, 1.0)
    assert learner.optimizer.param_groups[0]["lr"] == pytest.approx(rate)
    learner._adapt_rate(0.1 * TINY.divergence, 0.5 * rate)
    assert learner.optimizer.param_groups[0]["lr"] == pytest.approx(0.5 * rate)


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
