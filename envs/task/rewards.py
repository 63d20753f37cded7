"""Reward terms: pure functions of what truly happened in one step. Their sum is the reward.

Shaping terms are per step of 0.1 s, scaled to the actual step, so that returns do not depend on the control rate.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import Within, check_numbers
from ...slam.errors import InputError, shown
from ...slam.view_kernel import kernel

Array = NDArray[np.float64]
_Weight = Annotated[float, Within(0.0, 1e6)]
_Length = Annotated[float, Within(1e-3, 1e3)]
_Angle = Annotated[float, Within(1e-3, math.pi)]
FOLLOWING_DISTANCE = 1.3
"""Wanted distance from the leader, centre to centre, where nothing else is said [m]."""
PERSONAL_SPACE_M = 0.45
"""Free space to bystanders below which the robot intrudes, where nothing else is said [m]."""


@dataclass(frozen=True, kw_only=True)
class StepFacts:
    """What truly happened in one step.

    Attributes:
        distance: Centre distance from the true leader [m]; NaN without one.
        bearing: Direction of the true leader in the robot frame [rad]; NaN without one.
        bystander_space: Free space to the nearest bystander [m]; inf without one.
        action_change: Euclidean norm of the change of the action since the last step.
        following_leader: Whether the robot sees a person as its leader who truly is.
        collided: Whether the robot touched a person or thing.
        tour_done: Whether the leader's tour is over.
        step_s: Length of the step [s].
        coverage: Share of the floor seen so far; NaN where it is not measured.
        newly_covered: What this step added to it.
    """

    distance: float
    bearing: float
    bystander_space: float
    action_change: float
    following_leader: bool
    collided: bool
    tour_done: bool
    step_s: float
    coverage: float = float("nan")
    newly_covered: float = 0.0


RewardTerm = Callable[[StepFacts], float]
"""A term of the reward: what a step is worth, of what truly happened in it."""
FOLLOWING_TERMS = ("distance", "facing", "personal_space", "smoothness", "lost", "collision", "tour")
EXPLORING_TERMS = ("coverage", "personal_space", "smoothness", "collision", "covered")


@dataclass(frozen=True, kw_only=True)
class RewardConfig:
    """Weights and shapes of the reward's terms, and further terms. A weight of 0 leaves a term at 0.

    Attributes:
        distance: Weight of `distance`.
        facing: Of `facing`.
        personal_space: Of `personal_space`, which is negative, as are the next three.
        smoothness: Of `smoothness`.
        lost: Of `lost`.
        collision: Of `collision`.
        tour: Of `tour`.
        coverage: Of `coverage`.
        covered: Of `covered`.
        following_distance: Wanted distance from the leader, centre to centre [m].
        distance_bound: So far off it is still perfect [m].
        distance_margin: So much farther off it is worth 0.1 [m].
        facing_bound: The leader may be so far aside [rad].
        facing_margin: So much farther aside it is worth 0.1 [rad].
        space: Free space to bystanders below which the robot intrudes [m].
        terms: Further terms: name -> function of `StepFacts`, which returns what is added to the reward of the step.
    """

    distance: _Weight = 1.0
    facing: _Weight = 0.2
    personal_space: _Weight = 1.0
    smoothness: _Weight = 0.1
    lost: _Weight = 0.2
    collision: _Weight = 20.0
    tour: _Weight = 20.0
    coverage: _Weight = 100.0
    covered: _Weight = 20.0
    following_distance: _Length = FOLLOWING_DISTANCE
    distance_bound: _Length = 0.15
    distance_margin: _Length = 0.85
    facing_bound: _Angle = 0.2
    facing_margin: _Angle = 1.2
    space: _Length = PERSONAL_SPACE_M
    terms: Mapping[str, RewardTerm] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_numbers(self)
        if not isinstance(self.terms, Mapping):
            raise InputError(f"`reward.terms` must be a table of names and functions, got {shown(self.terms)}")
        for name, function in self.terms.items():
            if not isinstance(name, str) or name in (*FOLLOWING_TERMS, *EXPLORING_TERMS):
                raise InputError(f"a term of `reward.terms` needs a name of its own, got {shown(name)}")
            if not callable(function):
                raise InputError(f"`reward.terms[{name!r}]` must be a function of `StepFacts`, got {shown(function)}")

    @property
    def weights(self) -> Array:
        """(7,) of the terms behind a leader, in the order of `FOLLOWING_TERMS`."""
        return np.array([float(getattr(self, name)) for name in FOLLOWING_TERMS])

    @property
    def shapes(self) -> Array:
        """(6,) following distance, distance's bound and margin [m], facing's [rad], personal space [m]."""
        distance = self.following_distance, self.distance_bound, self.distance_margin
        return np.array([*distance, self.facing_bound, self.facing_margin, self.space], dtype=np.float64)


def reward_terms(facts: StepFacts, config: RewardConfig) -> dict[str, float]:
    """Return each term behind a leader by name; the manual of `FollowEnv` gives formulas and reasons."""
    truth = np.array((facts.distance, facts.bearing, facts.bystander_space, facts.action_change))
    terms = np.empty(len(FOLLOWING_TERMS))
    flags = facts.following_leader, facts.collided, facts.tour_done
    following_terms(truth, *flags, facts.step_s, config.weights, config.shapes, terms)
    return {**dict(zip(FOLLOWING_TERMS, terms.tolist(), strict=True)), **further_terms(facts, config)}


@kernel
def following_terms(
    truth: Array,
    following: bool,
    collided: bool,
    done: bool,
    step_s: float,
    weights: Array,
    shapes: Array,
    terms: Array,
) -> None:
    """Write the terms behind a leader into `terms` (7,), in the order of `FOLLOWING_TERMS`.

    Args:
        truth: (4,) distance [m], bearing [rad], bystander_space [m] and action_change of `StepFacts`.
        following: Whether the robot follows its leader.
        collided: Whether it touched something.
        done: Whether the tour is over.
        step_s: Length of the step [s].
        weights: (7,) of the terms.
        shapes: (6,) as `RewardConfig.shapes`.
        terms: (7,) written.
    """
    share = step_s * 10.0
    terms[0] = share * weights[0] * tolerance(truth[0] - shapes[0], shapes[1], shapes[2])
    terms[1] = share * weights[1] * tolerance(truth[1], shapes[3], shapes[4])
    terms[2] = -share * weights[2] * intrusion(truth[2], shapes[5])
    terms[3] = -weights[3] * truth[3]
    terms[4] = 0.0 if following else -weights[4] * share
    terms[5] = -weights[5] if collided else 0.0
    terms[6] = weights[6] if done and not collided else 0.0


def exploration_terms(facts: StepFacts, goal: float, config: RewardConfig) -> dict[str, float]:
    """Return each term of an episode without a leader by name; `goal` is the share of the floor to be seen."""
    share = facts.step_s * 10.0
    return {
        "coverage": config.coverage * facts.newly_covered,
        "personal_space": -share * config.personal_space * intrusion(facts.bystander_space, config.space),
        "smoothness": -config.smoothness * facts.action_change,
        "collision": -float(config.collision) if facts.collided else 0.0,
        "covered": float(config.covered) if facts.coverage >= goal and not facts.collided else 0.0,
        **further_terms(facts, config),
    }


def further_terms(facts: StepFacts, config: RewardConfig) -> dict[str, float]:
    """Return what the functions of `config.terms` make of a step, by name.

    Raises:
        InputError: If one returns no finite number.
    """
    return {name: _finite(name, function(facts)) for name, function in config.terms.items()}


def _finite(name: str, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise InputError(f"`reward.terms[{name!r}]` must return a finite number, got {shown(value)}")
    return number


@kernel
def tolerance(value: float, bound: float, margin: float) -> float:
    """Return 1 where |value| <= bound, falling as a Gaussian to 0.1 at bound + margin (dm_control's `tolerance`)."""
    beyond = abs(value) - bound
    return 1.0 if beyond <= 0.0 else math.exp(math.log(0.1) * (beyond / margin) ** 2)


@kernel
def intrusion(space: float, wanted: float = PERSONAL_SPACE_M) -> float:
    """Return how deep the robot is in a bystander's personal space: 0 at `wanted` [m] or more, 1 in contact."""
    return min(max(1.0 - space / wanted, 0.0), 1.0)
