"""Reinforcement by stable-baselines3, with evaluations, checkpoints and an end by the clock."""

from collections.abc import Callable
from typing import Any

from stable_baselines3.common.callbacks import BaseCallback

from .models import actor_parts
from .presets import ReinforcementConfig


class TrainingMonitor(BaseCallback):
    """Counts rollouts; freezes the actor for the first ones; calls back after each, when what was learned is in place.

    Args:
        config: How long the actor is frozen.
        rollouts: Rollouts done before.
        after_rollout: Called with the number of rollouts done; what it raises ends training.
    """

    def __init__(self, config: ReinforcementConfig, rollouts: int, after_rollout: Callable[[int], None]) -> None:
        super().__init__()
        self._config, self._rollouts, self._after = config, rollouts, after_rollout
        self._next = 0

    def _on_training_start(self) -> None:
        self._next = self.num_timesteps + self._length
        self._freeze()

    @property
    def _length(self) -> int:
        return self._config.rollout * self._config.num_envs

    def _on_rollout_start(self) -> None:
        if self.num_timesteps >= self._next:
            self._next = self.num_timesteps + self._length
            self._rollouts += 1
            self._freeze()
            self._after(self._rollouts)

    def _on_step(self) -> bool:
        return True

    def _freeze(self) -> None:
        moves = self._rollouts >= self._config.critic_rollouts
        for part in actor_parts(self.model):
            for parameter in part.parameters():
                parameter.requires_grad_(moves)
        deviation: Any = getattr(self.model.policy, "log_std", None)
        if deviation is not None:
            deviation.requires_grad_(moves)
