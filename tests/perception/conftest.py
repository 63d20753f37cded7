"""People made of two feet that step, and a detector that reports what the test says."""

from dataclasses import dataclass, field

import numpy as np
import pytest
from halls import Hall
from tagalong.perception.legs.clusters import Clusters
from tagalong.perception.legs.detector import Detections
from tagalong.perception.tracking.config import TrackerConfig
from tagalong.perception.tracking.tracker import PeopleTracker
from tagalong.slam import LaserScan

ORIGIN = np.zeros(3)


def feet_of_walker(position, velocity, time_s, step_s=0.5, width=0.2):
    """(2, 2) feet of a walker whose centre is at `position`: one foot stands while the other swings past it."""
    velocity = np.asarray(velocity, dtype=float)
    speed = np.hypot(*velocity)
    ahead = velocity / speed if speed else np.array([1.0, 0.0])
    side = np.array([-ahead[1], ahead[0]]) * width / 2
    phase = (time_s / step_s) % 2.0
    stance = 0.5 - phase % 1.0  # from half a step before the centre to half a step behind it
    along = np.array([stance, -stance]) if phase < 1.0 else np.array([-stance, stance])
    return position + along[:, None] * ahead * speed * step_s + np.stack((side, -side))


@dataclass
class ScriptedDetector:
    """Reports the positions and confidences that were put into it; each is a cluster of four points, `width` [m]."""

    positions: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    confidence: np.ndarray = field(default_factory=lambda: np.zeros(0))
    gamma: float = 0.3
    width: float = 0.1

    def detect(self, scan):
        corners = self.width * np.array([[-0.5, 0.0], [-0.2, -0.3], [0.2, -0.3], [0.5, 0.0]])
        points = (self.positions[:, None] + corners).reshape(-1, 2)
        start = 4 * np.arange(len(self.positions))
        clusters = Clusters(points, np.arange(len(points)), start, start + 4)
        return Detections(self.positions, self.confidence, self.confidence >= self.gamma, clusters)


@dataclass
class Stage:
    """A tracker at the origin that is shown legs and things, scan by scan."""

    config: TrackerConfig = field(default_factory=TrackerConfig)
    rate_hz: float = 10.0
    noise: float = 0.01
    scans: int = 0

    def __post_init__(self):
        self.detector = ScriptedDetector(gamma=self.config.existence.gamma)
        self.tracker = PeopleTracker(self.config, self.detector)
        self.rng = np.random.default_rng(0)

    @property
    def time_s(self):
        return self.scans / self.rate_hz

    def show(self, legs, things=(), confidence=0.8, odometry=ORIGIN, seen=None):
        """One scan with `legs` (robot frame), each with `confidence`, and `things` with a confidence of 0.05."""
        legs, things = np.reshape(legs, (-1, 2)), np.reshape(things, (-1, 2))
        self.scans += 1
        positions = np.concatenate((legs, things))
        self.detector.positions = positions + self.noise * self.rng.standard_normal(positions.shape)
        self.detector.confidence = np.concatenate(
            (np.broadcast_to(np.asarray(confidence, dtype=float), len(legs)), np.full(len(things), 0.05))
        )
        scan = LaserScan(np.ones(2), np.array([0.0, 0.1]), 0.1, 10.0, time_s=self.time_s)
        return self.tracker.update(scan, odometry, seen).people

    def walk(self, starts, velocities, seconds, hidden=lambda person, time_s: False, **shown):
        """Walk people from `starts` for `seconds`; returns the people after each scan and the true centres."""
        starts, velocities = np.reshape(starts, (-1, 2)).astype(float), np.reshape(velocities, (-1, 2)).astype(float)
        begin, history, truth = self.time_s, [], []
        for _ in range(round(seconds * self.rate_hz)):
            elapsed = self.time_s - begin
            centres = starts + elapsed * velocities
            legs = [
                feet_of_walker(centre, velocity, elapsed)
                for i, (centre, velocity) in enumerate(zip(centres, velocities, strict=True))
                if not hidden(i, elapsed)
            ]
            history.append(self.show(np.array(legs), **shown))
            truth.append(centres)
        return history, np.array(truth)


@pytest.fixture
def stage():
    return Stage()


@pytest.fixture
def make_stage():
    return Stage


@pytest.fixture
def scripted_detector():
    return ScriptedDetector


@pytest.fixture
def step():
    return feet_of_walker


@pytest.fixture
def make_hall(scripted_detector):
    return lambda rate_hz=7.5: Hall(scripted_detector(), rate_hz)


@pytest.fixture
def hall(make_hall):
    return make_hall()
