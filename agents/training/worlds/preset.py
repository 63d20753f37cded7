"""What reinforcement from nothing is done with: worlds, network, PPO."""

from dataclasses import dataclass, field
from typing import Any

from ....envs.wrappers.pooled_config import PooledConfig
from ....slam.errors import InputError
from ...learned.steering import SteeringConfig

BEAMS = 360
"""Of the laser in training; the policy is told sectors, of which a finer laser makes the same."""


@dataclass(frozen=True, kw_only=True)
class WorldKind:
    """Worlds of one kind.

    Attributes:
        name: Of the scene.
        count: How many of them are stepped side by side.
        people: Walking people, the leader included; None draws them as the scene does.
        episodes: How many episodes are drawn; four share a building.
    """

    name: str
    count: int
    people: int | None = None
    episodes: int = 128


KINDS = (
    WorldKind(name="office", count=72, episodes=320),
    WorldKind(name="office", count=24, people=8, episodes=96),
    WorldKind(name="office", count=24, people=13, episodes=96),
    WorldKind(name="tight_office", count=40, episodes=160),
    WorldKind(name="floor_plan", count=24, episodes=64),
    WorldKind(name="corridor", count=24, people=3, episodes=64),
    WorldKind(name="meeting_room", count=16, people=3, episodes=64),
    WorldKind(name="narrow_corridor", count=16, people=8, episodes=64),
    WorldKind(name="clutter", count=16, people=10, episodes=64),
)
"""Offices of the training half alone; the other kinds of buildings in the hard suite are kept for tests."""


@dataclass(frozen=True, kw_only=True)
class WorldsPreset:
    """Everything that the training depends on, but for the seed.

    Attributes:
        kinds: The worlds.
        env: Further keyword arguments of the environments.
        pooled: What the network is told.
        steering: How its wishes are driven.
        steps: Of all worlds together.
        rollout: Steps of each world between two updates.
        batch: Steps in a batch.
        epochs: Passes over a rollout.
        learning_rate: Of Adam at first; it falls in a line to a tenth of it.
        gamma: Discount.
        gae_lambda: Of generalised advantages.
        log_deviation: Logarithm of the deviation of the exploration at first.
        jerk: What the square of the commanded jerk costs, beside the environments' own terms [1/(m/s^3)^2].
        turn_jerk: The same of the turn [1/(rad/s^3)^2].
        reward_scale: Rewards are multiplied by this, so that values are of order one.
        width: Of the two hidden layers of actor and critic each.
        most_steps: Steps after which an episode is cut.
    """

    kinds: tuple[WorldKind, ...] = KINDS
    env: dict[str, Any] = field(default_factory=lambda: {"beams": BEAMS, "lost_limit_s": 5.0})
    pooled: PooledConfig = field(default_factory=PooledConfig)
    steering: SteeringConfig = field(
        default_factory=lambda: SteeringConfig(
            settle_s=0.5, turn_settle_s=0.3, jerk=2.5, brake_jerk=6.0, turn_jerk=10.0, wish_s=0.0
        )
    )
    steps: int = 4_000_000
    rollout: int = 64
    batch: int = 2048
    epochs: int = 4
    learning_rate: float = 5e-4
    gamma: float = 0.985
    gae_lambda: float = 0.95
    log_deviation: float = -0.7
    jerk: float = 0.008
    turn_jerk: float = 0.0004
    reward_scale: float = 0.05
    width: int = 128
    most_steps: int = 1500

    def __post_init__(self) -> None:
        if not self.kinds or min(kind.count for kind in self.kinds) < 1:
            raise InputError("reinforcement needs at least one kind of worlds, and one world of each")
        if min(self.steps, self.rollout, self.batch, self.epochs, self.width, self.most_steps) < 1:
            raise InputError("reinforcement needs at least one step, epoch, step in a batch and unit of a layer")

    @property
    def worlds(self) -> int:
        """How many worlds are stepped side by side."""
        return sum(kind.count for kind in self.kinds)
