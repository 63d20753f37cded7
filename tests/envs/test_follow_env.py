"""Conformance of the registered environments, and what their manual promises."""

import pickle
from itertools import pairwise

import gymnasium as gym
import numpy as np
import pytest
import tagalong  # noqa: F401 (registers the ids)
from gymnasium.utils.env_checker import check_env
from scipy.spatial import KDTree
from tagalong.agents import make_follower
from tagalong.envs.follow_env import nobody_notes
from tagalong.envs.recording.rollout import rollout
from tagalong.envs.registration import IDS, MAX_EPISODE_STEPS
from tagalong.envs.scenes.occupancy import true_map
from tagalong.slam import InputError

SMALL = {"beams": 361, "slam": None}


def make(name="tagalong/Corridor-v0", **arguments):
    return gym.make(name, disable_env_checker=True, **{**SMALL, **arguments})


def drive(env, steps, seed=3, observations=None):
    """Follow for some steps from a seed, or go on from where the environment is; return what was seen and earned."""
    follower = make_follower("pid", env.unwrapped.interface)
    if observations is None:
        observations = [env.reset(seed=seed)[0]]
    seen = [observations[-1]]
    infos = []
    for _ in range(steps):
        observation, reward, terminated, truncated, info = env.step(follower.act(seen[-1]))
        seen.append(observation)
        infos.append((reward, terminated, truncated, info))
    return seen, infos


def as_bytes(seen, infos=()):
    """Everything as one string of bytes."""
    parts = [o[key].tobytes() for o in seen for key in sorted(o)]
    parts += [
        repr((reward, terminated, sorted(info["reward_terms"].items()))).encode()
        for reward, terminated, _, info in infos
    ]
    return b"".join(parts)


@pytest.fixture(scope="module")
def mapping_drive():
    """One drive with everything on: tracker and GMapping."""
    env = make(slam="gmapping", people_count=4, beams=721)
    return drive(env, 80, seed=11)


@pytest.mark.parametrize("name", sorted(IDS))
def test_gymnasium_finds_nothing_to_complain_about(name, recwarn):
    check_env(make(name).unwrapped, skip_render_check=True)
    assert not [w for w in recwarn if "gymnasium" in str(w.filename)], [str(w.message) for w in recwarn]


def test_gymnasium_finds_nothing_to_complain_about_in_rendering(recwarn):
    check_env(make(people="truth", render_mode="rgb_array").unwrapped)
    assert not [str(w.message) for w in recwarn if "gymnasium" in str(w.filename)]


@pytest.mark.parametrize("name", sorted(IDS))
def test_same_seed_same_bytes_other_seed_other_start(name):
    first, second, other = (make(name) for _ in range(3))
    one = as_bytes(*drive(first, 25, seed=7))
    assert one == as_bytes(*drive(second, 25, seed=7))
    assert one == as_bytes(*drive(second, 25, seed=7)), "a used environment differs from a new one"
    start, changed = first.reset(seed=7)[0], other.reset(seed=8)[0]
    assert not np.array_equal(start["scan"], changed["scan"])


def test_episodes_of_one_generator_differ():
    env = make(people="truth")
    first, second = env.reset(seed=1)[0], env.reset()[0]
    assert not np.array_equal(first["scan"], second["scan"])


def test_observations_never_share_memory(mapping_drive):
    seen, _ = mapping_drive
    for before, after in pairwise(seen):
        for key in before:
            assert not np.shares_memory(before[key], after[key]), key


def test_no_entry_is_constant_over_an_episode(mapping_drive):
    seen, _ = mapping_drive
    for key in seen[0]:
        values = np.array([observation[key] for observation in seen])
        assert (values != values[0]).any(), key
        if key in ("scan", "leader", "velocity"):
            changing = (values != values[0]).any(axis=0)
            assert changing.all() or key == "leader" or changing.mean() > 0.95, key


def test_observations_are_inside_the_space(mapping_drive):
    seen, _ = mapping_drive
    space = make(slam="gmapping", beams=721).observation_space
    assert all(space.contains(observation) for observation in seen)


def test_the_map_grows_and_the_pose_in_it_is_near_the_truth(mapping_drive):
    seen, infos = mapping_drive
    known = [(observation["map"] != 0.5).mean() for observation in seen]
    assert known[-1] > 0.15
    start, end = infos[0][3], infos[-1][3]
    travelled = np.linalg.norm(end["robot_pose"][:2] - start["robot_pose"][:2])
    mapped = np.linalg.norm(end["map_pose"][:2] - start["map_pose"][:2])
    assert mapped == pytest.approx(travelled, abs=0.2)


@pytest.mark.parametrize("name", sorted(IDS))
def test_reward_terms_sum_to_the_reward(name):
    _, infos = drive(make(name, people="truth"), 40)
    for reward, _, _, info in infos:
        assert sum(info["reward_terms"].values()) == pytest.approx(reward)


def test_without_slam_there_is_no_map():
    observation, info = make(people="truth").reset(seed=0)
    assert "map" not in observation
    assert "map_pose" not in info


def test_known_poses_map_as_well():
    seen, infos = drive(make(people="truth", slam="truth"), 30)
    assert set(np.unique(seen[-1]["map"])) == {0.0, 0.5, 1.0}
    assert np.isfinite(infos[-1][3]["map_pose"]).all()


@pytest.mark.parametrize("slam", [None, "gmapping", "cartographer", "ekf"])
def test_a_restored_snapshot_continues_with_the_same_bytes(slam):
    env = make(slam=slam)
    seen, _ = drive(env, 30)
    state = env.unwrapped.save_state()
    once = as_bytes(*drive(env, 15, observations=seen))
    env.unwrapped.restore_state(state)
    assert once == as_bytes(*drive(env, 15, observations=seen))
    env.reset(seed=99)
    env.unwrapped.restore_state(state)
    assert once == as_bytes(*drive(env, 15, observations=seen))
    other = make(slam=slam)
    other.reset(seed=5)
    other.unwrapped.restore_state(pickle.loads(pickle.dumps(state)))
    assert once == as_bytes(*drive(other, 15, observations=seen))


def test_a_pickled_environment_continues_with_the_same_bytes():
    env = make()
    seen, _ = drive(env, 20)
    twin = pickle.loads(pickle.dumps(env))
    assert as_bytes(*drive(env, 10, observations=seen)) == as_bytes(*drive(twin, 10, observations=seen))


def test_reset_options_set_scene_people_route_and_leader():
    env = make(people="truth")
    _, _ = env.reset(seed=0, options={"scene": "meeting_room", "people": 4, "leader_style": "hurried"})
    assert env.unwrapped.world.scene.name == "meeting_room"
    assert len(env.unwrapped.truth.people) == 4
    routes = sorted(env.unwrapped.world.scene.routes)
    for route in routes:
        env.reset(seed=0, options={"scene": "meeting_room", "route": route})
        assert env.unwrapped.world.scene.route_name == route
    env.reset(seed=0)
    assert env.unwrapped.world.scene.name == "corridor"


def test_an_unknown_option_or_argument_is_refused_with_the_list():
    with pytest.raises(InputError, match="reset options: heedless, leader_style, odometry"):
        make(people="truth").reset(options={"peple": 3})
    with pytest.raises(InputError, match="unknown argument 'pepole'; like it: people; branches: world, robot"):
        make(pepole="truth")
    with pytest.raises(InputError, match="`people_count`"):
        make(people=3)
    for name, value in (("people_count", 1.5), ("map_cells", 2.5), ("people_slots", 0), ("beams", 10.5), ("beams", 1)):
        with pytest.raises(InputError, match=f"`{name}` must be (a whole number|within .*), got {value}"):
            make(**{name: value})
    with pytest.raises(InputError, match="unknown scene 'plasa'"):
        make(scene="plasa")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("lidar.range_max", "30"),
        ("lidar.range_max", np.inf),
        ("control_hz", np.nan),
        ("control_hz", 7.0),
        ("lidar.rate_hz", 5.0),
        ("top_turn_rate", 6.0),
        ("lost_limit_s", -1.0),
        ("standing", -1),
        ("people_count", True),
        ("leader", "no"),
        ("coverage_goal", "all"),
        ("odometry", "bad"),
    ],
)
def test_what_no_episode_could_have_is_refused_when_the_environment_is_made(name, value):
    with pytest.raises(InputError, match=name.split(".")[-1]):
        make(**{name: value})


def test_who_leads_counts_among_the_people_of_an_episode():
    env = make(people="truth", lost_limit_s=np.inf)
    with pytest.raises(InputError, match="counts the leader"):
        env.reset(seed=0, options={"people": 0})
    env.reset(seed=0, options={"people": np.int64(1)})
    assert len(env.unwrapped.truth.people) == 1
    make(people="truth", leader=False).reset(seed=0, options={"people": 0})


@pytest.mark.parametrize("ask", [lambda env: env.truth, lambda env: env.belief, lambda env: env.own_map()])
def test_before_the_first_reset_there_is_nothing_to_know(ask):
    with pytest.raises(InputError, match="call `reset` first"):
        ask(make(people="truth").unwrapped)


@pytest.mark.parametrize("action", ["x", None, [[0.0], [1.0, 2.0]], {"forward": 1.0}])
def test_an_action_that_is_no_numbers_is_refused(action):
    env = make().unwrapped
    env.reset(seed=0)
    with pytest.raises(InputError, match="an action has shape"):
        env.step(action)


def test_a_wrong_action_is_refused():
    env = make(people="truth").unwrapped
    with pytest.raises(InputError, match="call `reset` first"):
        env.step([0.0, 0.0])
    env.reset(seed=0)
    with pytest.raises(InputError, match=r"shape \(2,\)"):
        env.step([0.0, 0.0, 0.0])
    with pytest.raises(InputError, match="finite"):
        env.step([0.0, np.nan])


def test_driving_into_a_wall_terminates_as_a_collision():
    env = make(people="truth")
    env.reset(seed=0)
    for _ in range(100):
        _, reward, terminated, truncated, info = env.step([1.0, 0.3])
        if terminated:
            break
    assert terminated
    assert not truncated
    assert info["ending"] in ("collision_static", "collision_person")
    assert reward < -15.0
    assert not info["is_success"]


def test_a_robot_that_stays_behind_loses_the_leader():
    env = make(people="truth", lost_limit_s=3.0)
    env.reset(seed=0, options={"leader_style": "hurried", "people": 1})
    for _ in range(400):
        _, _, terminated, _, info = env.step([0.0, 0.0])
        if terminated:
            break
    assert info["ending"] == "leader_lost"
    assert info["lost_s"] > 3.0


def test_time_limits_truncate():
    env = gym.make("tagalong/Corridor-v0", disable_env_checker=True, max_episode_steps=5, people="truth", **SMALL)
    assert gym.spec("tagalong/Corridor-v0").max_episode_steps == MAX_EPISODE_STEPS
    env.reset(seed=0)
    flags = [env.step(np.zeros(2))[2:4] for _ in range(5)]
    assert flags == [(False, False)] * 4 + [(False, True)]


def test_a_holonomic_robot_can_slide_sideways():
    env = make(people="truth", drive="holonomic")
    env.reset(seed=0)
    for _ in range(5):
        observation, *_ = env.step([0.0, 0.5, 0.0])
    assert observation["velocity"][1] > 0.3
    assert env.action_space.shape == (3,)


def test_a_fast_laser_feeds_every_sweep_to_the_tracker():
    env = make(**{"lidar.rate_hz": 40.0})
    times = []
    _, _ = env.reset(seed=0)
    mind = env.unwrapped._episode.stack
    update = mind.update_in_stages
    mind.update_in_stages = lambda scan, odometry: times.append(scan.time_s) or update(scan, odometry)
    for _ in range(3):
        env.step([0.5, 0.2])
    assert np.allclose(times, np.arange(1, 13) * 0.025)


def test_a_rollout_records_what_happened_and_can_be_repeated():
    env = make()
    follower = make_follower("pid", env.unwrapped.interface)
    episode = rollout(env, follower, seed=4, steps=60)
    again = rollout(env, follower, seed=4, steps=60)
    assert len(episode.history) == 61
    assert episode.total_reward == pytest.approx(sum(episode.history.reward_terms.values()).sum())
    assert episode.metrics["collision_free"] == 1.0
    assert (episode.seed, episode.ending) == (4, "")
    assert episode.history.robot_pose.tobytes() == again.history.robot_pose.tobytes()
    assert repr(episode.metrics) == repr(again.metrics)


def test_a_fast_laser_with_true_poses_maps_as_sharply_as_a_slow_one():
    """Sweeps within a control period belong to where the robot was then."""
    env = make(
        scene="meeting_room",
        people="truth",
        slam="truth",
        **{"lidar.rate_hz": 40.0},
        people_count=1,
        ends_on_contact=False,
    )
    env.reset(seed=3)
    for k in range(40):
        env.step([0.6, 1.0 if k % 20 < 10 else -1.0])
    inner = env.unwrapped
    truth = true_map(inner.world.scene, T_world_map=inner.world.start).occupied_points
    off, _ = KDTree(truth).query(inner.own_map().map.occupied_points)
    assert np.mean(np.asarray(off) > 0.06) < 0.05


def test_truly_known_people_stand_still_in_the_odometry_frame_while_a_fast_laser_turns():
    env = make(people="truth", **{"lidar.rate_hz": 40.0}, people_count=1, ends_on_contact=False)
    env.reset(seed=0)
    inner, places = env.unwrapped, []
    source = inner._episode.stack._people
    update = source.update
    source.update = lambda *given: kept(update(*given), places)
    for _ in range(3):  # the leader has not set off yet
        env.step([0.0, 1.0])
    assert len(places) == 12
    assert np.ptp(np.array(places)[:, 0], axis=0).max() < 0.03


def kept(filtered, places):
    """Keep where the people of a filtered scan are."""
    places.append(filtered.people.positions)
    return filtered


class Thrice(gym.Wrapper):
    """Takes actions in [0, 1], does each three times, and pays in cents."""

    def step(self, action):
        for _ in range(3):
            observation, reward, *rest = self.env.step(2.0 * action - 1.0)
        return observation, 100.0 * reward, *rest


def test_a_rollout_records_the_environment_itself_whatever_wraps_it():
    class Half:
        def reset(self):
            """Nothing to forget."""

        def act(self, observation):
            return np.array([0.75, 0.5])

    env = Thrice(make())
    history = rollout(env, Half(), seed=4, steps=4).history
    assert np.allclose(history.time_s, 0.1 * np.arange(13))
    assert (history.action[1:] == [0.5, 0.0]).all()
    assert history.reward.sum() == pytest.approx(sum(history.reward_terms.values()).sum())
    assert env.unwrapped.witness is nobody_notes


def test_rollout_needs_a_follow_env():
    with pytest.raises(InputError, match="needs a FollowEnv"):
        rollout(gym.make("CartPole-v1"), make_follower("pid"))
    with pytest.raises(InputError, match="`steps` must be at least 1"):
        rollout(make(people="truth"), make_follower("pid"), steps=0)
