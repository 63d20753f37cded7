"""Who can drive, by name: followers of a leader, and explorers without one."""

import os
from collections.abc import Callable
from functools import partial
from typing import TypeGuard

from ..envs.task.interface import FollowInterface
from ..slam.errors import InputError, unknown_name
from .learned.follower import LearnedFollower
from .learned.guarded import Guarded
from .protocol.follower import Follower
from .protocol.newcomer import Newcomer
from .protocol.user import load_follower
from .reinforced.follower import ReinforcedFollower
from .reinforced.policy import is_reinforced
from .scripted.dwa import DWAFollower
from .scripted.pid import PIDFollower
from .scripted.plain_pid import PlainPIDFollower
from .scripted.pure_pursuit import PurePursuitFollower
from .scripted.random_walk import RandomWalk


def _mppi(interface: FollowInterface) -> Follower:
    from .planned.mppi import MPPIFollower  # imported late: its kernels need numba

    return MPPIFollower(interface)


def _mapper(interface: FollowInterface) -> Follower:
    from .planned.config import MAPPING
    from .planned.mppi import MPPIFollower

    return MPPIFollower(interface, MAPPING)


FOLLOWERS: dict[str, Callable[[FollowInterface], Follower]] = {
    "pid": PIDFollower,
    "plain_pid": PlainPIDFollower,
    "pure_pursuit": PurePursuitFollower,
    "dwa": DWAFollower,
    "mppi": _mppi,
    "learned": LearnedFollower,
    "reinforced": partial(ReinforcedFollower, policy="reinforced"),
}
"""Who needs a leader."""
MAPPERS: dict[str, Callable[[FollowInterface], Follower]] = {"mapper": _mapper}
"""Who needs a leader, and an environment that builds a map."""


def _frontier(interface: FollowInterface) -> Follower:
    from .scripted.frontier import FrontierExplorer  # imported late: its kernels need numba

    return FrontierExplorer(interface)


EXPLORERS: dict[str, Callable[[FollowInterface], Follower]] = {"random": RandomWalk, "frontier": _frontier}
"""Who needs none: for environments with `leader=False`; "frontier" for those that build a map."""


GUARD, ALONE = "+guard", "-alone"
"""Behind a name: the same follower with the safety filter; without the one that it was trained with."""


def make_follower(name: str, interface: FollowInterface | None = None) -> Follower:
    """Return a new follower or explorer.

    Args:
        name: "pid", "plain_pid", "pure_pursuit", "dwa", "mppi", "mapper", "learned", "reinforced" (behind a leader);
            "random", "frontier" (without); your own class, as "module:name"; or a folder that `tagalong train follower`
            wrote.
            With "+guard" behind it, its actions pass the safety filter, which stops before a certain contact; with
            "-alone", a reinforced policy that was trained with the filter drives without.
        interface: Scales of the environment it will act in, `env.unwrapped.interface`; None: it learns them
            there (but a class of your own is told the defaults).

    Raises:
        InputError: If the name is unknown, an explorer is to wear the filter, somebody is to drive without who never
            wore it, or "mapper" or "frontier" finds no map.
    """
    if name.endswith(ALONE) and not os.path.isdir(name):
        make = _alone(name.removesuffix(ALONE))
        return Newcomer(make) if interface is None else make(interface)
    plain, guarded = name.removesuffix(GUARD), name.endswith(GUARD)
    if ":" in plain:
        scales = interface or FollowInterface()
        own = load_follower(plain, scales)
        return Guarded(own, scales) if guarded else own
    make = _maker(plain, guarded)
    return Newcomer(make) if interface is None else make(interface)


def _maker(name: str, guarded: bool) -> Callable[[FollowInterface], Follower]:
    everybody = {**FOLLOWERS, **MAPPERS, **EXPLORERS}
    make = everybody.get(name)
    if make is None and os.path.isdir(name):
        make = partial(ReinforcedFollower if is_reinforced(name) else LearnedFollower, policy=name)
    if make is None:
        raise unknown_name("follower", name, tuple(everybody))
    if not guarded:
        return make
    if name in EXPLORERS:
        raise InputError(f"the safety filter is for followers; {name} explores without a leader")
    if _is_reinforced(make):
        return partial(make, guarded=True)
    inner = make
    return lambda interface: Guarded(inner(interface), interface)


def _alone(name: str) -> Callable[[FollowInterface], Follower]:
    make = None if ":" in name else _maker(name, guarded=False)
    if not _is_reinforced(make):
        raise InputError(f'"{ALONE}" takes the safety filter from a policy that was trained with it; {name} is none')
    return partial(make, guarded=False)


def _is_reinforced(make: object) -> TypeGuard[partial[ReinforcedFollower]]:
    return isinstance(make, partial) and make.func is ReinforcedFollower
