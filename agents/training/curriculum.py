"""Which episodes training takes: first few bystanders, then more as the policy gets on."""

from collections import deque
from dataclasses import dataclass
from typing import Any, TypeGuard

import numpy as np

from ...slam.errors import InputError

HELD_OUT_SEED = 900_000
"""Training draws seeds below this; evaluations during training take this one and the next; suites begin at 1000000."""
_RECENT = 30
_MOST_DRAWN = 1 << 53
"""Episodes that a state may say were drawn: beyond it, a number of JSON need not be whole."""


@dataclass(frozen=True, kw_only=True)
class CurriculumConfig:
    """What is drawn.

    Attributes:
        scenes: Name of a building -> share of the episodes.
        bystanders: Most bystanders of each level; as many or fewer are drawn.
        promotion: Share of done tours, of the last 30 episodes, that leads to the next level.
        first_level: Where training begins.
        styles: Manners of leaders that are trained on; "hurried" is kept for tests.
    """

    scenes: tuple[tuple[str, float], ...] = (
        ("office", 0.64),
        ("floor_plan", 0.16),
        ("meeting_room", 0.1),
        ("corridor", 0.1),
    )
    bystanders: tuple[int, ...] = (2, 5, 8, 12)
    promotion: float = 0.8
    first_level: int = 0
    styles: tuple[str, ...] = ("steady", "waits")

    def __post_init__(self) -> None:
        if not 0 <= self.first_level < len(self.bystanders):
            raise InputError(f"`first_level` must be one of {len(self.bystanders)} levels, got {self.first_level}")


@dataclass(frozen=True)
class Drawn:
    """One episode: its seed and the options of its `reset`."""

    seed: int
    options: dict[str, Any]


class Curriculum:
    """Draws episodes, and goes to the next level when enough tours are done.

    Args:
        config: What is drawn.
        seed: Of all draws.
    """

    def __init__(self, config: CurriculumConfig, seed: int) -> None:
        self.config, self._seed = config, seed
        self.level, self.drawn = config.first_level, 0
        self._recent: deque[bool] = deque(maxlen=_RECENT)

    def draw(self) -> Drawn:
        """Return the next episode."""
        rng = np.random.default_rng((self._seed, self.drawn))
        self.drawn += 1
        return draw_episode(rng, self.config, self.config.bystanders[self.level])

    def report(self, done: bool) -> None:
        """Take note of whether a tour was done."""
        self._recent.append(done)
        enough = len(self._recent) == _RECENT and sum(self._recent) >= self.config.promotion * _RECENT
        if enough and self.level + 1 < len(self.config.bystanders):
            self.level += 1
            self._recent.clear()

    def state(self) -> dict[str, Any]:
        """Return what `restore` needs, for JSON."""
        return {"level": self.level, "drawn": self.drawn, "recent": list(self._recent)}

    def restore(self, state: dict[str, Any]) -> None:
        """Go on where `state` was.

        Raises:
            InputError: If it is no state of such a curriculum.
        """
        level, drawn, recent = (state.get(name) for name in ("level", "drawn", "recent"))
        last = len(self.config.bystanders) - 1
        if not (_is_count(level, last) and _is_count(drawn, _MOST_DRAWN)):
            raise InputError(f"a curriculum's state needs `level` up to {last} and `drawn`, both whole numbers")
        if not (isinstance(recent, list) and len(recent) <= _RECENT and all(isinstance(one, bool) for one in recent)):
            raise InputError(f"a curriculum's state needs `recent`, at most {_RECENT} times true or false")
        self.level, self.drawn = level, drawn
        self._recent = deque(recent, maxlen=_RECENT)


def _is_count(value: Any, most: int) -> TypeGuard[int]:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= most


def draw_episode(rng: np.random.Generator, config: CurriculumConfig, most: int) -> Drawn:
    """Return an episode with at most `most` bystanders."""
    names, shares = zip(*config.scenes, strict=True)
    scene = names[int(rng.choice(len(names), p=np.array(shares) / sum(shares)))]
    style = config.styles[int(rng.integers(len(config.styles)))]
    people = 1 + int(rng.integers(most + 1))
    if scene in ("meeting_room", "corridor"):
        people = min(people, 3)
    seed = int(rng.integers(HELD_OUT_SEED))
    return Drawn(seed, {"scene": scene, "people": people, "leader_style": style})


def held_out(config: CurriculumConfig, count: int) -> list[Drawn]:
    """Return the episodes of evaluations during training, the same every time: seeds that training never draws."""
    rng = np.random.default_rng(HELD_OUT_SEED)
    drawn = [draw_episode(rng, config, config.bystanders[-1]) for _ in range(count)]
    return [Drawn(HELD_OUT_SEED + i, one.options) for i, one in enumerate(drawn)]
