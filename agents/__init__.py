"""Followers. Importing this needs neither torch nor mujoco."""

from collections.abc import Callable

from ..envs.interface import FollowInterface
from ..slam.errors import unknown_name
from .follower import Follower
from .pid import PIDConfig, PIDFollower

FOLLOWERS: dict[str, Callable[[FollowInterface], Follower]] = {"pid": PIDFollower}

__all__ = ["FOLLOWERS", "Follower", "PIDConfig", "PIDFollower", "make_follower"]


def make_follower(name: str, interface: FollowInterface | None = None) -> Follower:
    """Return a new follower.

    Args:
        name: "pid".
        interface: Scales of the environment it will act in, `env.unwrapped.interface`; the defaults if None.

    Raises:
        InputError: If the name is unknown.
    """
    if name not in FOLLOWERS:
        raise unknown_name("follower", name, tuple(FOLLOWERS))
    return FOLLOWERS[name](interface or FollowInterface())
