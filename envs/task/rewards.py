"""Reward terms: pure functions of what truly happened in one step. Their sum is the reward.

Shaping terms are per step of 0.1 s, scaled to the actual step, so that returns do not depend on the control rate.
"""

import math
from dataclasses import dataclass

FOLLOWING_DISTANCE = 1.3
"""Wanted distance from the leader, centre to centre [m]."""
PERSONAL_SPACE_M = 0.45
"""Free space to bystanders below which the robot intrudes [m]."""


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


def reward_terms(facts: StepFacts) -> dict[str, float]:
    """Return each term by name; the manual of `FollowEnv` gives formulas and reasons."""
    share = facts.step_s * 10.0
    return {
        "distance": share * tolerance(facts.distance - FOLLOWING_DISTANCE, bound=0.15, margin=0.85),
        "facing": share * 0.2 * tolerance(facts.bearing, bound=0.2, margin=1.2),
        "personal_space": -share * intrusion(facts.bystander_space),
        "smoothness": -0.1 * facts.action_change,
        "lost": 0.0 if facts.following_leader else -0.2 * share,
        "collision": -20.0 if facts.collided else 0.0,
        "tour": 20.0 if facts.tour_done and not facts.collided else 0.0,
    }


def exploration_terms(facts: StepFacts, goal: float) -> dict[str, float]:
    """Return each term of an episode without a leader by name; `goal` is the share of the floor to be seen."""
    share = facts.step_s * 10.0
    return {
        "coverage": 100.0 * facts.newly_covered,
        "personal_space": -share * intrusion(facts.bystander_space),
        "smoothness": -0.1 * facts.action_change,
        "collision": -20.0 if facts.collided else 0.0,
        "covered": 20.0 if facts.coverage >= goal and not facts.collided else 0.0,
    }


def tolerance(value: float, *, bound: float, margin: float) -> float:
    """Return 1 where |value| <= bound, falling as a Gaussian to 0.1 at bound + margin (dm_control's `tolerance`)."""
    beyond = abs(value) - bound
    return 1.0 if beyond <= 0.0 else math.exp(math.log(0.1) * (beyond / margin) ** 2)


def intrusion(space: float) -> float:
    """Return how deep the robot is in a bystander's personal space: 0 at 0.45 m or more, 1 in contact."""
    return min(max(1.0 - space / PERSONAL_SPACE_M, 0.0), 1.0)
