"""Our vector environment as stable-baselines3 wants it: features for observations, the network's output for actions."""

from functools import partial
from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray
from stable_baselines3.common.vec_env.base_vec_env import VecEnvStepReturn

from ...envs.episode_setup import interface
from ...envs.follow_config import make_config
from ...envs.registration import MAX_EPISODE_STEPS
from ...envs.vector.vector_env import FollowVectorEnv
from ..learned.features import FeatureConfig
from ..learned.pilot import Pilot, PilotConfig
from .curriculum import Curriculum
from .rewards import RewardWeights, TrainingReward
from .whole import WholeVecEnv

Inputs = dict[str, NDArray[np.float32]]


def input_space(config: FeatureConfig) -> spaces.Dict:
    """Return the space of the network's inputs."""
    return spaces.Dict({name: spaces.Box(-np.inf, np.inf, shape, np.float32) for name, shape in config.shapes.items()})


class FollowerVecEnv(WholeVecEnv):
    """Several follow environments for stable-baselines3.

    An ended episode is followed by the next one of the curriculum in the same step; `info["terminal_observation"]`,
    `info["TimeLimit.truncated"]`, `info["episode"]` (training return `r`, length `l`) and `info["is_success"]` tell of
    the end, as stable-baselines3 expects.

    Args:
        num_envs: How many.
        workers: Processes that share them.
        env: Keyword arguments of `FollowEnv`.
        pilot: Features and steering.
        rewards: Weights of the reward's terms.
        curriculum: Draws the episodes.
        max_episode_steps: Steps after which an episode is truncated.
    """

    def __init__(
        self,
        num_envs: int,
        workers: int,
        env: dict[str, Any],
        pilot: PilotConfig,
        rewards: RewardWeights,
        curriculum: Curriculum,
        max_episode_steps: int = MAX_EPISODE_STEPS,
    ) -> None:
        self._start = partial(
            FollowVectorEnv, num_envs, workers=workers, max_episode_steps=max_episode_steps,
            autoreset_mode=AutoresetMode.DISABLED, context="spawn", **env,
        )  # fmt: skip
        self._running: FollowVectorEnv | None = None
        scales = interface(make_config(env))
        super().__init__(num_envs, input_space(pilot.features), spaces.Box(-1.0, 1.0, (2,), np.float32))
        self._curriculum = curriculum
        self._pilots = [Pilot(pilot, scales) for _ in range(num_envs)]
        self._rewards = [TrainingReward(rewards, scales) for _ in range(num_envs)]
        self._totals, self._lengths = np.zeros(num_envs), np.zeros(num_envs, dtype=int)
        self._actions = np.zeros((num_envs, 2))

    def reset(self) -> Inputs:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Start an episode in every environment."""
        self._inner.reset(seed=0)  # only some at a time can be reset after this
        return _stack([self._begin(i) for i in range(self.num_envs)])

    def step_async(self, actions: NDArray[np.floating]) -> None:
        """Keep the outputs (num_envs, 2) of the network."""
        self._actions = np.stack([pilot.drive(row) for pilot, row in zip(self._pilots, actions, strict=True)])

    def step_wait(self) -> VecEnvStepReturn:
        """Drive for one step; see the class for `infos`."""
        batch, _, terminated, truncated, raw = self._inner.step(self._actions)
        ended = terminated | truncated
        rewards, told, infos = np.zeros(self.num_envs, dtype=np.float32), [], []
        for i, pilot in enumerate(self._pilots):
            observation = {key: value[i] for key, value in batch.items()}
            own = {name: float(values[i]) for name, values in raw["reward_terms"].items() if not name.startswith("_")}
            coverage = float(raw["coverage"][i]) if "coverage" in raw else 0.0
            terms = self._rewards[i].terms(own, observation, pilot.commanded, coverage)
            rewards[i] = sum(terms.values())
            self._totals[i] += rewards[i]
            self._lengths[i] += 1
            cut = bool(truncated[i] and not terminated[i])
            info: dict[str, Any] = {"reward_terms": terms, "TimeLimit.truncated": cut}
            inputs = pilot.inputs(observation)
            if ended[i]:
                info |= self._end(i, inputs, bool(raw["is_success"][i]), str(raw["ending"][i]))
                inputs = self._begin(i)
            told.append(inputs)
            infos.append(info)
        return _stack(told), rewards, ended, infos  # pyright: ignore[reportReturnType]

    def close(self) -> None:
        """End the processes."""
        if self._running is not None:
            self._running.close()
            self._running = None

    @property
    def _inner(self) -> FollowVectorEnv:
        """The environments; their processes start when they are first needed, and are no forks of this one, whose
        threads they would lack.
        """
        if self._running is None:
            self._running = self._start()
        return self._running

    def _begin(self, i: int) -> Inputs:
        drawn = self._curriculum.draw()
        seeds: list[int | None] = [None] * self.num_envs
        seeds[i] = drawn.seed
        mask = np.arange(self.num_envs) == i
        batch, raw = self._inner.reset(seed=seeds, options={"reset_mask": mask, **drawn.options})
        self._pilots[i].reset()
        self._rewards[i].reset(float(raw["coverage"][i]) if "coverage" in raw else 0.0)
        self._totals[i], self._lengths[i] = 0.0, 0
        return self._pilots[i].inputs({key: value[i] for key, value in batch.items()})

    def _end(self, i: int, inputs: Inputs, success: bool, ending: str) -> dict[str, Any]:
        self._curriculum.report(success)
        return {
            "terminal_observation": inputs,
            "episode": {"r": float(self._totals[i]), "l": int(self._lengths[i]), "t": 0.0},
            "is_success": success,
            "ending": ending,
        }

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of the whole, once for each environment."""
        return [getattr(self, attr_name, None) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute of the whole."""
        setattr(self, attr_name, value)


def _stack(rows: list[Inputs]) -> Inputs:
    return {name: np.stack([row[name] for row in rows]) for name in rows[0]}
