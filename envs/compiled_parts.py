"""What is compiled together at the first use: what an environment consists of, each part in a small one of its own."""

from contextlib import AbstractContextManager

import numpy as np

from ..perception.compiled_parts import track_people
from ..slam.first_use.compiling import Part, compiled_together
from ..slam.first_use.parts import map_by_graph, map_by_particles
from ..slam.gmapping.config import GMappingConfig
from ..slam.graph.engine import CartographerConfig
from .follow_config import FollowConfig

_OF_ENGINES: dict[type, Part] = {GMappingConfig: map_by_particles, CartographerConfig: map_by_graph}
"""What the other engines compile is little."""


def compiled_for(config: FollowConfig) -> AbstractContextManager[None]:
    """Let the parts of an environment of MuJoCo be compiled together where a kernel of it must be."""
    parts: list[Part] = [track_people] if config.people.source in ("tracker", "camera") else []
    parts.append(simulate)
    parts += [part for kind, part in _OF_ENGINES.items() if isinstance(config.slam, kind)]
    return compiled_together(*parts)


def simulate() -> None:
    """Step people and a robot with a laser, without anybody on board who maps or tracks."""
    from .follow_env import FollowEnv  # here, for it asks for the parts

    env = FollowEnv(scene="office", people="truth", slam=None)
    env.reset(seed=0)
    for _ in range(10):
        env.step(np.zeros(2))
    env.close()
