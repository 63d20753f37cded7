"""Training of followers: adapter, networks, rewards, a toy task. Needs the extra `learn`."""

import json
from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason='training needs the extra "learn"')
pytest.importorskip("sb3_contrib", reason='training needs the extra "learn"')

from small_training import CORRIDOR, EASY, Toy, tiny  # noqa: E402
from stable_baselines3 import PPO  # noqa: E402
from tagalong.agents.learned.network import Network  # noqa: E402
from tagalong.agents.learned.pilot import Pilot, PilotConfig  # noqa: E402
from tagalong.agents.training.curriculum import HELD_OUT_SEED, Curriculum, CurriculumConfig, held_out  # noqa: E402
from tagalong.agents.training.drives import DriveTask, drive  # noqa: E402
from tagalong.agents.training.model_state import arrays_of_model, restore_model, shapes_of_model  # noqa: E402
from tagalong.agents.training.models import actor_parts, arrays_of, make_model  # noqa: E402
from tagalong.agents.training.onnx_graph import to_onnx  # noqa: E402
from tagalong.agents.training.presets import ReinforcementConfig, make_preset  # noqa: E402
from tagalong.agents.training.rewards import RewardWeights, TrainingReward, nearest_gap  # noqa: E402
from tagalong.agents.training.vec_env import FollowerVecEnv, input_space  # noqa: E402
from tagalong.envs import FollowEnv  # noqa: E402
from tagalong.envs.task import FollowInterface  # noqa: E402


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
    assert nearest_gap(np.array([[0.275 + 0.3, 0.259 + 0.4]]), FollowInterface()) == pytest.approx(0.5)


def test_the_teacher_follows_through_the_corridor():
    task = DriveTask(drawn=Curriculum(CORRIDOR, 1).draw(), env=EASY, pilot=PilotConfig(), most_steps=250)
    result = drive(task)
    assert result.ending in ("", "tour_done")
    assert result.total_reward > 200.0
    assert len(result.labels) == result.steps == len(result.inputs["vector"])


@pytest.mark.parametrize("algo", ["ppo", "sac", "recurrent-ppo"])
def test_a_model_goes_on_with_its_optimisers_where_it_was(algo):
    preset = replace(make_preset("office", algo), width=16)
    preset = replace(preset, reinforcement=replace(preset.reinforcement, rollout=8))
    first, second = (make_model(preset, Toy(4), seed=seed, log=None) for seed in (0, 1))
    if algo == "sac":
        first.learning_starts, first.batch_size = 16, 16
    first.learn(64)
    arrays = arrays_of_model(first)
    assert {name: array.shape for name, array in arrays.items()} == shapes_of_model(first)
    restore_model(second, arrays)
    again = arrays_of_model(second)
    assert all((again[name] == array).all() for name, array in arrays.items())
    with pytest.raises(ValueError, match=r"array policy/\S+ is missing"):
        restore_model(second, {name: array for name, array in arrays.items() if not name.startswith("policy/")})
    with pytest.raises(ValueError, match="all or none"):
        restore_model(second, {name: array for name, array in arrays.items() if not name.endswith("0/step")})
