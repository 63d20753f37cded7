"""Writes down an episode, step by step, into a `History`."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...slam.geometry import transform_points
from ..follow_env import FollowEnv, nobody_notes
from ..metrics.history import History


class Recorder:
    """Collects the rows of one episode: every step of the environment itself, below whatever wraps it.

    Args:
        env: The environment, after `reset`; it tells of its steps until `stop`.
    """

    def __init__(self, env: FollowEnv) -> None:
        self._env = env
        self._rows: list[dict[str, Any]] = []
        self._terms: list[dict[str, float]] = []
        self.record(np.zeros(env.action_space.shape or ()), 0.0, {})
        env.witness = self.record

    def stop(self) -> None:
        """Record no more."""
        self._env.witness = nobody_notes

    def __len__(self) -> int:
        return len(self._rows)

    def record(self, action: ArrayLike, reward: float, terms: dict[str, float]) -> None:
        """Add the present state, to which `action` led."""
        truth, belief = self._env.truth, self._env.belief
        leader = np.full(2, np.nan)
        if belief.leader is not None:
            leader = transform_points(truth.robot_pose, belief.leader.position[None])[0]
        self._terms.append(terms)
        self._rows.append(
            {
                "time_s": truth.time_s,
                "robot_pose": truth.robot_pose,
                "robot_velocity": truth.robot_velocity,
                "action": np.array(action, dtype=np.float64),
                "reward": reward,
                "person_position": truth.people.positions,
                "person_velocity": truth.people.velocities,
                "leader_walking": truth.leader_walking,
                "contact_person": truth.contact_person,
                "contact_static": truth.contact_static,
                "odometry": belief.odometry,
                "estimated_pose": belief.map_pose,
                "leader_visible": belief.sees_leader,
                "leader_id": belief.leader_id,
                "leader_estimate": leader,
                "tracked_people": len(belief.people),
                "tour_done": truth.tour_done,
                "coverage": self._env.coverage.share,
            }
        )

    def history(self) -> History:
        """Return all rows so far."""
        columns = {name: np.array([row[name] for row in self._rows]) for name in self._rows[0]}
        names = self._terms[-1]
        terms = {name: np.array([row.get(name, 0.0) for row in self._terms]) for name in names}
        world, truth = self._env.world, self._env.truth
        return History(
            **columns,
            reward_terms=terms,
            person_radius=truth.people.radii,
            robot_radius=world.config.robot.radius,
            leader_index=truth.leader_index,
            static_clearance=world.scene.clearance(columns["robot_pose"][:, :2]),
        )
