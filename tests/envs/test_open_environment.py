"""What of an environment can be chosen: engine, perception, filter, laser, robot, rewards, observations."""

import gymnasium as gym
import numpy as np
import pytest
import tagalong  # noqa: F401 (registers the ids)
from gymnasium import spaces
from gymnasium.envs.registration import EnvSpec
from tagalong.agents import make_follower
from tagalong.envs.episode_setup import OnboardStackFactory
from tagalong.envs.follow_config import ARGUMENTS, FollowConfig, make_config
from tagalong.envs.follow_env import FollowEnv
from tagalong.envs.onboard.config import PERCEPTION
from tagalong.envs.recording.rollout import rollout
from tagalong.envs.robot.robot import ROBOTS, RobotConfig
from tagalong.envs.world.config import WorldConfig
from tagalong.envs.world.world import World
from tagalong.perception import filtered_scans
from tagalong.slam import GMappingConfig, InputError, RecordedDrive, make_slam

CORRIDOR = "tagalong/Corridor-v0"
FEW = {"people_count": 2, "beams": 541}


def driven(env, steps, seed=3):
    """What came back in some steps behind the leader."""
    follower = make_follower("pid", env.unwrapped.interface)
    observation, _ = env.reset(seed=seed)
    follower.reset()
    rows = []
    for _ in range(steps):
        observation, reward, _, _, info = env.step(follower.act(observation))
        rows.append((observation, reward, info))
    return rows


def nearest_return(belief):
    return [np.nanmin(belief.scan.ranges)]


def always_one(facts):
    return 1.0


class KeepsScans:
    """An engine that stands still and keeps what it was given."""

    config = None

    def __init__(self, seed):
        self.inner, self.given = make_slam("gmapping", particles=2, seed=seed), []

    def update(self, odometry, scan):
        self.given.append((np.array(odometry), scan))
        return self.inner.update(odometry, scan)

    def __getattr__(self, name):
        return getattr(self.inner, name)


def test_every_argument_of_the_default_configuration_can_be_set_by_its_path():
    whole = FollowConfig()
    for name in ARGUMENTS:
        value = whole
        for part in name.split("."):
            value = getattr(value, part, None)
        if not name.startswith("sensors.camera"):
            assert make_config({name: value}) == whole


def test_the_short_names_of_the_own_branches_are_unique():
    ends = [name.rpartition(".")[2] for name in ARGUMENTS if not name.startswith(("reward.", "sensors.camera."))]
    assert len(ends) == len(set(ends))


def test_plain_arguments_go_through_json():
    env = gym.make(
        CORRIDOR, robot="dingo-o", **{"slam.particles": 5, "reward.personal_space": 3.0, "lidar.height": 0.3}
    )
    again = gym.make(EnvSpec.from_json(env.spec.to_json()))
    assert again.unwrapped.config == env.unwrapped.config
    assert again.unwrapped.config.reward.personal_space == 3.0


def test_an_engine_takes_settings_by_path_or_as_a_configuration():
    by_path = gym.make(CORRIDOR, **{"slam.particles": 7}).unwrapped
    whole = gym.make(CORRIDOR, slam=GMappingConfig(particles=7)).unwrapped
    assert by_path.config == whole.config
    whole.reset(seed=0)
    assert whole._episode.stack._mapper.engine.config.particles == 7


def test_an_engine_of_ones_own_gets_the_seed_of_the_episode_and_its_filtered_scans():
    made = []
    env = gym.make(CORRIDOR, slam=lambda seed: made.append(KeepsScans(seed)) or made[-1], **FEW)
    driven(env, 10)
    (engine,) = made
    assert len(engine.given) == 11
    assert np.isnan(engine.given[-1][1].ranges).sum() > np.isnan(env.unwrapped.belief.scan.ranges).sum()
    assert env.unwrapped.own_map().pose.tobytes() == engine.pose.tobytes()
    with pytest.raises(InputError, match="`slam` must return a SlamEngine, got 3"):
        gym.make(CORRIDOR, slam=lambda seed: 3).reset(seed=0)


@pytest.mark.parametrize("filters", [True, False])
def test_the_map_of_the_loop_is_what_the_engine_makes_of_the_recorded_drive_raw_or_filtered(filters):
    """As `tagalong reproduce following` maps a drive from its raw and from its filtered scans."""
    engines, odometry, scans = [], [], []
    make = lambda seed: engines.append(make_slam("gmapping", particles=5, seed=7)) or engines[-1]  # noqa: E731
    env = gym.make(CORRIDOR, slam=make, filter_people=filters, **FEW)

    def note(inner):
        odometry.append(inner.belief.odometry)
        scans.append(inner.belief.scan)

    rollout(env, make_follower("pid", env.unwrapped.interface), seed=3, steps=60, after_step=note)
    drive = RecordedDrive(np.array(odometry), scans, None, "drive")
    filtered = [scan.without_people for scan in filtered_scans(drive, PERCEPTION, lag_s=0.0)]
    alone = make_slam("gmapping", particles=5, seed=7)
    for pose, scan in zip(odometry, filtered if filters else scans, strict=True):
        alone.update(pose, scan)
    assert filtered[-1].is_return.sum() < scans[-1].is_return.sum() - 10
    assert np.hypot(*alone.pose[:2]) > 1.0
    assert alone.trajectory().tobytes() == engines[0].trajectory().tobytes()
    assert alone.map().probability.tobytes() == engines[0].map().probability.tobytes()
    assert env.unwrapped.belief.map_pose.tobytes() == alone.pose.tobytes()


def test_raw_scans_in_slam_change_the_map_and_nothing_else():
    filtered, raw = (driven(gym.make(CORRIDOR, filter_people=on, **FEW), 60) for on in (True, False))
    assert any((a["map"] != b["map"]).any() for (a, *_), (b, *_) in zip(filtered, raw, strict=True))
    for (a, reward, _), (b, other, _) in zip(filtered, raw, strict=True):
        assert reward == other
        assert all(a[key].tobytes() == b[key].tobytes() for key in a if key != "map")


def test_the_trackers_and_the_filters_numbers_are_arguments():
    env = gym.make(CORRIDOR, slam=None, **{"perception.removal.zeta": 2.0}, **FEW)
    usual = gym.make(CORRIDOR, slam=None, **FEW)
    driven(env, 40)
    driven(usual, 40)
    assert env.unwrapped.belief.filtered.is_return.sum() < usual.unwrapped.belief.filtered.is_return.sum()


def test_the_papers_own_tracker_is_an_argument():
    with gym.make(CORRIDOR, slam=None, **{"perception.method": "ye2021"}, **FEW) as env:
        beliefs = [info for *_, info in driven(env, 30)]
    assert len(beliefs) == 30


def test_the_laser_is_an_argument():
    laser = {"lidar.height": 0.3, "lidar.mount": (0.2, 0.0, 0.0), "lidar.sigma_near": 0.0, "lidar.rate_hz": 20.0}
    env = gym.make(CORRIDOR, slam=None, people_count=1, **laser)
    env.reset(seed=0)
    env.step([0.0, 0.0])
    assert len(env.unwrapped.world.scans) == 2
    assert env.unwrapped.belief.scan.T_robot_lidar == (0.2, 0.0, 0.0)
    assert env.unwrapped.interface.T_robot_lidar == (0.2, 0.0, 0.0)


@pytest.mark.parametrize("name", ROBOTS)
def test_every_robot_follows_its_leader(name):
    env = gym.make(CORRIDOR, robot=name, slam=None, people_count=1)
    assert env.action_space.shape == (3 if name == "dingo-o" else 2,)
    rows = driven(env, 100)
    assert rows[-1][2]["following_leader"]
    assert abs(rows[-1][2]["leader_distance"] - 1.3) < 0.5
    half = env.unwrapped.interface.half_length, env.unwrapped.interface.half_width
    assert half == pytest.approx(np.array(ROBOTS[name].size[:2]) / 2.0, abs=0.001)


def test_a_robot_of_ones_own_has_its_size_and_its_limits():
    env = gym.make(CORRIDOR, robot=RobotConfig(chassis=(0.9, 0.6, 0.15), max_speed=0.5), slam=None, people_count=1)
    inner = env.unwrapped
    assert (inner.interface.half_length, inner.interface.half_width, inner.interface.max_speed) == (0.45, 0.3, 0.5)
    driven(env, 60)
    assert np.hypot(*inner.truth.robot_velocity[:2]) < 0.55
    with pytest.raises(InputError, match="`top_turn_rate` must be at most the robot's `max_turn_rate`, 1 rad/s"):
        gym.make(CORRIDOR, robot=RobotConfig(max_turn_rate=1.0))


def test_the_default_robot_tells_followers_the_size_that_they_were_made_for():
    inner = gym.make(CORRIDOR, slam=None).unwrapped
    assert (inner.interface.half_length, inner.interface.half_width) == (0.275, 0.259)


def test_weights_scale_the_terms_and_terms_of_ones_own_are_added():
    usual = driven(gym.make(CORRIDOR, slam=None, **FEW), 20)
    heavy = driven(
        gym.make(CORRIDOR, slam=None, **{"reward.facing": 0.4, "reward.terms": {"alive": always_one}}, **FEW), 20
    )
    for (_, _, info), (_, reward, other) in zip(usual, heavy, strict=True):
        assert other["reward_terms"]["facing"] == pytest.approx(2.0 * info["reward_terms"]["facing"])
        assert other["reward_terms"]["alive"] == 1.0
        assert reward == pytest.approx(sum(other["reward_terms"].values()))
    with pytest.raises(InputError, match=r"`reward\.terms\['bad'\]` must return a finite number, got 'x'"):
        gym.make(CORRIDOR, slam=None, **{"reward.terms": {"bad": lambda facts: "x"}}).reset(seed=0)


def test_entries_of_ones_own_are_observed():
    entry = (spaces.Box(0.0, 40.0, (1,), np.float32), nearest_return)
    env = gym.make(CORRIDOR, slam=None, entries={"nearest": entry}, **FEW)
    for observation, _, _ in driven(env, 5):
        assert env.observation_space.contains(observation)
        assert observation["nearest"][0] == pytest.approx(observation["scan"].min() * 30.0, rel=1e-5)
    wrong = (spaces.Box(0.0, 1.0, (3,), np.float32), nearest_return)
    with pytest.raises(InputError, match=r"`observation\.entries\['nearest'\]` must return shape \(3,\)"):
        gym.make(CORRIDOR, slam=None, entries={"nearest": wrong}).reset(seed=0)


@pytest.mark.parametrize("context", ["fork", "spawn"])
def test_functions_of_a_module_work_in_the_processes_of_a_vector_environment(context):
    entry = (spaces.Box(0.0, 40.0, (1,), np.float32), nearest_return)
    fields = {"slam": None, "entries": {"nearest": entry}, "reward.terms": {"alive": always_one}, **FEW}
    if context == "spawn":  # of this file there is no module that a new process could import
        fields |= {"entries": {}, "reward.terms": {"alive": np.size}}
    many = {"vectorization_mode": "vector_entry_point", "workers": 2, "context": context}
    envs = gym.make_vec(CORRIDOR, num_envs=2, **many, **fields)
    observations, _ = envs.reset(seed=3)
    single = gym.make(CORRIDOR, **fields)
    first, _ = single.reset(seed=3)
    _, rewards, _, _, infos = envs.step(np.zeros((2, 2)))
    assert infos["reward_terms"]["alive"].tolist() == [1.0, 1.0]
    assert rewards[0] == single.step(np.zeros(2))[1]
    assert all(observations[key][0].tobytes() == first[key].tobytes() for key in first)
    envs.close()


def test_a_function_that_reaches_no_process_is_told_before_one_starts():
    many = {"vectorization_mode": "vector_entry_point", "workers": 2, "context": "spawn"}
    with pytest.raises(
        InputError, match=r'alive.* must be a function of a module to reach processes that start by "spawn"'
    ):
        gym.make_vec(CORRIDOR, num_envs=2, **many, slam=None, **{"reward.terms": {"alive": lambda facts: 1.0}})


def test_the_manual_names_every_branch():
    manual = FollowEnv.__doc__ or ""
    for name in {name.rpartition(".")[0] or name for name in ARGUMENTS}:
        assert f"| `{name}` |" in manual


def test_filtered_scans_of_a_drive_alone_are_those_of_the_environments_robot():
    rng = np.random.default_rng(1)
    world = World(WorldConfig(scene="corridor", people=4, leader=False), rng)
    mind = OnboardStackFactory(make_config({"slam": None, "leader": False})).make(world, rng)
    scans, odometry, filtered = [], [], []
    for _ in range(30):
        world.step(np.array([0.5, 0.05]))
        scans.append(world.scan())
        odometry.append(world.odometry)
        filtered.append(mind.update(scans[-1], odometry[-1]).filtered)
    drive = RecordedDrive(np.array(odometry), scans, None, "drive")
    for ours, theirs in zip(filtered_scans(drive, PERCEPTION, lag_s=0.0), filtered, strict=True):
        np.testing.assert_array_equal(ours.without_people.ranges, theirs.ranges)
