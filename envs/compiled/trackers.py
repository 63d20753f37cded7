"""The real onboard stack behind compiled worlds: leg detector, tracker and choice of the leader, block by block."""

import numpy as np
from numpy.typing import NDArray

from ...perception.leader.selection import leader_numbers, no_leaders
from ...perception.legs.detection_kernel import Beams
from ...perception.legs.detector import splitting
from ...perception.legs.forest import LegForest
from ...perception.tracking.local_grid import PAGES, with_more_pages
from ...perception.tracking.numbers import numbers_of
from ...perception.tracking.tracks import no_tracks, with_room
from ...slam.processes.turns import Turns
from ..follow_config import FollowConfig
from .episodes import REST
from .state import Told, WorldsState
from .tracking import CELLS, TRACKS, Knowledge, Read, Swept, TrackingRules, track_worlds


class Trackers:
    """What each world's robot knows by its sweeps, by the kernels of the single environment.

    Args:
        config: Of the environment; people are known by "tracker", nothing maps, there is no camera.
        worlds: How many.
        room: Hypotheses of people that each has room for at first; a crowded office has fifty.
        pages: Of the grid of things that each has room for at first.
    """

    def __init__(self, config: FollowConfig, worlds: int, room: int = 64, pages: int = PAGES) -> None:
        self._rules = _rules(config)
        tracks = no_tracks(worlds, len(self._rules.beams.bearings), config.perception.tracker.views, room, pages)
        self._minds = Knowledge(tracks, no_leaders(worlds), np.zeros(worlds), np.zeros(worlds, np.int8))

    @property
    def memory(self) -> int:
        """Memory of what is known [bytes]."""
        minds = self._minds
        tracks = *minds.tracks[:4], *minds.tracks.views, *minds.tracks.cells
        return sum(array.nbytes for array in (*tracks, *minds[1:]))

    def read(self, turns: Turns, what: NDArray[np.int8], state: WorldsState, told: Told) -> None:
        """Let the robots of the worlds that did `what` (w,) read their sweeps, and tell it; `turns` at the worlds.

        Where there is no room for a sweep it is left unread, see `make_room`.
        """
        swept = Swept(told.ranges, told.time_s, state.odometry)
        read = Read(told.leader, told.people, told.tracked, told.track)
        track_worlds(turns, what, self._rules, self._minds, swept, read)

    def make_room(self, what: NDArray[np.int8]) -> NDArray[np.int8]:
        """Make room where it was lacking; return (w,) `what` is left to do, with sweeps unread."""
        lacking, left = self._minds.lacking, np.where(self._minds.lacking, what, REST).astype(np.int8)
        if (lacking == TRACKS).any():
            self._minds = self._minds._replace(tracks=with_room(self._minds.tracks))
        if (lacking == CELLS).any():
            tracks = self._minds.tracks._replace(cells=with_more_pages(self._minds.tracks.cells))
            self._minds = self._minds._replace(tracks=tracks)
        lacking[:] = 0
        return left


def _rules(config: FollowConfig) -> TrackingRules:
    """Return the numbers of detector, tracker and selector."""
    lidar, perception = config.sensors.lidar, config.perception
    bearings = np.asarray(lidar.bearings, dtype=np.float64)
    beams = Beams(
        bearings=bearings,
        directions=np.stack((np.cos(bearings), np.sin(bearings)), axis=-1),
        range_min=float(lidar.range_min),
        range_max=float(lidar.range_max),
        mount=np.array(lidar.mount, dtype=np.float64),
        spacing=float((bearings[-1] - bearings[0]) / max(len(bearings) - 1, 1)) or 1e-3,
    )
    return TrackingRules(
        beams=beams,
        splitting=splitting(perception.detector, beams),
        forest=LegForest.load(perception.forest).packed,
        tracker=numbers_of(perception.tracker),
        selector=leader_numbers(perception.leader, perception.tracker.motion),
    )
