"""The guard at contact, and behind, where the laser does not look."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tagalong.agents.learned.braking import MOST_WISHES, brakes_in_time, guard_worlds, put_alternatives
from tagalong.agents.learned.guard import Guard, GuardConfig, box_gaps, driven, signed_gaps
from tagalong.agents.learned.steering import REST, SteeringConfig, steer, steer_many
from tagalong.agents.scripted.ground_behind import GroundBehind
from tagalong.envs.task import FollowInterface

STEERING, CONFIG = SteeringConfig(), GuardConfig()
SCALES = FollowInterface(bearings=np.deg2rad(np.linspace(-135.0, 135.0, 361)))
HERE = np.zeros((1, 3))


def seen(pose, walls, velocity=(0.0, 0.0)):
    """What the robot at `pose` measures of `walls`, each (a, b, c): the line a x + b y = c."""
    bearings = SCALES.bearings + pose[2]
    laser = pose[:2] + 0.1 * np.array((np.cos(pose[2]), np.sin(pose[2])))
    ranges = np.full(len(bearings), np.inf)
    for a, b, c in walls:
        with np.errstate(divide="ignore"):
            away = (c - a * laser[0] - b * laser[1]) / (a * np.cos(bearings) + b * np.sin(bearings))
        ranges = np.minimum(ranges, np.where(away > 0.0, away, np.inf))
    return {
        "scan": np.minimum(ranges / 30.0, 1.0).astype(np.float32),
        "leader": np.zeros(6, dtype=np.float32),
        "people": np.zeros((6, 6), dtype=np.float32),
        "velocity": np.array(velocity, dtype=np.float32),
    }


class Robot:
    """Drives in thought, exactly as commanded, past its guard."""

    def __init__(self, walls, pose=(0.0, 0.0, 0.0)):
        self.guard, self.walls = Guard(CONFIG, STEERING, SCALES), walls
        self.pose, self.state, self.nearest = np.array(pose, dtype=float), REST, np.inf

    def drive(self, wish, steps):
        """Wish so for some steps; return how far it came [m]."""
        before = self.pose.copy()
        for _ in range(steps):
            self.guard.observe(seen(self.pose, self.walls, (self.state[0], self.state[2])))
            self.state = steer(self.state, *self.guard.limit(self.state, wish), 0.1, STEERING)
            v, w, heading = self.state[0], self.state[2], self.pose[2] + 0.05 * self.state[2]
            self.pose = self.pose + 0.1 * np.array((v * np.cos(heading), v * np.sin(heading), w))
            corners = np.array([(x, y) for x in (-0.275, 0.275) for y in (-0.259, 0.259)])
            cos, sin = np.cos(self.pose[2]), np.sin(self.pose[2])
            placed = self.pose[:2] + corners @ np.array(((cos, sin), (-sin, cos)))
            for a, b, c in self.walls:
                inside = np.sign(c)
                self.nearest = min(self.nearest, float((inside * (c - placed @ (a, b))).min()))
        return float(np.hypot(*(self.pose - before)[:2]))


def test_the_gap_to_a_thing_inside_the_box_is_its_depth_below_zero():
    things = np.array([(0.375, 0.0), (0.275, 0.0), (0.265, 0.1), (0.0, -0.249), (0.315, 0.289)])
    gaps = signed_gaps(HERE, things, SCALES)[0]
    assert gaps == pytest.approx([0.1, 0.0, -0.01, -0.01, 0.05], abs=1e-9)
    assert box_gaps(HERE, things, SCALES)[0] == pytest.approx(-0.01)
    assert box_gaps(HERE, things[:1], SCALES)[0] == pytest.approx(0.1)
    assert box_gaps(HERE, np.zeros((0, 2)), SCALES)[0] == np.inf


places = st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)), min_size=1, max_size=20)


@given(places, st.lists(st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-4, 4)), min_size=1, max_size=5))
def test_the_least_gap_is_the_least_of_all_gaps(things, poses):
    table = signed_gaps(np.array(poses), np.array(things), SCALES)
    assert (box_gaps(np.array(poses), np.array(things), SCALES) == table.min(axis=1)).all()


@pytest.mark.parametrize("gap", [5e-5, 0.0, -0.005, -0.03])
def test_whoever_touches_a_wall_does_not_press_on(gap):
    robot = Robot([(1.0, 0.0, 0.275 + gap)])
    came = robot.drive((1.3, 0.0), 30)
    assert came <= 2e-3
    assert robot.nearest >= gap - 2e-3


def test_whoever_touches_a_wall_may_leave_it_over_the_ground_that_it_came_over():
    robot = Robot([(1.0, 0.0, 3.0)])
    robot.drive((0.8, 0.0), 15)
    robot.pose[0] = 3.0 - 0.275 + 0.01  # pushed on to it
    robot.state = REST
    assert robot.drive((-0.4, 0.0), 8) > 0.1


def test_a_touch_on_one_side_is_no_leave_to_touch_something_else():
    robot = Robot([(0.0, 1.0, 0.25), (1.0, 0.0, 1.0)])  # a wall along the left side, 9 mm inside; one ahead
    robot.drive((1.0, 0.0), 40)
    ahead = 1.0 - robot.pose[0] - 0.275
    assert ahead > -1e-3


def test_nobody_backs_over_ground_that_was_never_seen():
    robot = Robot([])
    assert robot.drive((-0.4, 0.0), 30) < 0.01
    robot.drive((0.6, 0.0), 12)
    robot.drive((0.0, 0.0), 12)
    forth = robot.pose[0]
    back = robot.drive((-0.4, 0.0), 60)
    assert forth - 0.15 < back < forth + 0.05


def test_whoever_has_turned_away_from_a_wall_does_not_back_into_it_however_long_ago_it_was_seen():
    robot = Robot([(1.0, 0.0, 1.0)])
    robot.drive((0.0, 1.2), 26)  # about half a turn
    robot.drive((0.0, 0.0), 60)
    robot.drive((-0.4, 0.0), 60)
    assert robot.nearest > 0.0


def test_whoever_has_looked_round_may_back_where_it_saw_that_there_is_room():
    robot = Robot([(1.0, 0.0, 4.0)])
    robot.drive((0.0, 1.2), 26)
    robot.drive((0.0, 0.0), 10)
    assert robot.drive((-0.4, 0.0), 40) > 0.8


def test_the_newest_view_of_a_place_counts():
    ground = GroundBehind(SCALES)
    turn = np.pi / 10.0  # each step 18 degrees
    for k in range(11):  # half a turn in an empty place: what is behind now was ahead
        ground.observe(seen((0.0, 0.0, k * turn), [], (0.0, turn / 0.1 if k else 0.0)))
    assert ground.room() == 1.0
    for k in range(20):  # a whole turn, and now there is a wall
        ground.observe(seen((0.0, 0.0, np.pi + (k + 1) * turn), [(1.0, 0.0, 0.7)], (0.0, turn / 0.1)))
    assert 0.3 < ground.room() < 0.7 - 0.275
    ground.reset()
    assert ground.room() == 0.0


states = st.tuples(st.floats(-0.4, 1.3), st.floats(-1.8, 1.2), st.floats(-1.6, 1.6), st.floats(-3.0, 3.0))
wished = st.tuples(st.floats(-0.4, 1.3), st.floats(-1.6, 1.6))


walks = st.tuples(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5))


@given(states, wished, places, walks, st.floats(-0.05, 0.04))
def test_braking_in_thought_is_driving_in_thought(state, wish, places, walk, bound):
    near = np.column_stack((np.array(places), np.full(len(places), bound), np.tile(walk, (len(places), 1))))
    robot = CONFIG.of(SCALES)
    keeps, back = brakes_in_time(np.array(state), *wish, near, np.array(STEERING.as_tuple()), robot)
    then, pose, spare, farthest = np.array([state]), HERE, np.inf, 0.0
    for k in range(CONFIG.brake_steps + 1):
        then = steer_many(then, np.array([wish if k == 0 else (0.0, 0.0)]), 0.1, STEERING)
        pose = driven(pose, then, 0.1)
        now, later = (signed_gaps(pose, near[:, :2] + shift, SCALES) for shift in (0.0, 0.1 * (k + 1) * near[:, 3:]))
        spare = min(spare, float(np.maximum(now, later).min()) - bound)
        farthest = max(farthest, -float(pose[0, 0]))
        if np.abs(then[0, [0, 2]]).sum() < 1e-3:
            break
    if abs(spare) > 1e-9:
        assert keeps == (spare > 0.0)
    if keeps:
        assert back == pytest.approx(farthest, abs=1e-9)


def stopped_by(places, leader=None, people=(), speed=1.0):
    """Whether a robot at this speed is stopped by returns at these places, while it believes in these people."""
    observation = seen(np.zeros(3), [])
    for x, y in places:
        bearing = np.arctan2(y, x - 0.1)
        observation["scan"][int(np.abs(SCALES.bearings - bearing).argmin())] = np.hypot(x - 0.1, y) / 30.0
    if leader is not None:
        observation["leader"][:] = (*leader, 1.0, 1.0)
    for row, person in zip(observation["people"], people, strict=False):
        row[:] = (*person, 1.0, 1.0)
    guard = Guard(CONFIG, STEERING, SCALES)
    guard.observe(observation)
    return guard.limit((speed, 0.0, 0.0, 0.0), (speed, 0.0)) != (speed, 0.0)


FOOT = ((0.7, 0.0),)


def test_nobody_brakes_for_who_walks_out_of_the_way():
    assert stopped_by(FOOT)
    for velocity in ((1.0, 0.0), (0.0, 1.2), (0.3, -1.2)):
        assert not stopped_by(FOOT, leader=(0.8, 0.0, *velocity))
        assert not stopped_by(FOOT, people=[(3.0, 1.0, 0.0, 0.0), (0.8, 0.0, *velocity)])
    for velocity in ((0.0, 0.0), (0.05, 0.0), (-1.0, 0.0)):  # who stands, or comes
        assert stopped_by(FOOT, leader=(0.8, 0.0, *velocity))


def test_a_post_beside_a_walker_does_not_walk():
    assert stopped_by(FOOT, leader=(0.7, 0.35, 1.2, 0.0))
    assert stopped_by(FOOT, leader=(1.2, 0.0, 1.2, 0.0))  # more than a stride behind
    assert not stopped_by(FOOT, leader=(1.0, 0.1, 1.2, 0.0))


def test_who_comes_nearer_is_met_where_they_are_now():
    assert not stopped_by(((1.3, 0.0),), people=[(1.3, 0.0, -1.5, 0.0)])


def test_what_the_laser_sees_no_more_where_it_looks_is_gone():
    guard = Guard(CONFIG, STEERING, SCALES)
    guard.observe(seen(np.zeros(3), [(1.0, 0.0, 0.6)]))
    assert guard.limit((1.0, 0.0, 0.0, 0.0), (1.0, 0.0)) != (1.0, 0.0)
    guard.observe(seen(np.zeros(3), []))
    assert guard.limit((1.0, 0.0, 0.0, 0.0), (1.0, 0.0)) == (1.0, 0.0)


def test_a_return_is_the_nearest_person_s():
    walks, stands = (0.8, 0.1, 1.2, 0.0), (0.75, 0.0, 0.0, 0.0)
    assert stopped_by(FOOT, people=[walks, stands])
    assert stopped_by(FOOT, people=[stands, walks])


def test_who_cannot_brake_in_time_stops_as_quickly_as_can_be():
    observation = seen(np.zeros(3), [(1.0, 0.0, 0.28)])
    guard, state, speeds = Guard(CONFIG, STEERING, SCALES), (1.0, 0.0, 0.0, 0.0), []
    guard.observe(observation)
    for _ in range(20):
        state = steer(state, *guard.limit(state, (1.0, 0.0)), 0.1, STEERING)
        speeds.append(state[0])
    assert min(speeds) > -0.1  # its jerk is limited, too: it swings back by two centimetres
    assert 0.1 * sum(speed for speed in speeds if speed < 0.0) > -0.03
    assert np.diff(speeds).min() == pytest.approx(-0.1 * STEERING.braking)
    stands = next(k for k, speed in enumerate(speeds) if speed < 0.02)
    assert stands <= 7  # the limit of braking, and of its jerk


@given(wished)
def test_what_is_tried_instead_is_the_least_change_first(wish):
    tried = np.full((MOST_WISHES, 3), np.nan)
    put_alternatives(*wish, tried)
    changes = np.abs(tried[:, 0] - wish[0]) + 0.4 * np.abs(tried[:, 1] - wish[1])
    assert tried[:, 2] == pytest.approx(changes)
    assert (np.diff(tried[:, 2]) >= 0.0).all()
    expected = {(v, w) for v in [*(wish[0] * k for k in (1.0, 0.7, 0.45, 0.2, 0.0)), -0.15] for w in (
        wish[1], 0.5 * wish[1], 0.0, -0.6, 0.6)}  # fmt: skip
    assert {(v, w) for v, w, _ in tried.tolist()} == expected


def test_many_worlds_are_guarded_as_one_robot_is_that_remembers_nothing_yet():
    rng, changed = np.random.default_rng(0), 0
    turned = SCALES.bearings + SCALES.T_robot_lidar[2]
    directions = np.column_stack((np.cos(turned), np.sin(turned)))
    scratch = np.empty((len(turned), 5)), np.empty((MOST_WISHES, 3))
    for _ in range(60):
        walls = [
            (1.0, 0.0, rng.uniform(0.3, 1.2)),
            (0.0, 1.0, rng.uniform(0.3, 0.8)),
            (0.0, 1.0, rng.uniform(-0.8, -0.3)),
        ]
        observation = seen(np.zeros(3), walls)
        observation["leader"][:] = (rng.uniform(0.5, 1.2), rng.uniform(-0.2, 0.2), 1.2, 0.0, 1.0, rng.integers(2))
        observation["people"][0] = (rng.uniform(0.0, 1.0), rng.uniform(-0.8, 0.8), 0.0, 1.0, 1.0, rng.integers(2))
        state, wish = (
            (rng.uniform(0.0, 1.3), 0.0, rng.uniform(-1.0, 1.0), 0.0),
            (rng.uniform(0.0, 1.3), rng.uniform(-1.6, 1.6)),
        )
        guard = Guard(CONFIG, STEERING, SCALES)
        guard.room_behind = lambda: np.inf
        guard.observe(observation)
        wanted = np.array([wish, wish])
        guard_worlds(
            np.array([state, state]), wanted, np.stack([observation["scan"]] * 2),
            np.stack([observation["leader"]] * 2), np.stack([observation["people"]] * 2), directions,
            np.array(STEERING.as_tuple()), CONFIG.of(SCALES), *scratch,
        )  # fmt: skip
        expected = guard.limit(state, wish)
        assert wanted == pytest.approx(np.array([expected, expected]))
        changed += expected != wish
    assert 10 < changed < 60
