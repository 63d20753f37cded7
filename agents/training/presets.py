"""What is trained, on what, for how long: presets by name, in code."""

from dataclasses import dataclass, field
from typing import Any

from ...slam.errors import InputError, unknown_name
from ..learned.features import FeatureConfig
from ..learned.pilot import PilotConfig
from ..learned.steering import SteeringConfig
from .curriculum import CurriculumConfig
from .rewards import RewardWeights

ALGORITHMS = ("ppo", "sac", "recurrent-ppo")
FAST = {"slam": None, "beams": 360}
"""Environment of training: no map is built and the laser is coarse, which is several times faster."""


@dataclass(frozen=True, kw_only=True)
class ImitationConfig:
    """Imitation of the teacher, by DAgger (Ross et al. 2011): the policy drives more and more, the teacher corrects.

    Attributes:
        rounds: How many rounds of driving and fitting; 0 for none.
        drives: Episodes of each round.
        teacher_share: Share of the driving that the teacher does in the first round; it halves from round to round.
        noise: Deviation of the noise on the teacher's driving, in the network's units.
        most_steps: Steps after which a drive is cut.
        epochs: Passes over everything gathered so far, in each round.
        last_epochs: The same after the last round.
        batch: Steps in a batch.
        learning_rate: Of Adam; falls to a tenth within each round's fit.
        steering: Of the drives.
        lost_weight: What a step counts while the leader is not seen: the teacher knows where it is, the policy cannot.
    """

    rounds: int = 0
    drives: int = 30
    teacher_share: float = 1.0
    noise: float = 0.15
    most_steps: int = 700
    epochs: int = 4
    last_epochs: int = 12
    batch: int = 512
    learning_rate: float = 1e-3
    steering: SteeringConfig = field(
        default_factory=lambda: SteeringConfig(settle_s=0.35, jerk=4.0, brake_jerk=8.0, wish_s=0.0)
    )
    lost_weight: float = 0.4

    def __post_init__(self) -> None:
        if self.rounds < 0 or min(self.drives, self.most_steps, self.epochs, self.batch) < 1:
            raise InputError("imitation needs rounds >= 0 and at least one drive, step, epoch and step in a batch")


@dataclass(frozen=True, kw_only=True)
class ReinforcementConfig:
    """Reinforcement after it.

    Attributes:
        steps: Steps of all environments together; 0 for none.
        num_envs: Environments side by side.
        rollout: Steps of each environment between two updates (PPO, RecurrentPPO), or two checkpoints (SAC).
        learning_rate: Of Adam.
        gamma: Discount.
        log_deviation: Logarithm of the deviation of the exploration at first (PPO, RecurrentPPO).
        critic_rollouts: Rollouts at first in which only the critic learns; a poor one would spoil what was imitated.
        evaluate_every: Rollouts between two evaluations.
    """

    steps: int = 300_000
    num_envs: int = 8
    rollout: int = 512
    learning_rate: float = 1e-4
    gamma: float = 0.98
    log_deviation: float = -1.2
    critic_rollouts: int = 0
    evaluate_every: int = 8


@dataclass(frozen=True, kw_only=True)
class TrainingPreset:
    """Everything that training depends on, but for the seed.

    Attributes:
        algo: "ppo", "sac" or "recurrent-ppo".
        env: Keyword arguments of `FollowEnv` in reinforcement.
        fine: Those that differ in every second demonstration and in evaluations: the finer laser that is driven with.
        pilot: Features and steering.
        rewards: Weights of the reward.
        curriculum: Which episodes.
        imitation: Before reinforcement.
        reinforcement: After imitation.
        width: Width of the dense layers.
        evaluations: Held-out episodes of each evaluation.
        most_steps: Steps after which an episode is cut.
    """

    algo: str = "ppo"
    env: dict[str, Any] = field(default_factory=lambda: dict(FAST))
    fine: dict[str, Any] = field(default_factory=lambda: {"beams": 1081})
    pilot: PilotConfig = field(default_factory=PilotConfig)
    rewards: RewardWeights = field(default_factory=RewardWeights)
    curriculum: CurriculumConfig = field(default_factory=CurriculumConfig)
    imitation: ImitationConfig = field(default_factory=ImitationConfig)
    reinforcement: ReinforcementConfig = field(default_factory=ReinforcementConfig)
    width: int = 128
    evaluations: int = 12
    most_steps: int = 900

    def __post_init__(self) -> None:
        if self.algo not in ALGORITHMS:
            raise unknown_name("algorithm", self.algo, ALGORITHMS)
        if self.imitation.rounds and self.algo == "recurrent-ppo":
            raise InputError("imitation shows single steps, which teaches a recurrent policy nothing: set no rounds")


def _office(algo: str) -> TrainingPreset:
    if algo == "ppo":
        return TrainingPreset(
            imitation=ImitationConfig(rounds=10), reinforcement=ReinforcementConfig(critic_rollouts=6)
        )
    return TrainingPreset(algo=algo)


def _office_map(algo: str) -> TrainingPreset:
    plain = _office(algo)
    return TrainingPreset(
        algo=algo,
        env={"slam": "gmapping", "beams": 360, "coverage": True},
        pilot=PilotConfig(features=FeatureConfig(map_cells=32)),
        imitation=plain.imitation,
        reinforcement=plain.reinforcement,
    )


def _corridor(algo: str) -> TrainingPreset:
    return TrainingPreset(
        algo=algo,
        curriculum=CurriculumConfig(scenes=(("corridor", 1.0),), bystanders=(1,)),
        imitation=ImitationConfig(rounds=3 if algo == "ppo" else 0, drives=12),
        reinforcement=ReinforcementConfig(steps=60_000, critic_rollouts=4 if algo == "ppo" else 0),
    )


PRESETS = {"office": _office, "office-map": _office_map, "corridor": _corridor}
"""Name -> the preset for an algorithm. "office": all scenes of the suites; "office-map": the network is told the map,
too, and new floor is rewarded; "corridor": a small one."""


def make_preset(name: str, algo: str) -> TrainingPreset:
    """Return a preset.

    Raises:
        InputError: If there is none of that name, or no such algorithm.
    """
    if name not in PRESETS:
        raise unknown_name("preset", name, tuple(PRESETS))
    if algo not in ALGORITHMS:
        raise unknown_name("algorithm", algo, ALGORITHMS)
    return PRESETS[name](algo)
