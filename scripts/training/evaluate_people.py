"""How many people a finder sees in labelled frames, how many of them are none, and what its likelihood is worth."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from ...perception.rgbd.people import RgbdPeople
from ...perception.rgbd.people_finder import PeopleFinder, PeopleFinderConfig
from ...perception.rgbd.person_classifier import PersonClassifier
from ...perception.rgbd.planes import PlaneFinder
from .rgbd_frames import LabelledFrame

Array = NDArray[np.float64]

FARTHEST = 6.0
"""People count up to here [m]."""
MATCH_DISTANCE = 0.5
"""A person is found by at most one detection within this distance, and a detection finds at most one [m]."""
IN_SIGHT = 0.5
"""So much of what the picture would show of somebody with nothing before them is seen of who counts."""
LEAST_PIXELS = 40
THRESHOLD = 0.5
_BINS = 10


@dataclass(frozen=True, eq=False)
class PeopleScores:
    """What a finder said, over all frames.

    Attributes:
        found: (n,) likelihood of the detection of each person of whom anything is in sight; 0 where there is none.
        distance: (n,) of these people from the robot [m].
        visible: (n,) how much is seen of what the picture would show of each with nothing before them.
        error: (n,) distance between person and detection [m]; NaN where there is none.
        likelihood: (k,) of each detection within 6 m, however unlikely.
        right: (k,) whether it is somebody in sight, counting or not.
        frames: Number of frames.
    """

    found: Array
    distance: Array
    visible: Array
    error: Array
    likelihood: Array
    right: NDArray[np.bool_]
    frames: int

    @property
    def counted(self) -> NDArray[np.bool_]:
        """(n,) who counts: people seen by half or more."""
        return self.visible >= IN_SIGHT

    def recall(self, threshold: float = THRESHOLD) -> float:
        """Return the share of people who count that are found with at least this likelihood."""
        found = self.found[self.counted]
        return float((found >= threshold).mean()) if len(found) else float("nan")

    def precision(self, threshold: float = THRESHOLD) -> float:
        """Return the share of detections of at least this likelihood that are somebody."""
        said = self.likelihood >= threshold
        return float(self.right[said].mean()) if said.any() else float("nan")

    def recall_at(self, precision: float) -> float:
        """Return the best recall of all thresholds at which the precision is at least this; 0 if there is none."""
        return self.recall(self.threshold_at(precision))

    def threshold_at(self, precision: float) -> float:
        """Return the least likelihood from which on the precision is at least this; infinity if there is none."""
        order = np.argsort(-self.likelihood, kind="stable")
        share = np.cumsum(self.right[order]) / np.arange(1, len(order) + 1)
        # detections of one likelihood are said together
        ends = np.append(np.diff(self.likelihood[order]) != 0.0, True)[: len(order)]
        good = self.likelihood[order][ends & (share >= precision)]
        return float(good.min()) if len(good) else float("inf")

    @property
    def calibration_error(self) -> float:
        """Expected calibration error: mean gap of likelihood and share of right, over ten bins weighed by size."""
        which = np.minimum((self.likelihood * _BINS).astype(int), _BINS - 1)
        total = 0.0
        for b in range(_BINS):
            mine = which == b
            total += abs(float(self.likelihood[mine].sum()) - np.count_nonzero(self.right[mine]))
        return float(total / max(1, len(which)))

    def figures(self) -> dict[str, Any]:
        """Return the numbers of a table."""
        hit = self.counted & (self.found >= THRESHOLD)
        return {
            "frames": self.frames,
            "people": int(self.counted.sum()),
            "detections": int((self.likelihood >= THRESHOLD).sum()),
            "candidates": len(self.likelihood),
            "recall": round(self.recall(), 4),
            "precision": round(self.precision(), 4),
            "recall_at_precision_0.95": round(self.recall_at(0.95), 4),
            "expected_calibration_error": round(self.calibration_error, 4),
            "median_position_error_m": round(float(np.median(self.error[hit])), 3) if hit.any() else None,
        }


EVERYBODY = PeopleFinderConfig(least_likelihood=0.0, least_of_legs=0.0)
"""Tells every candidate, with its likelihood."""


def score_people(
    classifier: PersonClassifier, frames: Iterable[LabelledFrame], config: PeopleFinderConfig = EVERYBODY
) -> PeopleScores:
    """Score the finder with `classifier` on frames."""
    planes, finder = PlaneFinder(), PeopleFinder(classifier, config)
    parts = [score_frame(finder.find(drawn.frame, planes.find(drawn.frame)), drawn) for drawn in frames]
    return joined(parts)


def joined(parts: list[PeopleScores]) -> PeopleScores:
    """Return the scores of all parts."""
    names = ("found", "distance", "visible", "error", "likelihood", "right")
    arrays = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    return PeopleScores(**arrays, frames=sum(part.frames for part in parts))


def score_frame(people: RgbdPeople, drawn: LabelledFrame) -> PeopleScores:
    """Score what was found in one frame, with detections of any likelihood."""
    seen = np.bincount(drawn.person[drawn.person >= 0], minlength=len(drawn.places))
    distance = np.hypot(*drawn.places.T)
    camera = drawn.frame.T_robot_camera
    bearing = np.arctan2(drawn.places[:, 1] - camera[1], drawn.places[:, 0] - camera[0]) - camera[2]
    listed = (np.abs(bearing) < drawn.frame.camera.horizontal_fov / 2.0) & (distance <= FARTHEST)
    listed &= seen >= LEAST_PIXELS
    visible = seen / np.maximum(drawn.whole, 1)
    away = np.hypot(*(drawn.places[:, None] - people.positions[None]).transpose(2, 0, 1))
    away[seen < LEAST_PIXELS // 4] = np.inf
    found, error, right = np.zeros(len(seen)), np.full(len(seen), np.nan), np.zeros(len(people), dtype=bool)
    cost = np.where(away <= MATCH_DISTANCE, away - 2.0 * people.likelihood, 10.0)
    for person, k in zip(*linear_sum_assignment(cost), strict=True):
        if away[person, k] <= MATCH_DISTANCE:
            found[person], error[person], right[k] = people.likelihood[k], away[person, k], True
    near = np.hypot(*people.positions.T) <= FARTHEST
    return PeopleScores(
        found=found[listed],
        distance=distance[listed],
        visible=visible[listed],
        error=error[listed],
        likelihood=people.likelihood[near],
        right=right[near],
        frames=1,
    )
