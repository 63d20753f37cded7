"""Arguments, options, actions and calls that make no sense: each is told in one line, and nothing breaks or grows."""

import gymnasium as gym
import numpy as np
import pytest
from tagalong.envs.follow_env import FollowEnv
from tagalong.envs.robot.robot import RobotConfig
from tagalong.envs.sensors.camera.config import RgbdConfig
from tagalong.envs.sensors.lidar import LidarConfig
from tagalong.envs.task.config import TaskConfig
from tagalong.envs.world.config import WorldConfig
from tagalong.slam import InputError

DEEP: list = []
for _ in range(2000):
    DEEP = [DEEP]

NONSENSE = [
    {"people_count": 100_000_000},
    {"standing": 1_000_000},
    {"beams": 50_000_000},
    {"beams": "many"},
    {"field_of_view": 7.0},
    {"lidar.range_max": 1e308},
    {"lidar.rate_hz": 1e-9},
    {"control_hz": 1e-9},
    {"control_hz": [10.0]},
    {"camera": (64, 53)},
    {"camera.width": 64},
    {"chassis": (0.5, 0.4)},
    {"robot": np.zeros(3)},
    {"robot": RobotConfig},
    {"perception": {"alpha": 0.1}},
    {"perception.detector.alpha": "wide"},
    {"slam.particles": 10**9},
    {"slam": np.zeros(3)},
    {"slam": WorldConfig},
    {"reward.distance": -1.0},
    {"reward.terms": [len]},
    {"reward.terms": {"tour": len}},
    {"reward.terms": {"own": 3}},
    {"observation.entries": {"scan": (None, len)}},
    {"observation.entries": {"own": len}},
    {"observation": 3},
    {"x" * 5000: 1},
    {"people_slots": 10**9},
    {"map_cells": 10**6},
    {"map_resolution": 1e-300},
    {"lost_limit_s": np.nan},
    {"top_turn_rate": 5.0},
    {"coverage_goal": 0.0},
    {"leader": "no"},
    {"scene": ["corridor"]},
    {"scene": 7},
    {"split": None},
    {"floor_plan": 3},
    {"floor_plan": "a\0b"},
    {"walking_paths": "\ud800"},
    {"odometry": 1_000_000},
    {"odometry": {}},
    {"drive": DEEP},
    {"sensors": 5},
    {"sensors": np.array(4)},
    {"lidar": "sick"},
    {"render_mode": np.zeros(2)},
    {"render_backend": ["topview"]},
    {"field_of_view": 1e-7},
    {"sensors": [["lidar"]]},
    {"slam": ["gmapping"]},
    {"people": "tracker" * 1000},
    {"leader_style": "x" * 5000},
]


@pytest.mark.parametrize("fields", NONSENSE, ids=lambda fields: next(iter(fields)))
def test_an_argument_that_makes_no_sense_is_told_by_its_name_in_one_short_line(fields):
    with pytest.raises(InputError) as told:
        FollowEnv(**fields)
    message = str(told.value)
    name = next(iter(fields))
    name = name.rpartition(".")[2]
    words = {"render_backend": "render back end", "x" * 5000: "unknown argument", "width": "camera"}
    assert words.get(name, name) in message or name.replace("_", " ") in message or f"unknown {name}" in message
    assert len(message) < 400
    assert "\n" not in message


@pytest.fixture(scope="module")
def env():
    made = FollowEnv(people="truth", slam=None, beams=8)
    made.reset(seed=0)
    return made


@pytest.mark.parametrize(
    "options",
    [
        {"odometry": 1_000_000},
        {"people": 10**9},
        {"people": np.zeros(3)},
        {"standing": "two"},
        {"route": 3},
        {"scene": {}},
        {"split": 5.0},
        {"leader_style": []},
        {3: 4},
        {"x" * 5000: 1},
        "people",
        [("people", 2)],
    ],
)
def test_after_an_option_that_makes_no_sense_the_episode_goes_on(env, options):
    with pytest.raises(InputError) as told:
        env.reset(options=options)
    assert len(str(told.value)) < 400
    env.step([0.0, 0.0])


@pytest.mark.parametrize("seed", [-1, 1.5, "1", True, 2**70, [1]])
def test_a_seed_that_is_none_is_refused(env, seed):
    with pytest.raises(InputError, match="`seed` must be a whole number"):
        env.reset(seed=seed)


@pytest.mark.parametrize(
    "action",
    [[np.nan, 0.0], [np.inf, 0.0], [0.0], [[0.0, 0.0]], "ab", ["1", "2"], None, {}, [0.0, None], [1j, 0.0], DEEP],
)
def test_after_an_action_that_is_none_the_episode_goes_on(env, action):
    before = env.world.time_s
    with pytest.raises(InputError, match=r"an action has shape \(2,\)"):
        env.step(action)
    env.step([0.0, 0.0])
    assert env.world.time_s == pytest.approx(before + 0.1)


@pytest.mark.parametrize(
    ("config", "fields"),
    [
        (WorldConfig, {"physics_dt": 1e-12}),
        (WorldConfig, {"people": 10**7}),
        (WorldConfig, {"lidar": None}),
        (WorldConfig, {"robot": 3}),
        (WorldConfig, {"odometry": 1e6}),
        (LidarConfig, {"beams": 10**9}),
        (LidarConfig, {"mount": (np.nan, 0.0, 0.0)}),
        (LidarConfig, {"range_max": np.inf}),
        (RgbdConfig, {"width": 10**6}),
        (RgbdConfig, {"range_max": np.inf}),
        (RobotConfig, {"mass": np.inf}),
        (RobotConfig, {"drive": 4}),
        (TaskConfig, {"control_hz": True}),
    ],
)
def test_parts_of_the_simulator_refuse_what_no_machine_could_bear(config, fields):
    with pytest.raises(InputError, match=next(iter(fields))):
        config(**fields)


def test_calls_in_the_wrong_order_are_told():
    env = FollowEnv(people="truth", slam=None, beams=8, lost_limit_s=0.2, render_mode="rgb_array")
    for call in (lambda: env.step([0.0, 0.0]), env.render, env.save_state):
        with pytest.raises(InputError, match="call `reset` first"):
            call()
    env.reset(seed=0)
    ended = False
    while not ended:
        _, _, ended, _, _ = env.step([-1.0, 1.0])
    with pytest.raises(InputError, match=r"the episode has ended \(.*\): call `reset` first"):
        env.step([0.0, 0.0])
    env.reset(seed=1)
    env.step([0.0, 0.0])
    env.close()
    env.close()
    for call in (lambda: env.step([0.0, 0.0]), env.reset):
        with pytest.raises(InputError, match="closed"):
            call()


def test_a_state_of_before_the_end_can_be_gone_on_from():
    env = FollowEnv(people="truth", slam=None, beams=8, lost_limit_s=0.2)
    env.reset(seed=0)
    state = env.save_state()
    while not env.step([-1.0, 1.0])[2]:
        pass
    env.restore_state(state)
    assert not env.step([0.0, 0.0])[2]


@pytest.mark.parametrize("leader", [True, False])
def test_reward_terms_have_the_same_names_after_reset_and_are_zero(leader):
    env = FollowEnv(people="truth", slam=None, beams=8, leader=leader)
    _, info = env.reset(seed=0)
    _, _, _, _, after = env.step([0.0, 0.0])
    assert set(info["reward_terms"]) == set(after["reward_terms"])
    assert set(info["reward_terms"].values()) == {0.0}


def test_reward_terms_of_a_vector_environment_are_zero_after_reset():
    fields = {"people": "truth", "slam": None, "beams": 8, "workers": 1}
    envs = gym.make_vec("tagalong/Corridor-v0", num_envs=2, vectorization_mode="vector_entry_point", **fields)
    _, infos = envs.reset(seed=0)
    assert (infos["reward_terms"]["distance"] == 0.0).all()
    assert infos["reward_terms"]["distance"].shape == (2,)
    envs.close()
