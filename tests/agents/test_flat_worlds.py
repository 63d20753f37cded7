"""Our vector environments behind the interfaces of PufferLib and rsl_rl, as their documents state them."""

import sys
from types import ModuleType

import gymnasium as gym
import numpy as np
import pytest
from tagalong.agents import PufferWorlds, RslRlVecEnv
from tagalong.slam import InputError
from tagalong.slam.errors import MissingExtraError


def worlds(count=3, **arguments):
    given = {"workers": 1, "beams": 90, "episodes_ahead": 4, "autoreset_mode": "SameStep", **arguments}
    return gym.make_vec("tagalong/Corridor-v0", count, "vector_entry_point", simulator="compiled", **given)


def test_puffer_worlds_write_into_the_buffers_they_are_given():
    env = PufferWorlds(worlds(max_episode_steps=4))
    size = env.single_observation_space.shape[0]
    buffers = {
        "observations": np.zeros((3, size), np.float32),
        "rewards": np.zeros(3, np.float32),
        "terminals": np.zeros(3, bool),
        "truncations": np.zeros(3, bool),
        "masks": np.ones(3, bool),
        "actions": np.zeros((3, 2), np.float32),
    }
    env = PufferWorlds(worlds(max_episode_steps=4), buf=buffers)
    env.async_reset(seed=5)
    observations, *_, infos, ids, masks = env.recv()
    assert observations is buffers["observations"]
    assert all(env.single_observation_space.contains(row) for row in observations)
    assert (infos, ids.tolist(), masks.all()) == ([], [0, 1, 2], True)
    total = np.zeros(3)
    for _ in range(4):
        env.send(np.full((3, 2), 0.5))
        total += buffers["rewards"]
    assert buffers["truncations"].all()
    assert not buffers["terminals"].any()
    assert env.recv()[4][0]["episode_return"] == pytest.approx(total.mean(), rel=1e-5)
    assert env.recv()[4][0]["episode_length"] == 4.0
    assert env.observation_space.shape == observations.shape
    assert (env.driver_env, env.emulated, env.agents_per_batch) == (env, False, 3)
    env.close()


def test_flat_observations_are_the_entries_in_the_order_of_their_space():
    inner = worlds()
    env = PufferWorlds(inner)
    row, _ = env.reset(seed=5)
    batch, _ = inner.reset(seed=5)
    parts = [batch[name].reshape(3, -1) for name in inner.single_observation_space]
    assert np.array_equal(row, np.concatenate(parts, axis=1))


def test_rsl_rl_gets_groups_of_tensors_and_time_outs(monkeypatch):
    torch = pytest.importorskip("torch")

    class TensorDict(dict):
        def __init__(self, groups, batch_size, device):
            super().__init__(groups)
            assert all(len(group) == batch_size[0] for group in groups.values())

    fake = ModuleType("tensordict")
    fake.TensorDict = TensorDict
    monkeypatch.setitem(sys.modules, "tensordict", fake)
    env = RslRlVecEnv(worlds(max_episode_steps=3), max_episode_length=3)
    first = env.get_observations()
    assert first["policy"].dtype == torch.float32
    assert first["privileged"].shape == (3, 3)
    assert (env.num_envs, env.num_actions, env.max_episode_length) == (3, 2, 3)
    for k in range(3):
        observations, rewards, dones, extras = env.step(torch.zeros((3, 2)))
        assert env.episode_length_buf.tolist() == ([k + 1] * 3 if k < 2 else [0] * 3)
    assert dones.all()
    assert extras["time_outs"].all()
    assert extras["log"]["/episode_length"] == 3.0
    assert (rewards.shape, rewards.dtype) == ((3,), torch.float32)
    assert observations["policy"].shape == first["policy"].shape
    env.close()


def test_rsl_rl_without_tensordict_is_told_what_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "tensordict", None)
    with pytest.raises(MissingExtraError, match="tensordict"):
        RslRlVecEnv(worlds())


@pytest.mark.parametrize("adapter", [PufferWorlds, RslRlVecEnv])
def test_episodes_that_are_followed_a_step_later_are_refused(adapter):
    with pytest.raises(InputError, match="SameStep"):
        adapter(worlds(autoreset_mode="NextStep"))
