"""Compiled worlds as training takes them: pooled observations and wishes, as tensors on the processor or a GPU."""

from typing import Any, NamedTuple

import numpy as np
import torch
from torch import Tensor

from ....envs import CompiledVectorEnv, CudaVectorEnv
from ....envs.task.endings import REASONS
from ...learned.steering import SteeringConfig
from ..tensor_env import TensorVectorEnv
from .guarding import WorldsGuard
from .pooled_tensors import PooledTensors, as_tensors
from .preset import WorldsPreset

TRUTH = 3
"""Numbers of the truth that the critic is told: distance of the leader, whether it is followed, for how long not."""
_CODES = {reason: code for code, reason in enumerate(REASONS)}
_DONE = REASONS.index("tour_done")


class Outcome(NamedTuple):
    """What came of a step of n worlds.

    Attributes:
        told: (n, size) what the network is told next.
        truth: (n, TRUTH) what the critic is told beside it.
        reward: (n,).
        over: (n,) whose episode is over; its next step begins another one, whatever is wished.
        failed: (n,) for whom nothing comes after. A tour that is done, or cut, is over, but not failed: the value of
            what would have followed is not lost, or the policy would learn to linger before the end.
        begun: (n,) whose episode began in this step: there was no choice in it.
        ending: (n,) number in `task.endings.REASONS`.
    """

    told: Tensor
    truth: Tensor
    reward: Tensor
    over: Tensor
    failed: Tensor
    begun: Tensor
    ending: Tensor


class TensorWorlds:
    """The worlds of a preset.

    Args:
        preset: Which worlds, and how they are driven.
        seed: Of the buildings that are drawn.
        workers: Threads that step the worlds on the processor; the same bytes for any number.
        device: "cpu", or "cuda" for worlds on a GPU.
    """

    def __init__(self, preset: WorldsPreset, seed: int, workers: int, device: str) -> None:
        self._preset, self.device, self.count = preset, device, preset.worlds
        self._env = _made(preset, seed, workers, device)
        interface = self._env.interface
        self._features = PooledTensors(preset.pooled, interface, self.count, device)
        self._scales = torch.tensor((interface.max_speed, interface.max_turn_rate), device=device)
        self._step_s = 1.0 / interface.control_hz
        self._commanded = torch.zeros((self.count, 4), device=device)
        guard = preset.guard
        self._guard = None if guard is None else WorldsGuard(guard, interface, self.count, device)
        self.begin_share(0.0)

    def begin_share(self, share: float) -> None:
        """Drive as the preset wants it after this share of the training's steps."""
        self._steering = self._preset.steering_at(share)

    def reset(self, seed: int) -> tuple[Tensor, Tensor]:
        """Start an episode in every world; return what the network and the critic are told."""
        batch, info = self._env.reset(seed=seed)
        self._commanded.zero_()
        self._over = torch.zeros(self.count, dtype=torch.bool, device=self.device)
        nothing = torch.zeros((self.count, 2), device=self.device)
        self._seen = as_tensors(batch, self.device)
        told = self._features.update(self._seen, nothing, ~self._over)
        return told.clone(), self._truth(info)

    def step(self, outputs: Tensor) -> Outcome:
        """Drive for one step by the network's outputs (n, 2)."""
        begun, c = self._over, self._preset.steering
        half, middle = 0.5 * (c.max_speed + c.reverse_speed), 0.5 * (c.max_speed - c.reverse_speed)
        cut = outputs.clamp(-1.0, 1.0)
        wishes = torch.stack((middle + half * cut[:, 0], c.max_turn_rate * cut[:, 1]), dim=1)
        if self._guard is not None:
            wishes = self._guard.limit(self._commanded, wishes, self._seen, self._steering)
        after = steered(self._commanded, wishes, self._step_s, self._steering)
        self._commanded = torch.where(begun[:, None], 0.0, after)
        actions = self._commanded[:, (0, 2)] / self._scales
        step: Any = self._env.step
        batch, reward, terminated, truncated, info = step(actions.numpy() if self.device == "cpu" else actions)
        self._seen = as_tensors(batch, self.device)
        told = self._features.update(self._seen, actions, begun).clone()
        reward, terminated, truncated = (
            torch.as_tensor(values, device=self.device) for values in (reward, terminated, truncated)
        )
        ending = self._endings(info["ending"])
        self._over = terminated | truncated
        cost = torch.where(self._over, 0.0, self._clearance_cost(told))
        reward = torch.where(begun, 0.0, (reward.float() - cost) * self._preset.reward_scale)
        failed = terminated & (ending != _DONE)
        return Outcome(told, self._truth(info), reward, self._over, failed, begun, ending)

    def _clearance_cost(self, told: Tensor) -> Tensor:
        """Return (n,) what the nearest return of the laser costs."""
        pooled = self._preset.pooled
        gap = -pooled.gap_scale * torch.log(told[:, : pooled.sectors].amax(dim=1).clamp(min=1e-30))
        times = 1.0 + self._preset.clearance_speed * self._commanded[:, 0].abs()
        return self._preset.clearance * times * (1.0 - gap / self._preset.clearance_m).clamp(min=0.0) ** 2

    def _truth(self, info: dict[str, Any]) -> Tensor:
        names = ("leader_distance", "following_leader", "lost_s")
        distance, follows, lost_s = (torch.as_tensor(info[name], device=self.device).float() for name in names)
        return torch.stack((distance / 3.0, follows, lost_s / 5.0), dim=1).clamp(max=4.0)

    def _endings(self, ending: Any) -> Tensor:
        if isinstance(ending, np.ndarray):
            ending = torch.tensor([_CODES[reason] for reason in ending])
        return ending

    def close(self) -> None:
        """End the worlds."""
        self._env.close()


def _made(preset: WorldsPreset, seed: int, workers: int, device: str) -> CompiledVectorEnv | TensorVectorEnv:
    made: dict[str, Any] = {
        "max_episode_steps": preset.most_steps, "autoreset_mode": "NextStep", "episodes_ahead": preset.episodes,
        "episodes_seed": seed, "kinds": preset.kinds, **preset.env,
    }  # fmt: skip
    if device == "cpu":
        return CompiledVectorEnv(preset.worlds, workers=min(workers, preset.worlds), **made)
    return TensorVectorEnv(CudaVectorEnv(preset.worlds, **made))


def steered(states: Tensor, wishes: Tensor, step_s: float, c: SteeringConfig) -> Tensor:
    """Do as `learned.steering.steer_many`: `states` (n, 4), `wishes` (n, 2) speed and turn rate; return (n, 4)."""
    v, a, w, b = states.unbind(1)
    brakes = (wishes[:, 0] - v) * v < 0.0
    most = torch.where(brakes, c.braking, c.acceleration)
    change = torch.where(brakes, c.brake_jerk, c.jerk) * step_s
    wanted = ((wishes[:, 0] - v) / c.settle_s).clamp(-most, most)
    a = wanted.clamp(a - change, a + change)
    turning = ((wishes[:, 1] - w) / c.turn_settle_s).clamp(-c.turn_acceleration, c.turn_acceleration)
    b = turning.clamp(b - c.turn_jerk * step_s, b + c.turn_jerk * step_s)
    v = (v + a * step_s).clamp(-c.reverse_speed, c.max_speed)
    w = (w + b * step_s).clamp(-c.max_turn_rate, c.max_turn_rate)
    return torch.stack((v, a, w, b), dim=1)
