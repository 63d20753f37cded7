"""Track termination: tracks that nobody believes in any more end (Ye 2021, section II.A)."""

import numpy as np
from numpy.typing import NDArray

from .config import TerminationConfig
from .track_kernels import surviving
from .tracks import Tracks


class TrackTermination:
    """Ends tracks whose place is too uncertain, or whose confidence has become too small."""

    def __init__(self, config: TerminationConfig) -> None:
        self._config = config

    def terminate(self, tracks: Tracks) -> NDArray[np.void]:
        """End tracks; return the people (k,) whose tracks ended. A person's legs live as long as the person."""
        bounds = self._config.epsilon, self._config.c_min
        alive, keep = surviving(tracks.people, *bounds), surviving(tracks.legs.rows, *bounds)
        keep[0 : 2 * len(alive) : 2] = keep[1 : 2 * len(alive) : 2] = alive
        ended = tracks.people[~alive]
        if len(ended):
            tracks.people = tracks.people[alive]
        if not keep.all():
            tracks.legs.take(np.flatnonzero(keep))
        return ended
