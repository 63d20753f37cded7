"""Observations to learn from: the environments' own, told to a network as one short vector of numbers of order one.

    PooledObservation(env)          of `gymnasium.make`
    PooledVectorObservation(env)    of `gymnasium.make_vec`, either simulator
    PooledConfig                    what is told, and how far; `PooledConfig().names` names each number
    PooledFeatures                  what both of them do, for loops that have no environment

All other names are private.
"""

from typing import TYPE_CHECKING

from ...slam.door import lends

if TYPE_CHECKING:
    from .pooled_config import PooledConfig
    from .pooled_features import PooledFeatures
    from .pooled_observation import PooledObservation, PooledVectorObservation

__all__ = [
    "PooledConfig",
    "PooledFeatures",
    "PooledObservation",
    "PooledVectorObservation",
]

_HOME = {
    "PooledConfig": "pooled_config",
    "PooledFeatures": "pooled_features",
    "PooledObservation": "pooled_observation",
    "PooledVectorObservation": "pooled_observation",
}
"""Public name -> module; imported when it is asked for."""

__getattr__, __dir__ = lends(__name__, _HOME)
