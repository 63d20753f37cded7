"""The observation to learn from: the same numbers from one environment, from many, and from compiled worlds."""

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from tagalong.envs.task import FollowInterface
from tagalong.envs.task.rewards import FOLLOWING_TERMS
from tagalong.envs.wrappers import PooledConfig, PooledFeatures, PooledObservation, PooledVectorObservation
from tagalong.slam import InputError

PLAIN = {"people": "truth", "slam": None, "beams": 90}
CONFIG = PooledConfig(sectors=30, stack=2)
BEARINGS = np.deg2rad(np.linspace(-135.0, 135.0, 91))


def vector(simulator, mode, worlds=3, **arguments):
    given = {"simulator": simulator, "autoreset_mode": mode, **PLAIN, **arguments}
    if simulator == "compiled":
        given["episodes_ahead"] = 4
    return gym.make_vec("tagalong/Corridor-v0", worlds, "vector_entry_point", workers=1, **given)


def one(scan=1.0, leader=(0, 0, 0, 0, 0, 0), velocity=(0, 0), people=()):
    rows = np.zeros((1, 6, 6), dtype=np.float32)
    rows[0, : len(people)] = np.array(people).reshape(-1, 6)
    told = {"leader": leader, "velocity": velocity}
    batch = {name: np.array([value], dtype=np.float32) for name, value in told.items()}
    return {**batch, "scan": np.full((1, 91), scan, dtype=np.float32), "people": rows}


def named(config, vector):
    return dict(zip(config.names, vector[0].tolist(), strict=True))


def features(**settings):
    config = PooledConfig(sectors=9, **settings)
    return config, PooledFeatures(config, FollowInterface(bearings=BEARINGS))


class Spy(gym.vector.VectorWrapper):
    """Keeps what an environment showed."""

    def reset(self, **arguments):
        batch, info = self.env.reset(**arguments)
        self.shown = [(batch, None, None)]
        return batch, info

    def step(self, actions):
        batch, reward, terminated, truncated, info = self.env.step(actions)
        self.shown.append((batch, terminated | truncated, info.get("final_obs")))
        return batch, reward, terminated, truncated, info

    @property
    def interface(self):
        return self.env.interface


@pytest.mark.parametrize("simulator", ["mujoco", "compiled"])
@pytest.mark.parametrize("mode", ["SameStep", "NextStep"])
def test_a_world_among_others_tells_what_it_tells_alone(simulator, mode):
    spy = Spy(vector(simulator, mode, max_episode_steps=5))
    env, rng, actions = PooledVectorObservation(spy, CONFIG), np.random.default_rng(0), []
    told = [env.reset(seed=3)[0]]
    ends = []
    for _ in range(8):
        actions.append(rng.uniform(-1.0, 1.0, (3, 2)).astype(np.float32))
        observation, *_, info = env.step(actions[-1])
        told.append(observation)
        ends.append(info.get("final_obs"))
    assert env.observation_space.contains(told[-1])
    for w in range(3):
        alone, ended = PooledFeatures(CONFIG, spy.interface), False
        for k, (batch, over, final) in enumerate(spy.shown):
            shown = {name: values[w : w + 1] for name, values in batch.items()}
            begins = k == 0 or (mode == "NextStep" and ended)
            ended = k > 0 and bool(over[w])
            if ended and mode == "SameStep":
                last = {name: values[None] for name, values in final[w].items()}
                assert np.array_equal(alone.update(last, actions[k - 1][w : w + 1])[0], ends[k - 1][w])
                begins = True
            now = alone.begin(shown) if begins else alone.update(shown, actions[k - 1][w : w + 1])
            assert np.array_equal(now[0], told[k][w])
    env.close()


def test_one_environment_tells_what_many_tell():
    single = PooledObservation(gym.make("tagalong/Corridor-v0", **PLAIN), CONFIG)
    many = PooledVectorObservation(vector("mujoco", "NextStep"), CONFIG)
    first, _ = single.reset(seed=7)
    assert np.array_equal(first, many.reset(seed=7)[0][0])
    for _ in range(4):
        action = np.array([0.4, 0.1], dtype=np.float32)
        assert np.array_equal(single.step(action)[0], many.step(np.tile(action, (3, 1)))[0][0])
    many.close()


@pytest.mark.filterwarnings("ignore:.*is different from the unwrapped version")
def test_gymnasium_takes_it_for_an_environment():
    env = PooledObservation(gym.make("tagalong/Corridor-v0", **PLAIN))
    check_env(env, skip_render_check=True)
    observation, info = env.reset(seed=0)
    assert env.observation_space.contains(observation)
    assert observation.shape == (PooledConfig().size(),)
    assert set(info["reward_terms"]) == set(FOLLOWING_TERMS)  # recorders need the same keys from the first step on


@pytest.mark.parametrize("simulator", ["mujoco", "compiled"])
def test_the_terms_of_the_reward_have_all_their_names_after_reset(simulator):
    env = vector(simulator, "NextStep")
    for info in (env.reset(seed=0)[1], env.step(np.zeros((3, 2)))[-1]):
        assert {name for name in info["reward_terms"] if not name.startswith("_")} == set(FOLLOWING_TERMS)
    env.close()


def test_a_sector_tells_the_gap_from_the_robots_body_on():
    config, pooled = features(gap_scale=1.0)
    now = named(config, pooled.begin(one(scan=(0.275 - 0.1) / 30.0)))
    assert now["sector 4"] == pytest.approx(1.0, abs=1e-3)  # straight ahead: what touches the front
    far = named(config, pooled.begin(one(scan=(0.275 - 0.1 + 1.0) / 30.0)))
    assert far["sector 4"] == pytest.approx(np.exp(-1.0), abs=0.02)


def test_a_leader_who_is_out_of_sight_is_told_for_how_long_and_where_the_trail_ends():
    config, pooled = features()
    assert named(config, pooled.begin(one()))["leader known"] == 0.0
    for k in range(4):
        pooled.update(one(leader=(1.0 + 0.4 * k, 0.0, 1, 0, 1, 1)), np.zeros((1, 2)))
    for _ in range(10):
        now = named(config, pooled.update(one(leader=(9, 9, 0, 0, 0, 0), velocity=(1.0, 0.0)), np.ones((1, 2))))
    assert now["leader seen"] == 0.0
    assert now["leader known"] == 1.0
    assert now["leader unseen"] == pytest.approx(1.0 / 4.0)
    assert 3.0 * now["trail 0 x"] == pytest.approx(2.2 - 1.0, abs=1e-3)
    assert 3.0 * now["trail 1 x"] == pytest.approx(1.8 - 1.0, abs=1e-3)
    assert now["action 0 ago forward"] == 1.0


def test_the_trail_turns_with_the_robot():
    config, pooled = features()
    pooled.begin(one(leader=(2.0, 0.0, 0, 0, 1, 1)))
    now = named(config, pooled.update(one(velocity=(0.0, 5.0 * np.pi)), np.zeros((1, 2))))
    assert (3.0 * now["trail 0 x"], 3.0 * now["trail 0 y"]) == pytest.approx((0.0, -2.0), abs=1e-3)


def test_what_makes_no_sense_is_refused_in_one_line():
    with pytest.raises(InputError, match="`sectors` must be 1 to 4096, got 0"):
        PooledConfig(sectors=0)
    with pytest.raises(InputError, match="120 sectors need a laser of as many beams, got 91"):
        PooledFeatures(PooledConfig(sectors=120), FollowInterface(bearings=BEARINGS))
    with pytest.raises(InputError, match="the environment has none"):
        PooledObservation(gym.make("tagalong/Corridor-v0", leader=False, **PLAIN))


@pytest.mark.parametrize("holonomic", [False, True])
def test_what_is_told_of_a_world_in_a_mirror_is_what_the_mirror_says(holonomic):
    config, rng = PooledConfig(sectors=9, stack=2, people=3, trail=2), np.random.default_rng(4)
    interface = FollowInterface(bearings=np.deg2rad(np.linspace(-135.0, 135.0, 90)), holonomic=holonomic)
    as_is, mirrored = PooledFeatures(config, interface), PooledFeatures(config, interface)
    order, signs = config.mirror(holonomic)
    axes = np.array([1, -1, -1] if holonomic else [1, -1])
    for k in range(6):
        batch = {
            "scan": rng.uniform(0.0, 1.0, (1, 90)).astype(np.float32),
            "leader": np.append(rng.normal(0.0, 2.0, 4), (0.8, k % 3 > 0)).astype(np.float32)[None],
            "people": rng.normal(0.0, 2.0, (1, 6, 6)).astype(np.float32),
            "velocity": rng.normal(0.0, 1.0, (1, len(axes))).astype(np.float32),
        }
        across = np.array([1, -1, 1, -1, 1, 1], dtype=np.float32)
        seen = {
            "scan": batch["scan"][:, ::-1],
            "leader": batch["leader"] * across,
            "people": batch["people"] * across,
            "velocity": batch["velocity"] * axes,
        }
        actions = rng.uniform(-1.0, 1.0, (1, len(axes)))
        told = as_is.update(batch, actions) if k else as_is.begin(batch)
        other = mirrored.update(seen, actions * axes) if k else mirrored.begin(seen)
        np.testing.assert_allclose(other[0], told[0, list(order)] * signs, atol=1e-6)
