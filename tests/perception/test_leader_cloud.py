"""The cloud of bodies: its kernels against plain numpy, and known answers."""

import cloud_reference as reference
import numpy as np
import pytest
from tagalong.perception.leader import cloud
from tagalong.perception.leader import cloud_kernels as kernels
from tagalong.perception.leader.body_selector import BodyConfig, body_numbers
from tagalong.perception.leader.cloud import CloudConfig
from tagalong.perception.leader.onset import LeaderConfig
from tagalong.perception.legs.range_view import RangeView, seen_in
from tagalong.slam import InputError, LaserScan

SEEDS = pytest.mark.parametrize("seed", range(4))


def a_view(rng):
    """Ranges in a room with things in it, seen from a laser that stands anywhere."""
    ranges = np.repeat(rng.uniform(0.5, 5.0, 60), 6)
    return ranges, -2.3, np.deg2rad(0.75), np.append(rng.normal(size=2), rng.uniform(-3.0, 3.0))


def a_cloud(rng, count=150):
    weights = rng.uniform(0.1, 1.0, count)
    return 2.0 * rng.normal(size=(count, 4)), weights / weights.sum()


@SEEDS
def test_kernels_do_what_the_reference_does(seed):
    rng = np.random.default_rng(seed)
    view, (bodies, weights) = a_view(rng), a_cloud(rng)
    legs, places = 2.0 * rng.normal(size=(9, 2)), 2.0 * rng.normal(size=(5, 2))
    ours, theirs = (bodies.copy(), weights.copy()), (bodies.copy(), weights.copy())
    pushes = 0.3 * rng.normal(size=(len(bodies), 2))
    kernels.advance(*ours, pushes, 0.1, 0.95, 1.6, *view)
    reference.advance(*theirs, pushes, 0.1, 0.95, 1.6, *view)
    assert (ours[1] < weights).any()  # some went through a surface
    unseen = np.array((0.7, 0.1, 0.2))
    kernels.weigh(*ours, legs, rng.uniform(size=9), 0.3, 1.5, unseen, *view)
    rng = np.random.default_rng(seed)
    a_view(rng), a_cloud(rng), rng.normal(size=(14, 2)), rng.normal(size=(len(bodies), 2))
    reference.weigh(*theirs, legs, rng.uniform(size=9), 0.3, 1.5, unseen, *view)
    for one, other in zip(ours, theirs, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12)
    out, masses, claims = np.empty(9), np.empty(5), np.empty(9)
    kernels.explained(*ours, legs, 0.3, out)
    np.testing.assert_allclose(out, reference.explained(*ours, legs, 0.3), rtol=1e-12)
    kernels.mass_near(*ours, places, 1.0, masses)
    np.testing.assert_allclose(masses, reference.mass_near(*ours, places, 1.0), rtol=1e-12)
    owner, seen = rng.integers(-1, 4, 9), rng.uniform(size=5)
    kernels.claimed(legs, owner, 2, places, seen, 0.5, 2.0, 0.35, claims)
    np.testing.assert_allclose(claims, reference.claimed(legs, owner, 2, places, seen, 0.5, 2.0, 0.35), rtol=1e-12)


class Cloud:
    """A cloud around somebody, with draws of its own."""

    def __init__(self, position, velocity=(0.0, 0.0), **fields):
        self.rng, self.numbers = (
            np.random.default_rng(0),
            body_numbers(BodyConfig(cloud=CloudConfig(**fields)), LeaderConfig()),
        )
        self.bodies, self.weights = np.empty((200, 4)), np.empty(200)
        around = np.array([*position, *velocity])
        cloud.begin_cloud(self.bodies, self.weights, around, self.rng.standard_normal((200, 4)), self.numbers)

    def advance(self, dt, view):
        cloud.advance_cloud(self.bodies, self.weights, self.rng.standard_normal((200, 2)), dt, view, self.numbers)

    def weigh(self, legs, count, view):
        if cloud.weigh_cloud(self.bodies, self.weights, legs, count, view, self.numbers):
            cloud.draw_anew(self.bodies, self.weights, self.rng.random())

    def near(self, place, radius):
        return self.weights[np.hypot(*(self.bodies[:, :2] - place).T) < radius].sum()


def open_view(ranges=9.0, count=361):
    return RangeView(np.full(count, float(ranges)), -np.pi / 2.0, np.pi / (count - 1), np.zeros(3))


def test_a_scan_becomes_a_view_in_the_odometry_frame():
    ranges = np.array([1.0, np.inf, np.nan, 0.01, 30.0])
    scan = LaserScan(ranges, np.linspace(-1.0, 1.0, 5), 0.1, 20.0, T_robot_lidar=(0.2, 0.0, 0.0))
    view = seen_in(scan, (1.0, 2.0, np.pi / 2.0))
    assert view.ranges.tolist() == [1.0, 20.0, 0.0, 0.0, 20.0]
    assert (view.first, view.step) == (-1.0, 0.5)
    assert view.laser == pytest.approx([1.0, 2.2, np.pi / 2.0])


def test_a_cloud_begins_around_the_leader_and_is_spread_as_configured():
    around = Cloud((3.0, 1.0), (0.5, 0.0))
    assert cloud.mean_of(around.bodies, around.weights) == pytest.approx([3.0, 1.0, 0.5, 0.0], abs=0.1)
    assert around.bodies.std(axis=0) == pytest.approx([0.1, 0.1, 0.3, 0.3], rel=0.2)
    assert cloud.spread_of(around.bodies, around.weights) == pytest.approx(0.1 * np.sqrt(2.0), rel=0.2)
    assert around.weights.tolist() == [1.0 / 200] * 200


def test_bodies_die_in_free_view_and_live_on_out_of_sight():
    around = Cloud((3.0, 0.0))
    around.bodies[::2, :2] = 3.0, 3.0
    ranges = np.full(361, 9.0)
    ranges[225:] = 2.0  # a wall before the half of them at 45 degrees
    view = RangeView(ranges, -np.pi / 2.0, np.pi / 360.0, np.zeros(3))
    for _ in range(3):
        around.weigh(np.zeros((0, 2)), np.zeros(0), view)
    assert around.near((3.0, 3.0), 0.5) > 0.98
    assert around.weights.sum() == pytest.approx(1.0)


def test_bodies_do_not_walk_through_walls():
    around = Cloud((1.5, 0.0), (1.5, 0.0), push=0.01)
    around.bodies[::2] = 1.5, 0.0, -1.0, 0.0
    ranges = 2.0 / np.cos(np.linspace(-np.pi / 2.0, np.pi / 2.0, 361)).clip(0.05)
    view = RangeView(ranges, -np.pi / 2.0, np.pi / 360.0, np.zeros(3))
    for _ in range(8):
        around.advance(0.1, view)
    assert around.weights[around.bodies[:, 0] > 2.0].sum() < 0.06


def test_the_cloud_gathers_where_legs_are_seen_and_stays_as_large():
    around = Cloud((2.0, 0.0))
    for _ in range(10):
        around.advance(0.1, open_view(2.2))
        around.weigh(np.array([[2.0, 0.5], [2.0, 0.3]]), np.full(2, 4.0), open_view(2.2))
    assert cloud.mean_of(around.bodies, around.weights)[:2] == pytest.approx([2.0, 0.4], abs=0.1)
    assert cloud.spread_of(around.bodies, around.weights) < 0.35
    out = np.empty(2)
    kernels.explained(around.bodies, around.weights, np.array([[2.0, 0.4], [5.0, 5.0]]), 0.22, out)
    assert out == pytest.approx([0.6, 0.0], abs=0.25)


def test_bodies_are_drawn_anew_by_their_weights_at_equal_steps():
    bodies, weights = np.arange(16.0).reshape(4, 4), np.array([0.05, 0.6, 0.05, 0.3])
    drawn = bodies[np.searchsorted(np.cumsum(weights), (0.5 + np.arange(4)) / 4.0)]
    cloud.draw_anew(bodies, weights, 0.5)
    np.testing.assert_array_equal(bodies, drawn)
    assert weights.tolist() == [0.25] * 4


def test_wrong_clouds_say_what_is_wrong():
    with pytest.raises(InputError, match=r"`count` must be within 1 \.\. 100000, got 0"):
        CloudConfig(count=0)
    with pytest.raises(InputError, match="`calm_s` must be positive"):
        CloudConfig(calm_s=0.0)
