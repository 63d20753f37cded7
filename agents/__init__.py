"""Who drives: followers of a leader, and explorers without one. Importing this needs neither torch nor mujoco."""

import os
from collections.abc import Callable
from functools import partial

from ..envs.task.interface import FollowInterface
from ..slam.errors import unknown_name
from .follower import Follower
from .learned.follower import LearnedFollower
from .newcomer import Newcomer
from .scripted.dwa import DWAConfig, DWAFollower
from .scripted.pid import PIDConfig, PIDFollower
from .scripted.pure_pursuit import PurePursuitConfig, PurePursuitFollower
from .scripted.random_walk import RandomWalk, RandomWalkConfig
from .user import load_follower

FOLLOWERS: dict[str, Callable[[FollowInterface], Follower]] = {
    "pid": PIDFollower,
    "pure_pursuit": PurePursuitFollower,
    "dwa": DWAFollower,
    "learned": LearnedFollower,
}
"""Who needs a leader."""


def _frontier(interface: FollowInterface) -> Follower:
    from .scripted.frontier import FrontierExplorer  # imported late: its kernels need numba

    return FrontierExplorer(interface)


EXPLORERS: dict[str, Callable[[FollowInterface], Follower]] = {"random": RandomWalk, "frontier": _frontier}
"""Who needs none: for environments with `leader=False`; "frontier" for those that build a map."""

__all__ = [
    "EXPLORERS",
    "FOLLOWERS",
    "DWAConfig",
    "DWAFollower",
    "Follower",
    "LearnedFollower",
    "PIDConfig",
    "PIDFollower",
    "PurePursuitConfig",
    "PurePursuitFollower",
    "RandomWalk",
    "RandomWalkConfig",
    "make_follower",
]


def make_follower(name: str, interface: FollowInterface | None = None) -> Follower:
    """Return a new follower or explorer.

    Args:
        name: "pid", "pure_pursuit", "dwa", "learned" (behind a leader); "random", "frontier" (without); your own class,
            as "module:name"; or a folder that `tagalong train follower` wrote.
        interface: Scales of the environment it will act in, `env.unwrapped.interface`; None: it learns them
            there (but a class of your own is told the defaults).

    Raises:
        InputError: If the name is unknown, or "frontier" finds no map.
    """
    if ":" in name:
        return load_follower(name, interface or FollowInterface())
    everybody = {**FOLLOWERS, **EXPLORERS}
    make = everybody.get(name)
    if make is None and os.path.isdir(name):
        make = partial(LearnedFollower, policy=name)
    if make is None:
        raise unknown_name("follower", name, tuple(everybody))
    return Newcomer(make) if interface is None else make(interface)
