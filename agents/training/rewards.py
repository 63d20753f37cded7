"""What training rewards, term by term. The environment's own terms come from the truth, as rewards may; the rest from
what the robot measures. Their sum is the reward.

| term | formula | why |
|---|---|---|
| `following` | the environment's `distance`: 1 within 0.15 m of 1.3 m behind the leader, 0.1 a metre off | the task |
| `facing` | its `facing`: up to 0.2 when the leader is straight ahead | legs leave the field of view |
| `in_sight` | 2 x its `lost`: -0.4 a step without the true leader | the task ends with a lost leader |
| `personal_space` | 3 x its `personal_space`: to -3 within 0.45 m of a bystander | 1 gave people too little room |
| `clearance` | -0.3 (1 - gap / 0.2 m)^2, gap from the robot's box to the nearest return | cut corners end in contacts |
| `smoothness` | -0.02 (change of acceleration)^2 - 0.01 (of the turn's)^2, commanded | limits alone allow jerks |
| `map` | 20 x the share of the floor newly seen, where the environment measures it | what the drive is for |
| `collision` | the environment's: -20 | safety |
| `tour` | the environment's: +20 | finish |
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ..learned.steering import State
from ..protocol.follower import Observation
from ..scripted.scan_points import ScanPoints


@dataclass(frozen=True, kw_only=True)
class RewardWeights:
    """Weights of the terms; the table above gives the defaults and their reasons.

    Attributes:
        following: Of `following`.
        facing: Of `facing`.
        in_sight: Of `in_sight`.
        personal_space: Of `personal_space`.
        clearance: Of `clearance`.
        clearance_m: Gap below which it costs [m].
        smoothness: Of `smoothness`, forward [s^4/m^2].
        turn_smoothness: Of `smoothness`, turning [s^4/rad^2].
        map: Of `map`.
        collision: Of `collision`.
        tour: Of `tour`.
    """

    following: float = 1.0
    facing: float = 1.0
    in_sight: float = 2.0
    personal_space: float = 3.0
    clearance: float = 0.3
    clearance_m: float = 0.2
    smoothness: float = 0.02
    turn_smoothness: float = 0.01
    map: float = 20.0
    collision: float = 1.0
    tour: float = 1.0


class TrainingReward:
    """The reward of one environment, step by step.

    Args:
        weights: Of the terms.
        interface: Scales of the environment.
    """

    def __init__(self, weights: RewardWeights, interface: FollowInterface) -> None:
        self._weights, self._points, self._robot = weights, ScanPoints(interface), interface
        self.reset(0.0)

    def reset(self, coverage: float) -> None:
        """Begin an episode in which the share `coverage` of the floor is seen already."""
        self._commanded: State = (0.0, 0.0, 0.0, 0.0)
        self._coverage = coverage

    def terms(
        self, own: Mapping[str, float], observation: Observation, commanded: State, coverage: float
    ) -> dict[str, float]:
        """Return each term of a step by name.

        Args:
            own: The environment's terms.
            observation: After the step.
            commanded: What the steering commanded in it.
            coverage: Share of the floor seen; 0 where it is not measured.
        """
        w, before = self._weights, self._commanded
        newly, self._coverage, self._commanded = max(coverage - self._coverage, 0.0), coverage, commanded
        lack = 1.0 - min(nearest_gap(self._points.near(observation, 1.0), self._robot) / w.clearance_m, 1.0)
        change, turn_change = commanded[1] - before[1], commanded[3] - before[3]
        return {
            "following": w.following * own["distance"],
            "facing": w.facing * own["facing"],
            "in_sight": w.in_sight * own["lost"],
            "personal_space": w.personal_space * own["personal_space"],
            "clearance": -w.clearance * lack**2,
            "smoothness": -w.smoothness * change**2 - w.turn_smoothness * turn_change**2,
            "map": w.map * newly,
            "collision": w.collision * own["collision"],
            "tour": w.tour * own["tour"],
        }


def nearest_gap(points: NDArray[np.float64], robot: FollowInterface) -> float:
    """Return the least distance from the robot's box to `points` (n, 2), robot frame [m]; inf without any."""
    beyond = np.maximum(np.abs(points) - (robot.half_length, robot.half_width), 0.0)
    return float(np.sqrt((beyond**2).sum(axis=1).min(initial=np.inf)))
