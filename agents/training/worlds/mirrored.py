"""A network that treats left and right alike, whatever its weights.

The robot, its laser and its reward are the same in a mirror. A network that has to learn this needs twice the steps,
and never quite learns it. So hidden units come in pairs, of which one sees what the other sees in a mirror (van der Pol
et al. 2020, "MDP homomorphic networks"): half of the weights, at the same cost, in what is otherwise a dense network.
"""

import math
from typing import NamedTuple

import torch
from torch import Generator, Tensor, nn

from ....envs.wrappers.pooled_config import Mirror


class Dense(NamedTuple):
    """A layer: `weight` (out, in) and `bias` (out,)."""

    weight: Tensor
    bias: Tensor


class MirroredNetwork(nn.Module):
    """Two hidden layers with tanh; the first output is the same in a mirror, the second, if any, changes its sign.

    Args:
        mirror: What the inputs are in a mirror.
        width: Of the hidden layers, an even number.
        outputs: 1 or 2.
        gain: Of the last layer's first weights.
        draws: Of the first weights.
    """

    order: Tensor
    signs: Tensor

    def __init__(self, mirror: Mirror, width: int, outputs: int, gain: float, draws: Generator) -> None:
        super().__init__()
        half = width // 2
        self.register_buffer("order", torch.tensor(mirror.order), persistent=False)
        self.register_buffer("signs", torch.tensor(mirror.signs), persistent=False)
        self.first = _weights(half, len(mirror.order), math.sqrt(2.0), draws)
        self.second = _weights(half, width, math.sqrt(2.0), draws)
        self.last = _weights(outputs, half, gain, draws)
        self.first_bias, self.second_bias = (nn.Parameter(torch.zeros(half)) for _ in range(2))
        self.last_bias = nn.Parameter(torch.zeros(1))

    def layers(self) -> tuple[Dense, Dense, Dense]:
        """Return the network as dense layers of all units, those of the mirror in the second half."""
        first = torch.cat((self.first, self.first[:, self.order] * self.signs))
        second = torch.cat((self.second, self.second.roll(self.second.shape[1] // 2, 1)))
        ahead, aside = self.last[:1], self.last[1:]
        last = torch.cat((torch.cat((ahead, ahead), dim=1), torch.cat((aside, -aside), dim=1)))
        bias = nn.functional.pad(self.last_bias, (0, len(self.last) - 1))
        return Dense(first, self.first_bias.repeat(2)), Dense(second, self.second_bias.repeat(2)), Dense(last, bias)

    def forward(self, inputs: Tensor) -> Tensor:
        """Return (n, outputs) for inputs (n, k)."""
        first, second, last = self.layers()
        hidden = torch.tanh(nn.functional.linear(inputs, first.weight, first.bias))
        hidden = torch.tanh(nn.functional.linear(hidden, second.weight, second.bias))
        return nn.functional.linear(hidden, last.weight, last.bias)


def _weights(outputs: int, inputs: int, gain: float, draws: Generator) -> nn.Parameter:
    return nn.Parameter(nn.init.orthogonal_(torch.empty(outputs, inputs), gain, generator=draws))
