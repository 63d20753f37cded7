"""People: what behaviours of one's own can do, see and remember, and that a world saves whatever they remember."""

import pickle

import numpy as np
import pytest
from tagalong.envs.people import Behaviour, Wish
from tagalong.envs.sensors.lidar import LidarConfig
from tagalong.envs.world.world import World, WorldConfig
from tagalong.slam import InputError


class Shy(Behaviour):
    """Stands still while the robot is within 4 m, and counts for how long."""

    def __init__(self):
        self.frightened_s = 0.0

    def wish(self, view, dt):
        near = view.robot_distance < 4.0
        self.frightened_s += dt if near else 0.0
        return Wish(0.0 if near else 0.8, sense=-1.0)


class Restless(Behaviour):
    """Goes from one drawn point to the next."""

    start = (4.0, 0.0, 0.0)

    def __init__(self):
        self.goal = None

    def wish(self, view, dt):
        if self.goal is None or np.hypot(*(view.position - self.goal)) < 0.3:
            x, y = view.rng.uniform((3.0, -0.8), (5.0, 0.8)).tolist()
            self.goal = (x, y)
        return Wish(0.6, goal=self.goal)


def make(seed=0, **options):
    config = {"scene": "plain_corridor", "people": 1, "lidar": LidarConfig(beams=61), **options}
    return World(WorldConfig(**config), np.random.default_rng(seed))


def record(world, steps):
    rows = []
    for _ in range(steps):
        world.step((0.3, 0.0))
        rows.append((world.truth.people.positions, world.truth.people.legs, world.scan().ranges))
    return b"".join(np.ascontiguousarray(array).tobytes() for row in rows for array in row)


def test_each_behaviour_of_ones_own_adds_a_person_and_changes_nobody_elses_start():
    without, with_them = make(people=3), make(people=3, behaviours=(Shy(), Restless()))
    assert len(with_them.truth.people) == len(without.truth.people) + 2
    assert np.array_equal(with_them.truth.people.positions[:3], without.truth.people.positions)
    assert with_them.truth.people.positions[4] == pytest.approx((4.0, 0.0))


def test_a_behaviour_sees_the_robot_and_wishes_a_speed():
    world = make(people=0, leader=False, behaviours=(Shy(),))
    moved = []
    for _ in range(300):
        before = world.truth.people.positions[0]
        world.step((1.0, 0.0))
        truth = world.truth
        moved.append((np.hypot(*(before - truth.robot_pose[:2])), np.hypot(*truth.people.velocities[0])))
        if truth.contact_person:
            break
    far, near = [v for d, v in moved if d > 6.0], [v for d, v in moved if d < 2.5]
    assert max(far) > 0.6
    assert min(near) < 0.1


def test_a_goal_is_walked_to_straight():
    world = make(people=0, leader=False, behaviours=(Restless(),))
    places = []
    for _ in range(200):
        world.step((0.0, 0.0))
        places.append(world.truth.people.positions[0])
    assert np.ptp(places, axis=0).min() > 0.5
    assert np.abs(np.array(places) - (4.0, 0.0)).max() < 1.6


def test_what_behaviours_remember_is_saved_restored_and_pickled_with_the_world():
    world = make(people=2, behaviours=(Shy(), Restless()))
    record(world, 40)
    state, copied = world.save_state(), pickle.loads(pickle.dumps(world))
    onward = record(world, 60)
    world.restore_state(state)
    assert record(world, 60) == onward
    assert record(copied, 60) == onward


def test_an_episode_begins_with_a_copy_of_the_behaviour_that_was_given():
    shy = Shy()
    world = make(people=0, leader=False, behaviours=[shy])
    for _ in range(100):
        world.step((1.0, 0.0))
    assert shy.frightened_s == 0.0
    assert world._now.crowd.behaviours[0].frightened_s > 0.0


@pytest.mark.parametrize("given", ["shy", [Shy], [None], Shy()])
def test_what_is_no_list_of_behaviours_is_refused(given):
    with pytest.raises(InputError, match="`behaviours` must be a list of `Behaviour` objects, got"):
        WorldConfig(behaviours=given)


@pytest.mark.parametrize("start", [(0.0, 0.0), (1e6, 0.0, np.nan), (2.0, 1.1, 0.0), "here"])
def test_a_start_that_is_no_free_place_is_refused(start):
    lost = Shy()
    lost.start = start
    with pytest.raises(InputError, match=r"`Shy\.start` must be"):
        make(behaviours=(lost,))


@pytest.mark.parametrize(
    "wish", [None, 1.0, Wish(np.nan), Wish(9.0), Wish(1.0, sense=0.5), Wish(1.0, goal=(0, np.inf))]
)
def test_a_behaviour_that_wishes_nonsense_is_named(wish):
    class Odd(Shy):
        def wish(self, view, dt):
            return wish

    with pytest.raises(InputError, match=r"`Odd\.wish` must"):
        make(behaviours=(Odd(),)).step((0.0, 0.0))
