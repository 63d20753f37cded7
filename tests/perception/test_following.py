"""A scan's way through the tracker's kernels, against the stages in plain numpy."""

import numpy as np
import pytest
from people_tracker_reference import PlainTracker, assign_reference
from tagalong.perception.legs.clusters import Clusters
from tagalong.perception.legs.detector import Detections
from tagalong.perception.tracking.assignment import assigned
from tagalong.perception.tracking.config import ReidentificationConfig, TrackerConfig
from tagalong.perception.tracking.tracker import PeopleTracker
from tagalong.slam import LaserScan
from tagalong.slam.geometry import compose

MOUNT = (0.2, 0.05, 0.1)
FORGETFUL = TrackerConfig(reidentification=ReidentificationConfig(known_s=1.0, max_age_s=4.0))


class Crowd:
    """Walkers who turn, stop and hide each other, and things that look like legs now and then."""

    def __init__(self, rng, walkers, things, step):
        self.rng, self.step = rng, step
        self.centres, self.velocities = rng.uniform(-3.0, 3.0, (walkers, 2)), rng.normal(0.0, 0.8, (walkers, 2))
        self.things = rng.uniform(-3.0, 3.0, (things, 2))

    def detect(self, scan):
        rng, walkers = self.rng, len(self.centres)
        turned = rng.random(walkers) < 0.03
        self.velocities[turned] = rng.normal(0.0, 0.8, (turned.sum(), 2)) * (rng.random((turned.sum(), 1)) < 0.7)
        self.centres += 0.1 * self.velocities
        feet = np.concatenate(
            [self.step(self.centres[i], self.velocities[i], scan.time_s + 0.3 * i) for i in range(walkers)]
        )
        hidden = np.repeat(rng.random(walkers) < 0.1, 2) | (rng.random(2 * walkers) < 0.1)
        hidden |= np.repeat((int(scan.time_s) + np.arange(walkers)) % 7 == 0, 2)
        places = np.concatenate((feet[~hidden], self.things, self.centres[rng.random(walkers) < 0.1]))
        places = places + rng.normal(0.0, 0.015, places.shape)
        confidence = np.round(np.clip(rng.normal(0.5, 0.25, len(places)), 0.0, 1.0), 2)
        corners = rng.choice((0.1, 0.3), len(places))[:, None, None] * np.array([[-0.5, 0.0], [0.0, -0.3], [0.5, 0.0]])
        start = 3 * np.arange(len(places))
        clusters = Clusters((places[:, None] + corners).reshape(-1, 2), np.arange(3 * len(places)), start, start + 3)
        self.last = Detections(places, confidence, confidence >= 0.3, clusters)
        return self.last


@pytest.mark.parametrize("seed", range(6))
def test_people_are_those_of_plain_numpy_scan_after_scan(seed, step):
    rng, config = np.random.default_rng(seed), FORGETFUL if seed % 2 else TrackerConfig()
    crowd = Crowd(rng, walkers=3 + 2 * seed, things=5 * seed, step=step)
    ours, theirs = PeopleTracker(config, crowd), PlainTracker(config)
    known, numbers, pose = 0, set(), np.zeros(3)
    for k in range(250):
        time_s, dt = 0.1 * (k + 1), 0.2 if k == 0 else 0.1 * (k + 1) - 0.1 * k
        pose = pose + np.array((0.01, 0.002, 0.004))
        scan = LaserScan(np.ones(2), np.array([0.0, 0.1]), 0.1, 10.0, time_s=time_s, T_robot_lidar=MOUNT)
        people = ours.update(scan, pose).people
        theirs.see(crowd.last, pose, compose(pose, MOUNT), time_s, dt)
        assert people.ids.tolist() == theirs.people["id"].tolist()
        np.testing.assert_allclose(people.positions, theirs.people["x"][:, :2], rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(people.velocities, theirs.people["x"][:, 2:], rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(people.confidence, theirs.people["confidence"], rtol=1e-9)
        np.testing.assert_allclose(people.legs.reshape(-1, 2), theirs.legs["x"][: theirs.owned, :2], atol=1e-9)
        np.testing.assert_allclose(people.unseen_s, theirs.people["unseen_s"], atol=1e-12)
        assert len(people.seen_legs) == np.count_nonzero(theirs.legs["unseen_s"] == 0.0)
        known, numbers = known + len(people), numbers | set(people.ids.tolist())
    assert known > 150
    assert len(numbers) >= 3


@pytest.mark.parametrize("seed", range(40))
def test_the_assignment_is_scipys_ties_and_all(seed):
    rng = np.random.default_rng(seed)
    for _ in range(25):
        rows, columns = rng.integers(0, 9, 2)
        cost = rng.integers(0, 6, (rows, columns)) / 5.0 if seed % 2 else rng.uniform(0.0, 1.0, (rows, columns))
        cost[rng.random((rows, columns)) < 0.3] = np.inf
        limit = rng.choice((0.5, 0.8, 1.1), rows)
        for ours, theirs in zip(assigned(cost, limit), assign_reference(cost, limit), strict=True):
            assert ours.tolist() == theirs.tolist()
