"""What changes in an environment during an episode, besides the world itself, in one object that is kept as a whole."""

from array import array
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .onboard.stack import Belief, OnboardStack
from .task.coverage import Coverage, NoCoverage
from .task.endings import Ending, EndingRule
from .world.truth import TrueState
from .world.world import World, WorldState

Array = NDArray[np.float64]


@dataclass
class EpisodeState:
    """The episode so far; a snapshot of the environment is a deep copy of this and of the world's state.

    Attributes:
        stack: The robot's onboard stack.
        endings: Tells when the episode is over.
        coverage: Measures how much of the floor was seen.
        belief: What the robot believes now.
        truth: What is really so now.
        action: The last action, in [-1, 1].
        trail: True places x, y of the robot [m] one after the other, a step each, from the start on.
        ending: Whether the episode is over, and why.
        covered: Share of the floor that was seen before the last step, in [0, 1].
    """

    stack: OnboardStack
    endings: EndingRule
    coverage: Coverage | NoCoverage
    belief: Belief
    truth: TrueState
    action: Array
    trail: "array[float]"
    ending: Ending
    covered: float


@dataclass(frozen=True, eq=False)
class EnvState:
    """A snapshot of an environment; can be kept, and restored any number of times.

    Attributes:
        world: The simulator of which the snapshot was taken.
        world_state: Its state.
        episode: All else that changes.
        generator: The environment's generator of random numbers, and its seed.
    """

    world: World
    world_state: WorldState
    episode: EpisodeState
    generator: Any
