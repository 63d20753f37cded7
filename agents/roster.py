"""Who can drive, by name: followers of a leader, and explorers without one."""

import os
from collections.abc import Callable
from functools import partial

from ..envs.task.interface import FollowInterface
from ..slam.errors import unknown_name
from .learned.follower import LearnedFollower
from .protocol.follower import Follower
from .protocol.newcomer import Newcomer
from .protocol.user import load_follower
from .scripted.dwa import DWAFollower
from .scripted.pid import PIDFollower
from .scripted.pure_pursuit import PurePursuitFollower
from .scripted.random_walk import RandomWalk

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
