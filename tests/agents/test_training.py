"""Training of followers: adapter, networks, a toy task, resuming after a kill. Needs the extra `learn`."""

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason='training needs the extra "learn"')
pytest.importorskip("sb3_contrib", reason='training needs the extra "learn"')

from gymnasium import spaces  # noqa: E402
from stable_baselines3 import PPO  # noqa: E402
from stable_baselines3.common.vec_env.base_vec_env import VecEnv  # noqa: E402
from tagalong.agents.learned.follower import load_policy  # noqa: E402
from tagalong.agents.learned.network import Network  # noqa: E402
from tagalong.agents.learned.pilot import Pilot, PilotConfig  # noqa: E402
from tagalong.agents.training.curriculum import HELD_OUT_SEED, Curriculum, CurriculumConfig, held_out  # noqa: E402
from tagalong.agents.training.drives import DriveTask, drive  # noqa: E402
from tagalong.agents.training.models import actor_parts, arrays_of, make_model, mean_output  # noqa: E402
from tagalong.agents.training.onnx_graph import to_onnx  # noqa: E402
from tagalong.agents.training.presets import ImitationConfig, ReinforcementConfig, make_preset  # noqa: E402
from tagalong.agents.training.rewards import RewardWeights, TrainingReward, nearest_gap  # noqa: E402
from tagalong.agents.training.run import RunConfig, TrainingRun  # noqa: E402
from tagalong.agents.training.vec_env import FollowerVecEnv, input_space  # noqa: E402
from tagalong.envs.follow_env import FollowEnv  # noqa: E402
from tagalong.envs.interface import FollowInterface  # noqa: E402
from tagalong.slam.errors import InputError  # noqa: E402

EASY = {"slam": None, "beams": 360, "people": "truth"}
CORRIDOR = CurriculumConfig(scenes=(("corridor", 1.0),), bystanders=(0,))


def tiny(**changes):
    preset = replace(
        make_preset("corridor", "ppo"),
        env=EASY,
        fine={},
        curriculum=CORRIDOR,
        imitation=ImitationConfig(rounds=3, drives=2, most_steps=60, epochs=2, last_epochs=2, batch=64),
        reinforcement=ReinforcementConfig(steps=0),
        width=32,
        evaluations=1,
        most_steps=80,
    )
    return replace(preset, **changes)


class Toy(VecEnv):
    """One-step episodes: the reward is highest for the action (vector[0], nearest sector ahead or astern)."""

    def __init__(self, count=16):
        super().__init__(count, input_space(PilotConfig().features), spaces.Box(-1.0, 1.0, (2,), np.float32))
        self._rng = np.random.default_rng(0)

    def _draw(self):
        self._inputs = {
            name: self._rng.uniform(-1.0, 1.0, (self.num_envs, *space.shape)).astype(np.float32)
            for name, space in self.observation_space.spaces.items()
        }
        return {name: value.copy() for name, value in self._inputs.items()}

    def reset(self):
        return self._draw()

    def step_async(self, actions):
        self._actions = actions

    def step_wait(self):
        target = 0.8 * np.stack((self._inputs["vector"][:, 0], np.sign(self._inputs["vector"][:, 1]) * 0.5), axis=1)
        rewards = -np.abs(self._actions - target).sum(axis=1).astype(np.float32)
        infos = [{"terminal_observation": {k: v[i] for k, v in self._inputs.items()}} for i in range(self.num_envs)]
        return self._draw(), rewards, np.ones(self.num_envs, dtype=bool), infos

    def close(self): ...

    def get_attr(self, attr_name, indices=None):
        return [None] * self.num_envs

    def set_attr(self, attr_name, value, indices=None): ...

    def env_method(self, method_name, *args, indices=None, **kwargs):
        return [None] * self.num_envs

    def env_is_wrapped(self, wrapper_class, indices=None):
        return [False] * self.num_envs


def mean_reward(model, toy):
    observations, total = toy.reset(), []
    for _ in range(20):
        actions, _ = model.predict(observations, deterministic=True)
        toy.step_async(actions)
        observations, rewards, _, _ = toy.step_wait()
        total.append(rewards.mean())
    return np.mean(total)


def test_a_toy_task_is_learned_in_seconds():
    toy = Toy()
    preset = tiny(reinforcement=ReinforcementConfig(rollout=32, num_envs=16, learning_rate=3e-3, gamma=0.0))
    model = make_model(preset, toy, seed=0, log=None)
    before = mean_reward(model, toy)
    model.learn(16 * 32 * 6)
    assert mean_reward(model, toy) > 0.8 * before  # rewards are negative
    assert isinstance(model, PPO)


@pytest.mark.parametrize("algo", ["ppo", "sac", "recurrent-ppo"])
def test_numpy_torch_and_onnx_give_the_same_actions(algo):
    runtime = pytest.importorskip("onnxruntime")
    preset = replace(make_preset("office-map", algo), width=32)
    toy = Toy(2)
    toy.observation_space = input_space(preset.pilot.features)
    model = make_model(preset, toy, seed=1, log=None)
    extractor = actor_parts(model)[0]
    rng = np.random.default_rng(0)
    shapes = preset.pilot.features.shapes
    means = {f"{name}.mean": rng.normal(size=shapes[name]) for name in ("scan", "vector")}
    extractor.set_statistics({**means, **{k.replace("mean", "deviation"): 1.0 + v**2 for k, v in means.items()}})
    arrays = arrays_of(model)
    network = Network(arrays)
    session = runtime.InferenceSession(to_onnx(arrays, shapes).SerializeToString())
    memory = {name: np.zeros((1, 32), dtype=np.float32) for name in ("hidden", "cell")} if network.recurrent else {}
    states = None
    for step in range(5):
        inputs = {name: rng.normal(size=shape).astype(np.float32) for name, shape in shapes.items()}
        ours = network(inputs)
        if network.recurrent:
            starts = np.array([step == 0])
            theirs, states = model.predict(inputs, state=states, episode_start=starts, deterministic=True)
        else:
            theirs, _ = model.predict(inputs, deterministic=True)
        by_onnx, *rest = session.run(None, {**{k: v[None] for k, v in inputs.items()}, **memory})
        memory = dict(zip(memory, rest, strict=True))
        assert ours == pytest.approx(theirs, abs=1e-5)
        assert by_onnx[0] == pytest.approx(theirs, abs=1e-5)


@pytest.fixture(scope="module")
def adapter():
    curriculum = Curriculum(CORRIDOR, 5)
    env = FollowerVecEnv(2, 1, EASY, PilotConfig(), RewardWeights(), curriculum, max_episode_steps=12)
    yield env
    env.close()


def test_the_adapter_drives_as_a_single_environment_does(adapter):
    inputs = adapter.reset()
    drawn = Curriculum(CORRIDOR, 5)
    singles = [FollowEnv(**EASY), FollowEnv(**EASY)]
    pilots = [Pilot(PilotConfig(), env.interface) for env in singles]
    first = []
    for env, pilot in zip(singles, pilots, strict=True):
        one = drawn.draw()
        observation, _ = env.reset(seed=one.seed, options=one.options)
        first.append(pilot.inputs(observation))
    rng = np.random.default_rng(0)
    for step in range(12):
        assert all((inputs[name][i] == first[i][name]).all() for i in range(2) for name in inputs)
        actions = rng.uniform(-1.0, 1.0, (2, 2))
        inputs, rewards, dones, infos = adapter.step(actions)
        first = []
        for i, (env, pilot) in enumerate(zip(singles, pilots, strict=True)):
            observation, *_ = env.step(pilot.drive(actions[i]))
            first.append(pilot.inputs(observation))
            assert rewards[i] == pytest.approx(sum(infos[i]["reward_terms"].values()), abs=1e-5)
        assert dones.all() == (step == 11)
    for i in range(2):  # the end is told, and the next episode has begun
        assert infos[i]["TimeLimit.truncated"] is True
        assert infos[i]["episode"]["l"] == 12
        assert all((infos[i]["terminal_observation"][name] == first[i][name]).all() for name in inputs)
        assert any((inputs[name][i] != first[i][name]).any() for name in inputs)


def test_the_adapter_keeps_to_its_spaces_and_shares_no_memory(adapter):
    inputs = adapter.reset()
    kept = {name: value.copy() for name, value in inputs.items()}
    adapter.step(np.zeros((2, 2)))
    assert all((inputs[name] == kept[name]).all() for name in inputs)
    for name, value in inputs.items():
        assert value.shape == (2, *adapter.observation_space[name].shape)
        assert value.dtype == np.float32


def test_training_never_draws_a_held_out_seed_nor_an_untrained_style():
    config = CurriculumConfig()
    curriculum = Curriculum(config, 0)
    drawn = [curriculum.draw() for _ in range(300)]
    assert max(one.seed for one in drawn) < HELD_OUT_SEED <= min(one.seed for one in held_out(config, 9))
    assert {one.options["leader_style"] for one in drawn} == {"steady", "waits"}
    assert max(one.options["people"] for one in drawn) <= 1 + config.bystanders[0]


def test_done_tours_lead_to_the_next_level_and_a_restored_curriculum_goes_on():
    curriculum = Curriculum(CurriculumConfig(), 0)
    for _ in range(30):
        curriculum.report(True)
    assert curriculum.level == 1
    curriculum.draw()
    other = Curriculum(CurriculumConfig(), 0)
    other.restore(json.loads(json.dumps(curriculum.state())))
    assert other.draw() == curriculum.draw()


def test_reward_terms_are_what_their_table_says():
    reward = TrainingReward(RewardWeights(), FollowInterface())
    scan = np.ones(1081, dtype=np.float32)
    own = {"distance": 0.7, "facing": 0.1, "lost": -0.2, "personal_space": -0.5, "collision": 0.0, "tour": 20.0}
    terms = reward.terms(own, {"scan": scan}, (0.5, 0.2, 0.0, 0.0), 0.25)
    assert terms["in_sight"] == pytest.approx(-0.4)
    assert terms["personal_space"] == pytest.approx(-1.5)
    assert terms["smoothness"] == pytest.approx(-0.02 * 0.04)
    assert terms["clearance"] == 0.0
    assert terms["map"] == pytest.approx(5.0)
    assert nearest_gap(np.array([[0.275 + 0.3, 0.26 + 0.4]])) == pytest.approx(0.5)


def test_the_teacher_follows_through_the_corridor():
    task = DriveTask(drawn=Curriculum(CORRIDOR, 1).draw(), env=EASY, pilot=PilotConfig(), most_steps=250)
    result = drive(task)
    assert result.ending in ("", "tour_done")
    assert result.total_reward > 200.0
    assert len(result.labels) == result.steps == len(result.inputs["vector"])


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A tiny run from beginning to end: its folder, its progress, and the lines that it told."""
    folder, lines = tmp_path_factory.mktemp("whole"), []
    return folder, TrainingRun(RunConfig(preset=tiny(), name="tiny"), folder, lines.append).train(), lines


def test_imitation_lowers_the_error_and_the_exported_policy_drives(whole):
    folder, progress, lines = whole
    errors = [float(line.rsplit(" ", 1)[1]) for line in lines if "error" in line]
    assert errors[-1] < 0.8 * errors[0]
    assert len(progress.evaluations) == 3
    arrays, config = load_policy(folder)
    inputs = {name: np.zeros(shape, np.float32) for name, shape in config.features.shapes.items()}
    assert Network(arrays)(inputs).shape == (2,)
    with pytest.raises(InputError, match="other settings"):
        TrainingRun(RunConfig(preset=tiny(width=16), name="tiny"), folder, lines.append)


CHILD = """
import sys
sys.path.insert(0, {tests!r})
from pathlib import Path
from test_training import tiny
from tagalong.agents.training.run import RunConfig, TrainingRun
if __name__ == "__main__":
    TrainingRun(RunConfig(preset=tiny(), name="tiny"), Path({folder!r}), print).train()
"""


def test_a_killed_run_goes_on_and_its_evaluations_are_those_of_an_undisturbed_one(tmp_path, whole):
    code = CHILD.format(tests=os.path.dirname(__file__), folder=str(tmp_path / "killed"))
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.DEVNULL)
    index = tmp_path / "killed" / "checkpoint.json"
    deadline = time.monotonic() + 120.0
    while not index.is_file() and child.poll() is None and time.monotonic() < deadline:
        time.sleep(0.02)
    child.send_signal(signal.SIGKILL)
    child.wait()
    assert index.is_file()
    resumed = TrainingRun(RunConfig(preset=tiny(), name="tiny"), tmp_path / "killed", lambda line: None).train()
    assert resumed.evaluations == whole[1].evaluations


def test_reinforcement_goes_on_from_its_checkpoint(tmp_path):
    config = ReinforcementConfig(steps=64, num_envs=2, rollout=16, evaluate_every=100, critic_rollouts=1)
    preset = tiny(imitation=ImitationConfig(rounds=0), reinforcement=config, most_steps=30)
    early = RunConfig(preset=preset, name="tiny", max_minutes=1e-9)
    first = TrainingRun(early, tmp_path, lambda line: None).train()
    assert first.steps == 0
    done = TrainingRun(RunConfig(preset=preset, name="tiny"), tmp_path, lambda line: None).train()
    assert done.rollouts >= 1
    assert len(done.evaluations) == 1
    again = TrainingRun(RunConfig(preset=preset, name="tiny"), tmp_path, lambda line: None)
    assert again.progress.evaluations == done.evaluations
    assert mean_output(
        again._model, {k: torch.zeros(1, *s) for k, s in preset.pilot.features.shapes.items()}
    ).shape == (1, 2)
