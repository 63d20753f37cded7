"""Learned followers: what the network is told, the network in plain numpy, and how smoothly its wishes are driven.

`PilotConfig` sets what surrounds the network; `pilot_config(card["pilot"])` reads it from a policy's card. All other
names are private.
"""

from typing import TYPE_CHECKING

from ...slam.door import lends

if TYPE_CHECKING:
    from .pilot import PilotConfig
    from .policy_card import pilot_config

__all__ = [
    "PilotConfig",
    "pilot_config",
]

_HOME = {
    "PilotConfig": "pilot",
    "pilot_config": "policy_card",
}
"""Public name -> module; imported when it is asked for."""

__getattr__, __dir__ = lends(__name__, _HOME)
