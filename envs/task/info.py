"""What an environment tells beside its observations: `info`."""

from typing import Any

import numpy as np

from ..onboard.stack import Belief
from ..world.truth import TrueState
from .endings import Ending
from .rewards import StepFacts


def step_info(
    truth: TrueState, belief: Belief, facts: StepFacts, terms: dict[str, float], ending: Ending, leader: bool
) -> dict[str, Any]:
    """Return what is told of a step; the manual of `FollowEnv` says what it means.

    Args:
        truth: What is really so.
        belief: What the robot believes.
        facts: What happened in the step.
        terms: Of the reward, by name.
        ending: Whether the episode has ended.
        leader: Whether somebody leads.
    """
    info = {
        "time_s": truth.time_s,
        "reward_terms": terms,
        "ending": ending.reason,
        "is_success": ending.reason in ("tour_done", "covered"),
        "tracked_people": len(belief.people),
        "odometry": belief.odometry.copy(),
        "robot_pose": truth.robot_pose.copy(),
    }
    if leader:
        info["leader_distance"] = facts.distance
        info["following_leader"] = facts.following_leader
        info["lost_s"] = ending.lost_s
        info["leader_id"] = belief.leader_id
    if not np.isnan(facts.coverage):
        info["coverage"] = facts.coverage
    if not np.isnan(belief.map_pose[0]):
        info["map_pose"] = belief.map_pose.copy()
    return info
