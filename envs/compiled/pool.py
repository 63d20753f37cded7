"""Episodes drawn ahead: each world's own first one, and those that follow by themselves."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium.utils import seeding

from ..episode_setup import world_config
from ..follow_config import FollowConfig
from ..world.drawing import draw_episode
from .plans import Plans, plan_row
from .records import Records

_LATER = 0x7A6A  # sets the draws of later episodes apart from those of seeds


class EpisodePool:
    """Draws episodes and keeps them as arrays.

    Rows 0 to `worlds` - 1 hold what each world was last reset to, the `later` rows behind them the episodes that
    follow when one ends by itself. Those depend on `seed` alone, so that a world plays the same ones beside any others.

    Args:
        config: What to draw.
        worlds: How many worlds.
        later: How many episodes are drawn ahead.
        seed: Of their draws.
    """

    def __init__(self, config: FollowConfig, worlds: int, later: int, seed: int) -> None:
        self._config, self._worlds, self._later, self._seed = config, worlds, later, seed
        self._records = Records(worlds + later)
        self._drawn_ahead = False

    def draw_own(self, world: int, seed: int, options: Mapping[str, Any]) -> None:
        """Draw the episode that `FollowEnv` begins with `reset(seed=seed, options=options)`."""
        self._put(world, seeding.np_random(seed)[0], options)

    def draw_another(self, world: int, seed: int, episode: int, options: Mapping[str, Any]) -> None:
        """Draw a later episode of the world that was last given `seed`."""
        self._put(world, np.random.default_rng([seed, episode]), options)

    def draw_ahead(self) -> None:
        """Draw the episodes that follow by themselves, once."""
        if not self._drawn_ahead:
            for k in range(self._later):
                self._put(self._worlds + k, np.random.default_rng([_LATER, self._seed, k]), {})
            self._drawn_ahead = True

    @property
    def plans(self) -> Plans:
        """All episodes, as kernels take them."""
        return Plans(**self._records.arrays)

    @property
    def size(self) -> int:
        """Memory of all episodes [bytes]."""
        return self._records.size

    def _put(self, row: int, rng: np.random.Generator, options: Mapping[str, Any]) -> None:
        self._records.put(row, plan_row(draw_episode(world_config(self._config, options), rng)))
