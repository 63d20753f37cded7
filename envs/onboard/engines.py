"""Who maps in an environment: an engine by name, by its configuration, or of the user's own making."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ...slam.ekf.config import EkfSlamConfig
from ...slam.ekf.engine import EkfSlam
from ...slam.engine import SlamEngine
from ...slam.errors import InputError, shown
from ...slam.gmapping.config import GMappingConfig
from ...slam.gmapping.engine import GMapping
from ...slam.graph.engine import Cartographer, CartographerConfig

SlamFactory = Callable[[np.random.SeedSequence], SlamEngine]
"""Makes a new engine for an episode; what it draws at random, it draws from the seed."""
SlamChoice = GMappingConfig | CartographerConfig | EkfSlamConfig | SlamFactory | str | None
TRUE_POSES = "truth"
BY_IMMOBILE_MAP = "immobile"
SLAM: dict[str | None, Any] = {
    "gmapping": GMappingConfig(),
    "cartographer": CartographerConfig(),
    "ekf": EkfSlamConfig(),
    BY_IMMOBILE_MAP: BY_IMMOBILE_MAP,
    TRUE_POSES: TRUE_POSES,
    None: None,
}
"""Name -> who maps: an engine's configuration, "immobile" for the immobile-area map by itself, "truth" for a map drawn
at the true poses, None for no map at all."""


def check_slam(choice: object) -> None:
    """Raise InputError unless `choice` is one of `SlamChoice`; a class of an engine is none, it takes no seed."""
    known = choice is None or isinstance(choice, GMappingConfig | CartographerConfig | EkfSlamConfig)
    known = known or (isinstance(choice, str) and choice in (TRUE_POSES, BY_IMMOBILE_MAP))
    if not known and (not callable(choice) or isinstance(choice, type)):
        rule = f"one of {', '.join(str(name) for name in SLAM)}, an engine's configuration, or a function of a seed"
        raise InputError(f"`slam` must be {rule} that returns an engine, got {shown(choice)}")


def make_engine(choice: Any, seed: np.random.SeedSequence) -> SlamEngine:
    """Return a new engine.

    Args:
        choice: Its configuration, or a `SlamFactory`.
        seed: Of its random draws.

    Raises:
        InputError: If a factory returns what is no engine.
    """
    if isinstance(choice, GMappingConfig):
        return GMapping(choice, seed)
    if isinstance(choice, CartographerConfig):
        return Cartographer(choice)
    if isinstance(choice, EkfSlamConfig):
        return EkfSlam(choice)
    engine = choice(seed)
    missing = [name for name in ("update", "pose", "live_map") if not hasattr(engine, name)]
    if missing:
        raise InputError(f"`slam` must return a SlamEngine, got {shown(engine)} without {', '.join(missing)}")
    return engine
