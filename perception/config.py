"""Every number of the perception: the tree of the configurations of its classes, and Table II of Ye 2021 in it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import reduce
from types import MappingProxyType

from ..slam.errors import unknown_name
from .leader.config import LeaderConfig
from .people_filter import PeopleFilterConfig, RemovalConfig


@dataclass(frozen=True, kw_only=True)
class PerceptionConfig(PeopleFilterConfig):
    """How a robot perceives people: as its people filter does, and how it keeps to the one whom it follows.

    Attributes:
        leader: How the leader is chosen, and looked for when its track has ended.
    """

    leader: LeaderConfig = field(default_factory=LeaderConfig)


TABLE_II: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "alpha": ("detector.alpha",),
        "beta": ("detector.beta",),
        "gamma": ("detector.gamma", "tracker.existence.gamma"),
        "delta": ("paper.delta", "tracker.evidence.least_way"),
        "epsilon": ("paper.epsilon",),
        "zeta": ("removal.zeta", "paper.clearance", "tracker.things.clearance"),
        "c_min": ("paper.c_min",),
        "q": ("paper.motion.q", "tracker.motion.q"),
        "r": ("paper.motion.r", "tracker.motion.r"),
    }
)
"""Where the numbers of the paper's Table II stand in a `PeopleFilterConfig`: in the paper's tracker, and in ours where
it has them."""


def table_ii(config: PeopleFilterConfig) -> dict[str, float]:
    """Return the numbers of Table II as `config` has them, by the paper's letters."""
    return {name: reduce(getattr, paths[0].split("."), config) for name, paths in TABLE_II.items()}


PRESETS: dict[str, PerceptionConfig] = {
    "recorded": PerceptionConfig(),
    "ye2021": PerceptionConfig(method="ye2021", removal=RemovalConfig(unconfirmed_radius=0.0)),
}
"""Named configurations.

`recorded`: the default: hypotheses of whole people, for recorded scans of any kind: moving robots, people seen as one
    cluster. The environment's robot has it with the forest `simulation`.
`ye2021`: the paper's numbers in the paper's own tracker, and its filter.
"""


def perception_preset(name: str) -> PerceptionConfig:
    """Return the configuration called `name`.

    Raises:
        InputError: If there is no such preset.
    """
    if name not in PRESETS:
        raise unknown_name("preset", name, tuple(PRESETS))
    return PRESETS[name]
