"""What a camera tells the tracker: where people are, whether they move or not, some time after the exposure."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import check_points, check_time, checked_pose
from ...slam.geometry import transform_points
from ...slam.scan import LaserScan
from ..legs.detector import Detections, no_detections
from ..rgbd.people import RgbdPeople
from . import kalman
from .config import TrackerConfig
from .data_association import assign, distances
from .numbers import Numbers
from .person_tracks import confirm
from .tracks import LEGS, PEOPLE, Tracks, begin

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SeenPeople:
    """People that a camera saw.

    Attributes:
        time_s: Time of the exposure [s].
        positions: (n, 2) odometry frame [m].
        likelihood: (n,) in [0, 1].
    """

    time_s: float
    positions: Array
    likelihood: Array

    def __post_init__(self) -> None:
        check_time(self.time_s)
        check_points(self.positions, "positions")

    @classmethod
    def at_exposure(cls, people: RgbdPeople, time_s: float, odometry: ArrayLike) -> "SeenPeople":
        """Return `people` of a frame taken at `time_s` [s] where the odometry said T_odom_robot (3,)."""
        return cls(time_s, transform_points(checked_pose(odometry), people.positions), people.likelihood)


class NoLegs:
    """A detector that finds no legs: for people by the camera alone."""

    def detect(self, scan: LaserScan) -> Detections:
        """Return nothing, whatever `scan` shows."""
        return no_detections()


class CameraTracking:
    """Corrects people by what a camera saw, and confirms those whom only it knows: they need not have moved.

    Args:
        config: Of the tracker.
        numbers: The same as kernels take it.
    """

    def __init__(self, config: TrackerConfig, numbers: Numbers) -> None:
        self._config, self._numbers = config, numbers
        self._places, self._counts = np.empty((0, 2)), np.empty(0, dtype=np.int64)
        self._times = np.empty(0)

    def update(self, tracks: Tracks, seen: SeenPeople, time_s: float, dt: float) -> None:
        """Correct the people of `tracks` at `time_s`, `dt` seconds after the last scan, by whom the camera has `seen`.

        Tentative leg tracks near somebody new are its legs; those not seen yet stand where the camera saw it.
        """
        unknown = self._correct(tracks.people[: tracks.counts[PEOPLE]], seen, time_s, dt)
        for k in self._new_people(seen, unknown):
            place, count, owned = seen.positions[k], int(tracks.counts[LEGS]), 2 * int(tracks.counts[PEOPLE])
            away = distances(place[None], tracks.legs["x"][owned:count])[0]
            own = owned + np.argsort(away, kind="stable")[:2]
            own = own[np.sort(away)[:2] <= self._config.pairing.distance / 2.0]
            hidden = np.arange(count, count + 2 - len(own))
            places, sure = np.repeat(place[None], len(hidden), axis=0), np.full(len(hidden), seen.likelihood[k])
            begin(tracks, places, sure, float(self._config.motion.initial_variance))
            confirm(tracks, np.concatenate((own, hidden))[None], self._numbers)
            last = tracks.people[: tracks.counts[PEOPLE]][-1:]
            last["x"][:, :2], last["confidence"], last["camera_s"] = place, seen.likelihood[k], 0.0

    def _correct(self, people: NDArray[np.void], seen: SeenPeople, time_s: float, dt: float) -> NDArray[np.intp]:
        """Correct `people` (n,) in place; return the rows of `seen` that are nobody of them.

        A person is compared where it was at the exposure; that the camera saw it counts for now.
        """
        config, delay = self._config, max(0.0, time_s - seen.time_s)
        then = people["x"][:, :2] - delay * people["x"][:, 2:]
        rows, columns = assign(distances(then, seen.positions), config.camera.gate)
        now = seen.positions[columns] + delay * people["x"][rows, 2:]
        r = np.full(len(rows), config.camera.r)
        people["x"][rows], people["p"][rows] = kalman.update(people["x"][rows], people["p"][rows], now, r)
        people["confidence"][rows] += config.motion.confidence_weight(dt) * seen.likelihood[columns]
        np.minimum(people["confidence"], 1.0, out=people["confidence"])
        people["unseen_s"][rows] = np.minimum(people["unseen_s"][rows], delay)
        people["camera_s"][rows] = delay
        near = distances(seen.positions, then).min(axis=1, initial=np.inf) <= config.camera.gate
        near[columns] = True
        return np.flatnonzero(~near & (seen.likelihood >= config.camera.sure))

    def _new_people(self, seen: SeenPeople, rows: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return those of `rows` of `seen`, nobody known, that were seen in enough frames at about their place."""
        config = self._config
        fresh = seen.time_s - self._times <= config.camera.wait_s
        places, counts, times = self._places[fresh], self._counts[fresh], self._times[fresh]
        again, old = assign(distances(seen.positions[rows], places), config.camera.gate)
        count = np.ones(len(rows), dtype=np.int64)
        count[again] += counts[old]
        sure = count >= config.camera.frames
        rest = np.setdiff1d(np.arange(len(places)), old)
        self._places = np.concatenate((places[rest], seen.positions[rows[~sure]]))
        self._counts = np.concatenate((counts[rest], count[~sure]))
        self._times = np.concatenate((times[rest], np.full(np.count_nonzero(~sure), seen.time_s)))
        return rows[sure]
