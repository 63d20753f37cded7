"""Proximal policy optimisation (Schulman et al. 2017) on tensors that never leave their device.

The critic is told the truth beside what the actor sees (Pinto et al. 2018): it is not needed to drive. The learning
rate follows the divergence of the policy from the one that drove (Schulman et al. 2017, section 4; so do Rudin et al.
2022 with thousands of worlds), below a bound that falls with the training.

That outputs change little from a step to the next is asked of the network itself (Mysore et al. 2021). A reward that
charges jerk charges the exploration's noise, too: the policy then learned to wish beyond the limits, where noise makes
no difference, and drove into things at full speed.
"""

import math
from dataclasses import dataclass

import torch
from torch import Generator, Tensor, nn

from ....envs.wrappers.pooled_config import Mirror
from .mirrored import MirroredNetwork
from .preset import WorldsPreset
from .tensor_worlds import TRUTH, Outcome

_CLIP = 0.2  # of the ratio of new and old probability
_VALUE = 0.5  # weight of the critic's loss
_MOST_NORM = 0.5  # of a gradient
_LEAST_RATE, _MOST_RATE = 1e-5, 2e-3
_RATE_STEP = 1.5


class ActorCritic(nn.Module):
    """Two networks.

    Args:
        mirror: What the actor is told in a mirror.
        width: Of the hidden layers.
        seed: Of the first weights.
    """

    def __init__(self, mirror: Mirror, width: int, seed: int) -> None:
        super().__init__()
        draws, told = Generator().manual_seed(seed), len(mirror.order)
        with_truth = Mirror((*mirror.order, *range(told, told + TRUTH)), (*mirror.signs, *[1.0] * TRUTH))
        self.actor = MirroredNetwork(mirror, width, 2, 0.01, draws)
        self.critic = MirroredNetwork(with_truth, width, 1, 1.0, draws)

    def value(self, told: Tensor, truth: Tensor) -> Tensor:
        """Return (n,) the critic's guess of the return."""
        return self.critic(torch.cat((told, truth), dim=1))[:, 0]


def log_probability(outputs: Tensor, mean: Tensor, deviation: float) -> Tensor:
    """Return (n,) the logarithm of the density of `outputs` (n, 2) around `mean` (n, 2)."""
    apart = (outputs - mean) / deviation
    return (-0.5 * apart**2).sum(dim=1) - 2.0 * math.log(deviation * math.sqrt(2.0 * math.pi))


@dataclass
class Rollout:
    """What t steps of n worlds have shown, explored with `deviation`; (t, n, ...), of `told` and `truth` one more."""

    told: Tensor
    truth: Tensor
    outputs: Tensor
    log_probability: Tensor
    mean: Tensor
    reward: Tensor
    over: Tensor
    failed: Tensor
    begun: Tensor
    deviation: float

    @staticmethod
    def of(steps: int, told: Tensor, truth: Tensor, deviation: float) -> "Rollout":
        """Return an empty rollout that begins with what is told now, and explores with this deviation."""
        n = len(told)

        def room(count: int, *shape: int, kind: torch.dtype = torch.float32) -> Tensor:
            return torch.zeros((count, n, *shape), dtype=kind, device=told.device)

        over, failed, begun = (room(steps, kind=torch.bool) for _ in range(3))
        whole = Rollout(
            room(steps + 1, told.shape[1]), room(steps + 1, truth.shape[1]), room(steps, 2), room(steps),
            room(steps, 2), room(steps), over, failed, begun, deviation,
        )  # fmt: skip
        whole.told[0], whole.truth[0] = told, truth
        return whole

    def put(self, t: int, outcome: Outcome) -> None:
        """Take note of what came of step t."""
        self.told[t + 1], self.truth[t + 1], self.reward[t] = outcome.told, outcome.truth, outcome.reward
        self.over[t], self.failed[t], self.begun[t] = outcome.over, outcome.failed, outcome.begun


class Learner:
    """Learns from rollouts.

    Args:
        preset: How.
        seed: Of weights, explorations and batches.
        device: Of all tensors.
    """

    def __init__(self, preset: WorldsPreset, seed: int, device: str) -> None:
        self._preset, self.device = preset, device
        self.model = ActorCritic(preset.pooled.mirror(), preset.width, seed).to(device)
        self.optimizer = torch.optim.Adam(self.model.parameters(), lr=preset.learning_rate, eps=1e-5)
        self.begin_draws(seed)

    def begin_draws(self, seed: int) -> None:
        """Begin the random draws anew."""
        self._draws = Generator(self.device).manual_seed(seed)

    @torch.no_grad()
    def explore(self, rollout: Rollout, t: int) -> Tensor:
        """Return (n, 2) outputs for what step t is told, with noise; the rollout takes note."""
        mean = self.model.actor(rollout.told[t])
        noise = torch.randn(mean.shape, generator=self._draws, device=self.device)
        rollout.mean[t], rollout.outputs[t] = mean, mean + rollout.deviation * noise
        rollout.log_probability[t] = log_probability(rollout.outputs[t], mean, rollout.deviation)
        return rollout.outputs[t]

    def learn(self, rollout: Rollout, share: float) -> dict[str, float]:
        """Learn from a rollout, after a share of the training; return figures of it."""
        advantages, returns = self._advantages(rollout)
        chosen = (~rollout.begun).flatten().nonzero()[:, 0]
        goes_on = (~(rollout.over | rollout.begun)).float()
        flat = (
            rollout.told[:-1], rollout.truth[:-1], rollout.outputs, rollout.log_probability, rollout.mean, advantages,
            returns, rollout.told[1:], goes_on,
        )  # fmt: skip
        columns = [part.flatten(0, 1) for part in flat]
        most = _MOST_RATE + (self._preset.learning_rate * 0.1 - _MOST_RATE) * share
        divergence, loss = 0.0, 0.0
        for _ in range(self._preset.epochs):
            order = chosen[torch.randperm(len(chosen), generator=self._draws, device=self.device)]
            for rows in order.split(self._preset.batch):
                divergence, loss = self._descend([part[rows] for part in columns], rollout.deviation)
                self._adapt_rate(divergence, most)
        return {"divergence": divergence, "value_loss": loss, "rate": self.optimizer.param_groups[0]["lr"]}

    @torch.no_grad()
    def _advantages(self, rollout: Rollout) -> tuple[Tensor, Tensor]:
        """Return (t, n) generalised advantages (Schulman et al. 2016) and returns."""
        values = torch.stack([self.model.value(*row) for row in zip(rollout.told, rollout.truth, strict=True)])
        gamma, lam = self._preset.gamma, self._preset.gae_lambda
        advantages, later = torch.zeros_like(rollout.reward), torch.zeros_like(rollout.reward[0])
        for t in reversed(range(len(advantages))):
            follows = torch.where(rollout.failed[t], 0.0, values[t + 1])
            surprise = rollout.reward[t] + gamma * follows - values[t]
            later = surprise + gamma * lam * torch.where(rollout.over[t], 0.0, later)
            advantages[t] = later
        return advantages, advantages + values[:-1]

    def _descend(self, batch: list[Tensor], deviation: float) -> tuple[float, float]:
        """Take one step down; return the divergence from the policy that drove, and the critic's loss."""
        told, truth, outputs, before, mean_before, advantages, returns, told_next, goes_on = batch
        model = self.model
        mean = model.actor(told)
        ratio = (log_probability(outputs, mean, deviation) - before).exp()
        advantages = (advantages - advantages.mean()) / (advantages.std() + 1e-8) if len(advantages) > 1 else advantages
        gain = torch.minimum(ratio * advantages, ratio.clamp(1.0 - _CLIP, 1.0 + _CLIP) * advantages).mean()
        value_loss = (model.value(told, truth) - returns).square().mean()
        change = ((model.actor(told_next) - mean).square().sum(dim=1) * goes_on).mean()
        self.optimizer.zero_grad()
        (_VALUE * value_loss + self._preset.smoothness * change - gain).backward()
        nn.utils.clip_grad_norm_(model.parameters(), _MOST_NORM)
        self.optimizer.step()
        divergence = 0.5 * ((mean.detach() - mean_before) / deviation).square().sum(dim=1).mean()
        return float(divergence), float(value_loss.detach())

    def _adapt_rate(self, divergence: float, most: float) -> None:
        """Learn slower where the policy has moved far, faster where it has hardly."""
        group, wanted = self.optimizer.param_groups[0], self._preset.divergence
        times = 1.0 / _RATE_STEP if divergence > 2.0 * wanted else _RATE_STEP if divergence < 0.5 * wanted else 1.0
        group["lr"] = min(max(group["lr"] * times, _LEAST_RATE), most)
