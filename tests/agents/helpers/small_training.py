"""A training that takes seconds, and a task that is learned in seconds."""

from dataclasses import replace

import numpy as np
from gymnasium import spaces
from stable_baselines3.common.vec_env.base_vec_env import VecEnv
from tagalong.agents.learned.pilot import PilotConfig
from tagalong.agents.training.curriculum import CurriculumConfig
from tagalong.agents.training.presets import ImitationConfig, ReinforcementConfig, make_preset
from tagalong.agents.training.vec_env import input_space

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
