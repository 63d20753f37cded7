"""What an environment asks of the robot."""

from dataclasses import dataclass
from typing import Annotated

from ...slam.bounds import Within
from ..limits.field_checks import Patience, Rate, check_fields


@dataclass(frozen=True, kw_only=True)
class TaskConfig:
    """The task, and when an episode ends.

    Attributes:
        leader: Whether somebody leads the robot; else it explores, and the episode is about coverage.
        control_hz: Steps a second [1/s]; a step must be a multiple of 0.025 s.
        top_turn_rate: Turn rate at action +1 [rad/s], at most the robot's; forward speed at action +1 is the robot's
            largest.
        lost_limit_s: The episode ends when the leader was not followed for this long [s].
        coverage: Whether the share of the floor that was seen is measured behind a leader, too.
        coverage_goal: Without a leader, the episode ends when this share of the floor was seen [0 .. 1].
        ends_on_contact: Whether the episode ends when the robot touches a person or a thing.
    """

    leader: bool = True
    control_hz: Rate = 10.0
    top_turn_rate: Annotated[float, Within(1e-3, 100.0)] = 2.0
    lost_limit_s: Patience = 20.0
    coverage: bool = False
    coverage_goal: Annotated[float, Within(1e-6, 1.0)] = 0.99
    ends_on_contact: bool = True

    def __post_init__(self) -> None:
        check_fields(self)
