"""The task of an episode: observations, rewards, endings and coverage.

`FollowInterface` says what a follower has to know of its environment: scales, laser, size of the robot, and how to ask
for its whole map (`OwnMap`). An environment's is `env.unwrapped.interface`; with one that you make yourself, followers
need no simulator. All other names are private.
"""

from typing import TYPE_CHECKING

from ...slam.door import lends

if TYPE_CHECKING:
    from .interface import FollowInterface, OwnMap

__all__ = [
    "FollowInterface",
    "OwnMap",
]

_HOME = {
    "FollowInterface": "interface",
    "OwnMap": "interface",
}
"""Public name -> module; imported when it is asked for."""

__getattr__, __dir__ = lends(__name__, _HOME)
