"""stable-baselines3 on our vector environments."""

import gymnasium as gym
import numpy as np
import pytest

pytest.importorskip("stable_baselines3")
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecMonitor
from tagalong.agents import SB3VecEnv
from tagalong.slam import InputError

COMPILED = {"simulator": "compiled", "episodes_ahead": 4}
MUJOCO = {"simulator": "mujoco", "people": "truth", "slam": None}


def worlds(kind=COMPILED, **arguments):
    given = {**kind, "autoreset_mode": "SameStep", "workers": 1, "beams": 90, **arguments}
    return gym.make_vec("tagalong/Corridor-v0", 3, "vector_entry_point", **given)


def test_an_ended_episode_tells_how_it_ended_and_the_next_has_begun():
    env = SB3VecEnv(worlds(max_episode_steps=4))
    env.seed(5)
    first, total = env.reset(), np.zeros(3)
    for _ in range(4):
        observation, reward, done, infos = env.step(np.zeros((3, 2)))
        total += reward
    assert done.all()
    for i, info in enumerate(infos):
        assert info["TimeLimit.truncated"]
        assert info["ending"] == ""
        assert info["episode"]["l"] == 4
        assert info["episode"]["r"] == pytest.approx(total[i], abs=1e-4)
        assert set(info["terminal_observation"]) == set(observation)
        assert not np.array_equal(info["terminal_observation"]["scan"], observation["scan"][i])
    env.seed(5)
    again = env.reset()
    assert all(np.array_equal(first[key], again[key]) for key in first)
    assert env.get_attr("num_envs") == [3] * 3
    env.close()


@pytest.mark.parametrize("kind", [COMPILED, MUJOCO], ids=["compiled", "mujoco"])
def test_both_simulators_can_be_learned_on(kind):
    env = SB3VecEnv(worlds(kind))
    model = PPO("MultiInputPolicy", VecMonitor(env), n_steps=4, batch_size=12, n_epochs=1, device="cpu", seed=0)
    model.learn(12)
    assert model.num_timesteps == 12
    env.close()


def test_episodes_must_be_followed_in_the_same_step():
    with pytest.raises(InputError, match="needs `autoreset_mode=\"SameStep\"`, got 'NextStep'"):
        SB3VecEnv(worlds(autoreset_mode="NextStep"))
