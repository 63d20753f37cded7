"""The pooled observation as tensors: `envs.wrappers.PooledFeatures` on whatever device the worlds are."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from torch import Tensor

from ....envs.task.interface import FollowInterface
from ....envs.wrappers.pooled_config import LIMIT, PooledConfig
from ....envs.wrappers.pooled_features import NEVER_S, body_ranges


class PooledTensors:
    """Remembers what the episodes of some worlds have shown, and tells it; for a robot with two wheels driven.

    The numbers are those of `PooledFeatures`, within the rounding of 32 bits (tested).

    Args:
        config: What is told.
        interface: Scales of the environment.
        count: How many worlds.
        device: Of the tensors.
    """

    def __init__(self, config: PooledConfig, interface: FollowInterface, count: int, device: str) -> None:
        beams = len(interface.bearings)
        self._config, self._step_s, self._range_max = config, 1.0 / interface.control_hz, interface.range_max
        self._body = torch.as_tensor(body_ranges(interface), dtype=torch.float32, device=device)
        starts = np.floor(np.arange(config.sectors + 1) * beams / config.sectors).astype(int)
        widest = int(np.diff(starts).max())
        beams_of = np.minimum(starts[:-1, None] + np.arange(widest), starts[1:, None] - 1)
        self._beams = torch.as_tensor(beams_of, device=device)
        self._unseen_s = torch.full((count,), NEVER_S, device=device)
        self._trail = torch.zeros((count, config.trail, 2), device=device)
        self._actions = torch.zeros((count, config.actions, 2), device=device)
        self._stack = torch.zeros((count, config.stack, config.size() // config.stack), device=device)

    def update(self, batch: Mapping[str, Tensor], actions: Tensor, fresh: Tensor) -> Tensor:
        """Return (n, size) what is told after a step.

        Args:
            batch: Observations.
            actions: (n, 2) that led to them.
            fresh: (n,) whose episode has just begun.
        """
        begun = fresh[:, None, None]
        self._unseen_s = torch.where(fresh, NEVER_S, self._unseen_s)
        self._trail = torch.where(begun, 0.0, self._trail)
        if self._config.actions:
            done = torch.cat((actions.float().clamp(-1.0, 1.0)[:, None], self._actions[:, :-1]), dim=1)
            self._actions = torch.where(begun, 0.0, done)
        now = self._now(batch)[:, None]
        self._stack = torch.where(begun, now, torch.cat((now, self._stack[:, :-1]), dim=1))
        return self._stack.flatten(1)

    def _now(self, batch: Mapping[str, Tensor]) -> Tensor:
        leader, velocity = batch["leader"], batch["velocity"]
        self._remember(leader, velocity)
        parts = (
            self._sectors(batch["scan"]),
            self._leader(leader),
            self._trail.flatten(1) / self._config.length_scale,
            self._people(batch["people"]),
            velocity,
            self._actions.flatten(1),
        )
        return torch.cat(parts, dim=1).clamp(-LIMIT, LIMIT)

    def _sectors(self, scan: Tensor) -> Tensor:
        gaps = (scan * self._range_max - self._body)[:, self._beams].amin(dim=2)
        return torch.exp(-gaps.clamp(min=0.0) / self._config.gap_scale)

    def _leader(self, leader: Tensor) -> Tensor:
        """Return (n, 11) the leader, names `LEADER_NAMES`."""
        away = torch.hypot(leader[:, 0], leader[:, 1])[:, None]
        place, scale, unseen = leader[:, 0:2], self._config.length_scale, self._unseen_s[:, None]
        return torch.cat(
            (place / scale, leader[:, 2:4], away / scale, place / away.clamp(min=1e-3), leader[:, 4:6],
             (unseen < NEVER_S).float(), unseen / self._config.unseen_scale),
            dim=1,
        )  # fmt: skip

    def _people(self, people: Tensor) -> Tensor:
        shown = people[:, : self._config.people]
        away, there = torch.hypot(shown[..., 0], shown[..., 1])[..., None], shown[..., 5:6]
        told = torch.cat(
            (shown[..., 0:2] / self._config.length_scale, shown[..., 2:4], torch.exp(-away) * there, there), dim=2
        )
        lacking = self._config.people - shown.shape[1]
        return torch.nn.functional.pad(told, (0, 0, 0, lacking)).flatten(1)

    def _remember(self, leader: Tensor, velocity: Tensor) -> None:
        """Carry the trail into the robot frame of now, and take note of a leader who is seen."""
        c, x = self._config, self._trail[..., 0] - self._step_s * velocity[:, 0:1]
        y, turned = self._trail[..., 1], velocity[:, 1:2] * self._step_s
        cos, sin = torch.cos(turned), torch.sin(turned)
        trail = torch.stack((cos * x + sin * y, cos * y - sin * x), dim=2)
        seen, fresh, place = leader[:, 5] > 0.5, self._unseen_s >= NEVER_S, leader[:, None, 0:2]
        apart = torch.hypot(*(trail[:, 0] - leader[:, 0:2]).unbind(1))
        new = seen & (fresh | (apart > c.trail_jump))
        on = seen & ~new & (apart > c.trail_spacing)
        trail = torch.where(new[:, None, None], place, trail)
        trail = torch.where(on[:, None, None], torch.cat((place, trail[:, :-1]), dim=1), trail)
        self._trail = torch.where((fresh & ~seen)[:, None, None], 0.0, trail)
        waited = torch.where(fresh, NEVER_S, (self._unseen_s + self._step_s).clamp(max=0.5 * NEVER_S))
        self._unseen_s = torch.where(seen, 0.0, waited)


def as_tensors(batch: Mapping[str, Any], device: str) -> dict[str, Tensor]:
    """Return a batch of observations as tensors."""
    return {name: torch.as_tensor(values, device=device) for name, values in batch.items()}
