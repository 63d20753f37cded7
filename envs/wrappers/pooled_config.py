"""What the pooled observation tells, and how far it looks."""

from dataclasses import dataclass
from typing import NamedTuple

from ...slam.bounds import check_positive
from ...slam.errors import InputError

LIMIT = 4.0
"""No number that is told lies beyond this, to either side."""
LEADER_NAMES = ("x", "y", "vx", "vy", "distance", "cos", "sin", "confidence", "seen", "known", "unseen")
PERSON_NAMES = ("x", "y", "vx", "vy", "near", "there")
_ACROSS = "y", "vy", "sin", "left", "turn"
"""Last words of the names of numbers that change their sign in a mirror."""
MOST = 4096
"""Of each count: a network of more inputs is no quick one."""


class Mirror(NamedTuple):
    """What numbers are in a mirror, left for right: the i-th is `signs[i]` times what the `order[i]`-th was."""

    order: tuple[int, ...]
    signs: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class PooledConfig:
    """What is told.

    Attributes:
        sectors: Parts of equal width of the laser's field of view; of each, the least gap between the robot's body and
            a return.
        gap_scale: Over which a sector's reading, exp(-gap / this), falls [m]: what is near is told finely.
        length_scale: Length that reads 1 in positions [m].
        people: Nearest bystanders that are told.
        trail: Points of the leader's trail that are told, the newest first.
        trail_spacing: Way between two of them [m].
        trail_jump: A leader who is seen this far from the trail's end begins a new one [m].
        unseen_scale: Time that reads 1 in "leader unseen" [s].
        actions: Last actions that are told; how smoothly one drives depends on them.
        stack: Steps that are told at once, the newest first; 1 for the present one alone.
    """

    sectors: int = 60
    gap_scale: float = 1.0
    length_scale: float = 3.0
    people: int = 5
    trail: int = 8
    trail_spacing: float = 0.3
    trail_jump: float = 1.5
    unseen_scale: float = 4.0
    actions: int = 2
    stack: int = 1

    def __post_init__(self) -> None:
        for name, least in (("sectors", 1), ("people", 0), ("trail", 1), ("actions", 0), ("stack", 1)):
            if not least <= getattr(self, name) <= MOST:
                raise InputError(f"`{name}` must be {least} to {MOST}, got {getattr(self, name)}")
        check_positive(self, "gap_scale", "length_scale", "trail_spacing", "trail_jump", "unseen_scale")

    def step_names(self, holonomic: bool = False) -> tuple[str, ...]:
        """Return the name of each number of one step, in their order."""
        axes = ("forward", "left", "turn") if holonomic else ("forward", "turn")
        return (
            *(f"sector {i}" for i in range(self.sectors)),
            *(f"leader {name}" for name in LEADER_NAMES),
            *(f"trail {i} {axis}" for i in range(self.trail) for axis in "xy"),
            *(f"person {i} {name}" for i in range(self.people) for name in PERSON_NAMES),
            *(f"velocity {axis}" for axis in axes),
            *(f"action {i} ago {axis}" for i in range(self.actions) for axis in axes),
        )

    def size(self, holonomic: bool = False) -> int:
        """Return how many numbers are told."""
        return self.stack * len(self.step_names(holonomic))

    def mirror(self, holonomic: bool = False) -> Mirror:
        """Return what is told of the same world in a mirror; its laser looks as far to the left as to the right."""
        now = self.step_names(holonomic)
        order = (*reversed(range(self.sectors)), *range(self.sectors, len(now)))
        signs = tuple(-1.0 if name.split()[-1] in _ACROSS else 1.0 for name in now)
        whole = tuple(k * len(now) + i for k in range(self.stack) for i in order)
        return Mirror(whole, signs * self.stack)

    @property
    def names(self) -> tuple[str, ...]:
        """Name of each number for a robot with two wheels driven, steps before the present one marked."""
        now = self.step_names()
        return now + tuple(f"{name}, {k} steps before" for k in range(1, self.stack) for name in now)
