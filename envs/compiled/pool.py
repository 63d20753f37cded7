"""Episodes as they are drawn: ahead for all worlds, and for one world where it was asked for."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.utils import seeding

from ...slam.errors import InputError
from ..episode_setup import world_config
from ..follow_config import FollowConfig
from ..world.config import WorldConfig
from ..world.drawing import MOST_DRAWS, EpisodeDrawing, draw_again, draw_episode
from .plans import Plans, plan_row
from .records import Records

_LATER = 0x7A6A  # sets the draws of later episodes apart from those of seeds

SHARING = 4
"""Episodes drawn ahead that share a building and its tour: drawing a building takes ten times as long as people."""


class EpisodePool:
    """Draws episodes and keeps them as arrays.

    Rows 0 to `ahead` - 1 hold the episodes that are drawn ahead, the `worlds` rows behind them what each world was
    last reset to where that had to be drawn. Those ahead depend on `seed` alone, so that a world plays the same ones
    beside any others.

    Args:
        config: What to draw.
        worlds: How many worlds.
        ahead: How many episodes are drawn ahead.
        seed: Of their draws.
        kinds: Options of `reset` for those ahead: building k takes the k-th, and round again.
    """

    def __init__(
        self, config: FollowConfig, worlds: int, ahead: int, seed: int, kinds: Sequence[Mapping[str, Any]] = ({},)
    ) -> None:
        self._config, self._ahead, self._seed = config, ahead, seed
        self._kinds = [world_config(config, kind) for kind in kinds]
        self._records = Records(ahead + worlds)
        self._drawn_ahead = False

    def draw_own(self, world: int, seed: int, options: Mapping[str, Any]) -> None:
        """Draw the episode that `FollowEnv` begins with `reset(seed=seed, options=options)`."""
        self._put_own(world, seeding.np_random(seed)[0], options)

    def draw_another(self, world: int, seed: int, episode: int, options: Mapping[str, Any]) -> None:
        """Draw a later episode of the world that was last given `seed`."""
        self._put_own(world, np.random.default_rng([seed, episode]), options)

    def draw_ahead(self) -> None:
        """Draw the episodes ahead, once."""
        if self._drawn_ahead:
            return
        for building, first in enumerate(range(0, self._ahead, SHARING)):
            config = self._kinds[building % len(self._kinds)]
            for row, drawing in enumerate(self._sharing(config, first), first):
                self._records.put(row, plan_row(drawing))
        self._drawn_ahead = True

    def _sharing(self, config: WorldConfig, first: int) -> list[EpisodeDrawing]:
        """Return the episodes `first` and those after it that share its building.

        Not every building has room for as many people as are asked for: then another one is drawn.

        Raises:
            InputError: If none of `MOST_DRAWS` has.
        """
        for attempt in range(MOST_DRAWS):
            more = [] if attempt == 0 else [attempt]
            try:
                drawings = [draw_episode(config, np.random.default_rng([_LATER, self._seed, first, *more]), 1)]
                for row in range(first + 1, min(first + SHARING, self._ahead)):
                    rng = np.random.default_rng([_LATER, self._seed, row, *more])
                    drawings.append(draw_again(drawings[0], rng))
            except InputError:
                if attempt == MOST_DRAWS - 1:
                    raise
            else:
                return drawings
        raise AssertionError("the last attempt returns or raises")

    @property
    def plans(self) -> Plans:
        """All episodes, as kernels take them."""
        return Plans(**self._records.arrays)

    @property
    def plans_in_use(self) -> Plans:
        """The episodes up to the last one that was drawn: what need not be there takes no memory where it is copied."""
        return Plans(**self._records.in_use)

    @property
    def size(self) -> int:
        """Memory of all episodes [bytes]."""
        return self._records.size

    def _put_own(self, world: int, rng: np.random.Generator, options: Mapping[str, Any]) -> None:
        drawing = draw_episode(world_config(self._config, options), rng)
        self._records.put(self._ahead + world, plan_row(drawing))
