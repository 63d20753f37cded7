"""What reinforcement from nothing is done with: worlds, network, PPO."""

from dataclasses import dataclass, field, replace
from typing import Any

from ....envs.wrappers.pooled_config import PooledConfig
from ....slam.errors import InputError
from ...learned.guard import GuardConfig
from ...learned.steering import SteeringConfig

BEAMS = 360
"""Of the laser in training; the policy is told sectors, of which a finer laser makes the same."""

CONTACT = 100.0
"""What a contact costs: at the 20 of the environment's own reward the policy took as many as paid."""

MOST_QUICK = 10.0
"""Times: a robot that settles within a step of the control is no quicker for more."""


_HURRIED = {"leader_style": "hurried"}
_BLIND = {"heedless": 1.0}
KINDS: tuple[dict[str, Any], ...] = (
    {"scene": "office"},
    {"scene": "office", "people": None, **_BLIND},
    {"scene": "office", "people": None, **_HURRIED},
    {"scene": "office", "people": 8, "heedless": 0.5},
    {"scene": "office", "people": 13},
    {"scene": "office", "people": 13, **_BLIND, **_HURRIED},
    {"scene": "office", "people": 6, "odometry": "slipping"},
    {"scene": "tight_office", "people": None},
    {"scene": "tight_office", "people": 7, **_BLIND},
    {"scene": "tight_office", "people": 11, **_BLIND, **_HURRIED},
    {"scene": "tight_office", "people": 9, "odometry": "slipping", **_HURRIED},
    {"scene": "tight_office", "people": 2, **_HURRIED},
    {"scene": "tight_office", "people": 13, **_BLIND},
    {"scene": "tight_office", "people": 5},
    {"scene": "floor_plan", "people": None},
    {"scene": "floor_plan", "people": 6, **_BLIND},
    {"scene": "corridor", "people": 3},
    {"scene": "corridor", "people": 6, "odometry": "slipping", **_BLIND},
    {"scene": "meeting_room", "people": 3},
    {"scene": "meeting_room", "people": 6, **_BLIND},
    {"scene": "narrow_corridor", "people": 8},
    {"scene": "narrow_corridor", "people": 12, **_BLIND},
    {"scene": "clutter", "people": 10},
    {"scene": "clutter", "people": 14, **_BLIND},
    {"scene": "doorway", "people": 8, "heedless": 0.5},
    {"scene": "intersection", "people": 10, **_BLIND},
)
"""Kinds of episodes, as options of `reset`. Offices are of the training half alone; `narrow_doors`, `tight_doorway`,
`wide_corridor`, `busy_crossing` and `packed_clutter` of the hard suites are kept for tests."""


@dataclass(frozen=True, kw_only=True)
class WorldsPreset:
    """Everything that the training depends on, but for the seed.

    Attributes:
        kinds: Of the episodes; building k is of the k-th, and round again.
        worlds: How many are stepped side by side.
        episodes: How many are drawn; four share a building.
        env: Further keyword arguments of the environments.
        pooled: What the network is told.
        steering: How its wishes are driven.
        guard: The safety filter that they pass, in training as later; None for none.
        steps: Of all worlds together.
        rollout: Steps of each world between two updates.
        batch: Steps in a batch.
        epochs: Passes over a rollout.
        learning_rate: Of Adam at first; later it follows the divergence, below a bound that falls to a tenth of it.
        divergence: Of the policy from the one that drove, in a step of the descent, that is aimed at [nat].
        gamma: Discount.
        gae_lambda: Of generalised advantages.
        deviation: Of the exploration at first, of outputs in [-1, 1].
        last_deviation: At the end; between them it falls by the same share a step.
        quick: How many times as quick the steering is at first: its time constants divided, its jerks multiplied by the
            square of this.
        smoothness: Weight, in the loss, of the square of the change of the outputs from a step to the next.
        clearance: What it costs in a step to stand `clearance_m` nearer than that to a return of the laser; less, by
            the square, for less.
        clearance_m: Gap below which it costs [m].
        clearance_speed: So much more it costs, times, for each 1 m/s: who is near to something is to be slow.
        reward_scale: Rewards are multiplied by this, so that values are of order one.
        width: Of the two hidden layers of actor and critic each, an even number.
        most_steps: Steps after which an episode is cut.
    """

    kinds: tuple[dict[str, Any], ...] = KINDS
    worlds: int = 256
    episodes: int = 1040
    env: dict[str, Any] = field(
        default_factory=lambda: {"beams": BEAMS, "people": "tracker", "reward.collision": CONTACT}
    )
    pooled: PooledConfig = field(default_factory=lambda: PooledConfig(gap_scale=0.5))
    steering: SteeringConfig = field(
        default_factory=lambda: SteeringConfig(
            settle_s=0.35, turn_settle_s=0.25, jerk=4.0, brake_jerk=8.0, turn_jerk=16.0, wish_s=0.0
        )
    )
    guard: GuardConfig | None = field(default_factory=GuardConfig)
    steps: int = 4_000_000
    rollout: int = 64
    batch: int = 2048
    epochs: int = 4
    learning_rate: float = 5e-4
    divergence: float = 0.01
    gamma: float = 0.985
    gae_lambda: float = 0.95
    deviation: float = 0.5
    last_deviation: float = 0.12
    quick: float = 2.0
    smoothness: float = 1.5
    clearance: float = 1.0
    clearance_m: float = 0.3
    clearance_speed: float = 2.0
    reward_scale: float = 0.05
    width: int = 128
    most_steps: int = 1500

    def __post_init__(self) -> None:
        if not self.kinds:
            raise InputError("reinforcement needs at least one kind of episodes")
        if min(self.worlds, self.steps, self.rollout, self.batch, self.epochs, self.width, self.most_steps) < 1:
            raise InputError("reinforcement needs at least one world, step, epoch, step in a batch and unit of a layer")
        if self.width % 2:
            raise InputError(f"units of a layer come in pairs: `width` must be even, got {self.width}")
        if not 0.0 < self.last_deviation <= self.deviation:
            raise InputError(
                f"reinforcement needs `deviation` >= `last_deviation` > 0, got {self.deviation:g} and "
                f"{self.last_deviation:g}"
            )
        if not (1.0 <= self.quick <= MOST_QUICK and self.clearance >= 0.0 and self.clearance_m > 0.0):
            raise InputError(
                f"reinforcement needs `quick` from 1 to {MOST_QUICK:g}, `clearance` >= 0 and `clearance_m` > 0, got "
                f"{self.quick:g}, {self.clearance:g} and {self.clearance_m:g}"
            )
        if min(self.clearance_speed, self.smoothness) < 0.0:
            raise InputError(
                f"reinforcement needs `clearance_speed` and `smoothness` >= 0, got {self.clearance_speed:g} and "
                f"{self.smoothness:g}"
            )

    def smooth_at(self, share: float) -> float:
        """Return how smoothly it is driven after a share of the steps, 0 quick to 1 as the policy is used.

        A third of the training each: quick, on the way, smooth. Where the robot does at once what it is told, what a
        wish brings is learned soon; a habit once learned bears being slowed down, but is not found by who is slow.
        """
        return min(max(3.0 * share - 1.0, 0.0), 1.0)

    def deviation_at(self, share: float) -> float:
        """Return the deviation of the exploration after a share of the steps.

        Where it was learned it fell to 0.04 within the first half, for noise costs: then nothing new was tried, and
        what a step may change, which is counted in deviations, was next to nothing.
        """
        return self.deviation * (self.last_deviation / self.deviation) ** share

    def steering_at(self, share: float) -> SteeringConfig:
        """Return how the wishes are driven after a share of the steps, see `smooth_at`."""
        times = self.quick + (1.0 - self.quick) * self.smooth_at(share)
        c = self.steering
        return replace(
            c, settle_s=c.settle_s / times, turn_settle_s=c.turn_settle_s / times, jerk=c.jerk * times**2,
            brake_jerk=c.brake_jerk * times**2, turn_jerk=c.turn_jerk * times**2,
        )  # fmt: skip


def gpu_preset() -> WorldsPreset:
    """Return the preset for a GPU: a hundred times the steps, in a hundred times the worlds, for a wider network.

    The tracker's kernels are the processor's alone: people are known by the model of its errors there.
    """
    preset = WorldsPreset(worlds=32_768, rollout=32, batch=131_072, steps=400_000_000, width=256)
    return replace(preset, env={**preset.env, "people": "modelled"})


def preset_for(device: str) -> WorldsPreset:
    """Return the preset for a `device`, "cpu" or "cuda"."""
    return gpu_preset() if device == "cuda" else WorldsPreset()
