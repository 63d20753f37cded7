"""What every follower is, scripted or learned."""

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Observation = Mapping[str, NDArray[np.float32]]


class Follower(Protocol):
    """Turns observations of a follow environment into actions; remembers only what it saw since `reset`."""

    def reset(self) -> None:
        """Forget everything; call it before each episode."""
        ...

    def act(self, observation: Any) -> NDArray[np.float32]:
        """Return the action for one observation, within [-1, 1]: shape (2,), or (3,) for a holonomic robot."""
        ...
