"""Vector environments for libraries with interfaces of their own: PufferLib and rsl_rl. Neither is imported."""

from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from ...slam.errors import InputError, MissingExtraError

Floats = NDArray[np.float32]

PRIVILEGED = "leader_distance", "following_leader", "lost_s"
"""What of the truth the group "privileged" of `RslRlVecEnv` holds, in this order: [m], 0 or 1, [s]."""


def require_same_step(env: VectorEnv[Any, Any, Any], library: str) -> None:
    """Raise InputError unless episodes are followed in the same step, as `library` wants it."""
    mode = env.metadata.get("autoreset_mode")
    if mode != AutoresetMode.SAME_STEP:
        raise InputError(f'{library} needs `autoreset_mode="SameStep"`, got {getattr(mode, "value", mode)!r}')


def flat_space(space: spaces.Space[Any]) -> spaces.Box:
    """Return the space of what `flat` makes of the observations of a `Dict` of boxes."""
    assert isinstance(space, spaces.Dict)
    low = np.concatenate([np.asarray(part.low).ravel() for part in _boxes(space)])
    high = np.concatenate([np.asarray(part.high).ravel() for part in _boxes(space)])
    return spaces.Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)


def _boxes(space: spaces.Dict) -> list[spaces.Box]:
    return [part for part in space.values() if isinstance(part, spaces.Box)]


def flat(batch: dict[str, NDArray[Any]], space: spaces.Space[Any]) -> Floats:
    """Return (n, k) the entries of a batch of observations one after the other, in the order of their space."""
    assert isinstance(space, spaces.Dict)
    return np.concatenate([batch[name].reshape(len(batch[name]), -1) for name in space], axis=1, dtype=np.float32)


class PufferWorlds:
    """A vector environment as PufferLib's native ones are: each world is an agent, in one buffer for all.

        env = gymnasium.make_vec(
            "tagalong/Office-v0", 256, "vector_entry_point", simulator="compiled", autoreset_mode="SameStep"
        )
        pufferlib.vector.make(PufferWorlds, env_kwargs={"env": env}, backend=pufferlib.PufferEnv)

    Observations are flat, in the order of the entries of `env.single_observation_space`. The infos of a step say what
    ended in it: mean return, length and share of successes of these episodes.

    Args:
        env: The environment; its episodes must be followed in the same step.
        buf: Buffers to write into, by PufferLib's names: observations, rewards, terminals, truncations, masks, actions.
        seed: Of the first reset where that is told none; environment i takes `seed` + i.

    Raises:
        InputError: If episodes are followed otherwise.
    """

    emulated, done = False, False

    def __init__(self, env: VectorEnv[Any, Any, Any], buf: dict[str, Any] | None = None, seed: int = 0) -> None:
        require_same_step(env, "PufferLib")
        self.env, self.num_agents, self.render_mode, self._seed = env, env.num_envs, env.render_mode, seed
        self.single_observation_space = flat_space(env.single_observation_space)
        self.single_action_space = env.single_action_space
        self.action_space, self.agent_ids = env.action_space, np.arange(self.num_agents)
        box, n = self.single_observation_space, self.num_agents
        self.observation_space = spaces.Box(np.tile(box.low, (n, 1)), np.tile(box.high, (n, 1)), dtype=np.float32)
        own: dict[str, NDArray[Any]] = {
            "observations": np.zeros((n, *box.shape), np.float32),
            "rewards": np.zeros(n, np.float32),
            "terminals": np.zeros(n, bool),
            "truncations": np.zeros(n, bool),
            "masks": np.ones(n, bool),
            "actions": np.zeros(env.action_space.shape or (), np.float32),
        }
        given = own if buf is None else buf
        self.observations, self.rewards, self.masks = given["observations"], given["rewards"], given["masks"]
        self.terminals, self.truncations = given["terminals"], given["truncations"]
        self.actions, self.infos = given["actions"], []
        self._returns, self._lengths = np.zeros(n), np.zeros(n, dtype=np.int64)

    @property
    def agents_per_batch(self) -> int:
        """How many agents act at once: all."""
        return self.num_agents

    @property
    def driver_env(self) -> "PufferWorlds":
        """The environment itself: it is no pool of others."""
        return self

    def reset(self, seed: int | None = None) -> tuple[Floats, list[dict[str, float]]]:
        """Start an episode in every world; return observations (n, k), and no infos."""
        batch, _ = self.env.reset(seed=self._seed if seed is None else seed)
        self.observations[:] = flat(batch, self.env.single_observation_space)
        self.rewards[:], self.terminals[:], self.truncations[:] = 0.0, False, False
        self._returns[:], self._lengths[:] = 0.0, 0
        return self.observations, []

    def step(self, actions: NDArray[Any]) -> tuple[Any, Any, Any, Any, list[dict[str, float]]]:
        """Drive for one step; return the buffers of observations, rewards, terminals, truncations, and infos."""
        self.actions[:] = actions
        batch, rewards, terminated, truncated, told = self.env.step(self.actions)
        self.observations[:] = flat(batch, self.env.single_observation_space)
        self.rewards[:], self.terminals[:], self.truncations[:] = rewards, terminated, truncated
        self._returns += rewards
        self._lengths += 1
        ended, infos = terminated | truncated, []
        if ended.any():
            infos.append({
                "episode_return": float(self._returns[ended].mean()),
                "episode_length": float(self._lengths[ended].mean()),
                "is_success": float(told["final_info"]["is_success"][ended].mean()),
            })  # fmt: skip
            self._returns[ended], self._lengths[ended] = 0.0, 0
        return self.observations, self.rewards, self.terminals, self.truncations, infos

    def async_reset(self, seed: int | None = None) -> None:
        """Reset; `recv` tells what of."""
        _, self.infos = self.reset(seed)

    def send(self, actions: NDArray[Any]) -> None:
        """Step; `recv` tells what of."""
        *_, self.infos = self.step(actions)

    def recv(self) -> tuple[Any, ...]:
        """Return observations, rewards, terminals, truncations, infos, ids of the agents, and masks."""
        told = self.observations, self.rewards, self.terminals, self.truncations
        return (*told, self.infos, self.agent_ids, self.masks)

    def close(self) -> None:
        """Close the environment."""
        self.env.close()


class RslRlVecEnv:
    """A vector environment as rsl_rl's `VecEnv` is: torch tensors, observations in groups of a `TensorDict`.

    The groups are "policy" (n, k), all entries flat, and "privileged" (n, 3), the truth of `PRIVILEGED` for a critic:
    `obs_groups = {"actor": ["policy"], "critic": ["policy", "privileged"]}`. The extras of a step are "time_outs" (n,)
    and, where episodes ended, "log".

    Args:
        env: The environment; its episodes must be followed in the same step.
        max_episode_length: Steps after which episodes are truncated, as rsl_rl is told it.
        device: Of the tensors.
        seed: Of the first episodes; environment i takes `seed` + i.

    Raises:
        InputError: If episodes are followed otherwise.
        MissingExtraError: Without torch, or tensordict, which rsl_rl brings.
    """

    def __init__(
        self, env: VectorEnv[Any, Any, Any], max_episode_length: int = 3000, device: str = "cpu", seed: int = 0
    ) -> None:
        require_same_step(env, "rsl_rl")
        try:
            import tensordict  # pyright: ignore[reportMissingImports]
            import torch
        except ImportError:
            raise MissingExtraError("rsl_rl, torch and tensordict", "learn") from None
        self._torch, self._table = torch, tensordict
        self.env, self.num_envs, self.device = env, env.num_envs, device
        self.num_actions = int((env.single_action_space.shape or (0,))[0])
        self.max_episode_length, self.cfg = max_episode_length, {}
        self.episode_length_buf = self._torch.zeros(self.num_envs, dtype=self._torch.long, device=device)
        batch, told = env.reset(seed=seed)
        self._observations = self._groups(batch, told)

    def get_observations(self) -> Any:
        """Return the present observations, a `TensorDict` of groups (n, k)."""
        return self._observations

    def step(self, actions: Any) -> tuple[Any, Any, Any, dict[str, Any]]:
        """Drive for one step by `actions` (n, a); return observations, rewards (n,), dones (n,), extras."""
        batch, rewards, terminated, truncated, told = self.env.step(actions.detach().cpu().numpy())
        self._observations, done = self._groups(batch, told), terminated | truncated
        self.episode_length_buf += 1
        ended = self._tensor(done)
        extras: dict[str, Any] = {"time_outs": self._tensor(truncated & ~terminated)}
        if done.any():
            success = float(told["final_info"]["is_success"][done].mean())
            length = float(self.episode_length_buf[ended].float().mean())
            extras["log"] = {"/is_success": success, "/episode_length": length}
            self.episode_length_buf[ended] = 0
        return self._observations, self._tensor(rewards.astype(np.float32)), ended, extras

    def close(self) -> None:
        """Close the environment."""
        self.env.close()

    def _tensor(self, values: NDArray[Any]) -> Any:
        return self._torch.as_tensor(values, device=self.device)

    def _groups(self, batch: dict[str, NDArray[Any]], told: dict[str, Any]) -> Any:
        truth = np.stack([np.asarray(told[name], dtype=np.float32) for name in PRIVILEGED], axis=1)
        groups = {
            "policy": self._tensor(flat(batch, self.env.single_observation_space)),
            "privileged": self._tensor(truth),
        }
        return self._table.TensorDict(groups, batch_size=[self.num_envs], device=self.device)
