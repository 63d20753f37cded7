"""The PID follower on an ideal unicycle behind a leader of known motion; no simulator."""

import math

import numpy as np
import pytest
from tagalong.agents import PIDFollower, PurePursuitFollower, make_follower
from tagalong.agents.scripted.avoidance import AvoidanceConfig, free_heading, free_lengths, free_turns
from tagalong.agents.scripted.leader_memory import LeaderMemory, MemoryConfig, Mode
from tagalong.agents.scripted.pid import PIDConfig
from tagalong.agents.scripted.pid_axis import Axis, AxisConfig
from tagalong.agents.scripted.pure_pursuit import PurePursuitConfig
from tagalong.agents.scripted.scan_points import ScanPoints
from tagalong.envs.task import FollowInterface
from tagalong.slam import InputError

BEAMS = 181
INTERFACE = FollowInterface(bearings=np.deg2rad(np.linspace(-135, 135, BEAMS)))


def drive(follower, leader_at, seconds, hidden=lambda t: False, step=0.1):
    """Run an ideal unicycle from the origin; return rows of (t, robot x, y, theta, leader x, y, speed, turn)."""
    x = y = theta = speed = turn = 0.0
    rows = []
    for k in range(int(seconds / step)):
        t = k * step
        lx, ly = leader_at(t)
        vx, vy = (np.array(leader_at(t + 1e-3)) - (lx, ly)) / 1e-3
        cos, sin = math.cos(theta), math.sin(theta)
        local = (cos * (lx - x) + sin * (ly - y), -sin * (lx - x) + cos * (ly - y))
        seen = not hidden(t)
        leader = [*local, cos * vx + sin * vy, -sin * vx + cos * vy, 0.9, 1.0] if seen else [0.0] * 6
        action = follower.act(
            {
                "scan": np.ones(BEAMS, dtype=np.float32),
                "leader": np.array(leader, dtype=np.float32),
                "people": np.zeros((6, 6), dtype=np.float32),
                "velocity": np.array([speed, turn], dtype=np.float32),
            }
        )
        assert np.all(np.abs(action) <= 1.0)
        speed, turn = action[0] * INTERFACE.max_speed, action[1] * INTERFACE.max_turn_rate
        rows.append((t, x, y, theta, lx, ly, speed, turn))
        x, y, theta = x + speed * math.cos(theta) * step, y + speed * math.sin(theta) * step, theta + turn * step
    return np.array(rows)


def test_what_a_short_laser_does_not_reach_is_no_obstacle():
    points = ScanPoints(FollowInterface(bearings=np.array([0.0, 0.5]), range_max=2.0, T_robot_lidar=(0.0, 0.0, 0.0)))
    assert points.near({"scan": np.array([0.5, 1.0], dtype=np.float32)}, 2.5).tolist() == [[1.0, 0.0]]


@pytest.mark.parametrize("name", ["pid", "pure_pursuit", "dwa", "mppi"])
def test_who_needs_a_leader_says_so_where_nobody_leads(name):
    observation = {"scan": np.ones(BEAMS, dtype=np.float32), "velocity": np.zeros(2), "people": np.zeros((6, 6))}
    with pytest.raises(InputError, match="needs a leader"):
        make_follower(name, INTERFACE).act(observation)


def test_the_distance_settles_at_1_3_m_behind_a_straight_leader():
    rows = drive(PIDFollower(INTERFACE), lambda t: (1.3 + 0.9 * t, 0.0), 15.0)
    distance = np.hypot(rows[:, 4] - rows[:, 1], rows[:, 5] - rows[:, 2])
    assert np.sqrt(np.mean((distance[30:] - 1.3) ** 2)) < 0.15
    assert distance[-1] == pytest.approx(1.3, abs=0.06)


def test_speed_changes_no_faster_than_the_acceleration_limit():
    follower = PIDFollower(INTERFACE)
    rows = drive(follower, lambda t: (4.0 if t < 5.0 else 0.8, 0.0), 10.0)
    assert np.abs(np.diff(rows[:, 6])).max() <= follower.config.braking * 0.1 + 1e-6


def test_it_backs_away_from_a_leader_who_comes_near():
    rows = drive(PIDFollower(INTERFACE), lambda t: (1.3 + 0.8 * t if t < 3.0 else max(3.0, 5.2 - 0.5 * t), 0.0), 10.0)
    assert rows[-1, 4] - rows[-1, 1] == pytest.approx(1.3, abs=0.1)


@pytest.mark.parametrize("make", [PIDFollower, PurePursuitFollower])
def test_it_does_not_back_over_ground_that_it_has_not_seen(make):
    follower = make(INTERFACE)
    drive(follower, lambda t: (1.3 + 0.8 * t, 0.0), 4.0)
    follower.reset()  # another episode: it knows nothing of what it saw in that before
    rows = drive(follower, lambda t: (max(0.8, 1.5 - 0.5 * t), 0.0), 8.0)
    assert rows[:, 1].min() > -0.01
    rows = drive(make(INTERFACE), lambda t: (1.3 + 0.8 * t if t < 1.5 else max(0.8, 4.0 - 1.0 * t), 0.0), 12.0)
    assert rows[:, 1].max() > 0.8  # it went so far, and comes back to where it stood, less the space that it keeps
    assert 0.0 < rows[-1, 1] < 0.3


def test_it_turns_towards_a_leader_behind_it():
    rows = drive(PIDFollower(INTERFACE), lambda t: (-2.0, 0.1), 14.0)
    assert math.hypot(rows[-1, 1] + 2.0, rows[-1, 2] - 0.1) == pytest.approx(1.3, abs=0.1)


def test_a_lost_leader_is_approached_then_searched_and_taken_up_again():
    follower = PIDFollower(INTERFACE)
    rows = drive(follower, lambda t: (1.3, 0.0) if t < 1 else (3.0, 3.0), 26.0, hidden=lambda t: 0.95 < t < 12.0)
    searching = rows[90:118]
    assert np.hypot(rows[85, 1] - 1.3, rows[85, 2]) < 0.8
    assert np.abs(searching[:, 7]).min() > 0.4
    assert np.hypot(rows[-1, 4] - rows[-1, 1], rows[-1, 5] - rows[-1, 2]) == pytest.approx(1.3, abs=0.15)


def test_it_waits_until_a_leader_was_seen():
    rows = drive(PIDFollower(INTERFACE), lambda t: (2.0, 0.0), 2.0, hidden=lambda t: True)
    assert not rows[:, 6:].any()


def test_a_reset_follower_acts_like_a_new_one():
    follower = PIDFollower(INTERFACE)
    first = drive(follower, lambda t: (2.0 + t, 0.3), 3.0)
    follower.reset()
    assert np.array_equal(first, drive(follower, lambda t: (2.0 + t, 0.3), 3.0))


def test_a_blocked_heading_is_left_for_the_nearest_free_one():
    config = AvoidanceConfig()
    wall = np.stack((np.full(30, 1.0), np.linspace(-1.0, 0.2, 30)), axis=1)
    way = free_heading(0.0, 3.0, wall, 0.0, config, FollowInterface())
    assert way.heading > 0.3
    assert way.ahead == pytest.approx(1.0 - FollowInterface().half_length - config.front)
    assert free_heading(0.0, 3.0, np.zeros((0, 2)), 0.0, config, FollowInterface()).heading == pytest.approx(0.0)


def test_things_behind_and_beside_the_robot_do_not_block_it():
    config = AvoidanceConfig()
    points = np.array([[-1.0, 0.0], [0.5, FollowInterface().half_width + config.margin + 0.01]])
    assert free_lengths(np.zeros(1), points, config, FollowInterface())[0] == config.horizon


@pytest.mark.parametrize("ahead", [0.0, 0.05, 0.3, 1.0, 3.0])
def test_it_is_never_too_fast_to_stop_in_front_of_what_is_ahead(ahead):
    follower, config = PIDFollower(), PIDConfig()
    speed = follower._safe_speed(ahead)
    assert speed * config.reaction_s + speed**2 / (2.0 * config.braking) == pytest.approx(ahead, abs=1e-9)


def test_the_integral_does_not_wind_up():
    axis = Axis(AxisConfig(proportional=0.0, integral=1.0, integral_limit=0.3), 0.1)
    for _ in range(100):
        held = axis.update(1.0)
    assert held == pytest.approx(0.3)
    assert axis.update(-1.0) < held
    saturated = Axis(AxisConfig(proportional=0.0, integral=1.0), 0.1)
    assert saturated.update(1.0, saturated=True) == 0.0


def test_an_unseen_leader_stays_where_it_is_while_the_robot_turns():
    memory = LeaderMemory(MemoryConfig(), 0.1)
    memory.update([2.0, 0.0, 0.0, 0.0, 1.0, 1.0], (0.0, 0.0, 0.0))
    for _ in range(20):
        goal = memory.update([0.0] * 6, (0.0, 0.0, math.pi / 4))
    assert (goal.x, goal.y) == pytest.approx((0.0, -2.0), abs=1e-9)
    assert goal.mode is Mode.APPROACH


@pytest.mark.parametrize(
    ("predicted", "told", "place"),
    [(False, (1.0, 1.5), (2.0, 0.0)), (True, (1.0, 1.5), (1.0, 1.5)), (True, (0.0, 0.0), (2.0, 0.0))],
)
def test_a_lost_leader_is_where_the_tracker_predicts_it_only_if_that_is_wanted_and_told(predicted, told, place):
    memory = LeaderMemory(MemoryConfig(predicted=predicted), 0.1)
    memory.update([2.0, 0.0, 0.0, 0.0, 1.0, 1.0], (0.0, 0.0, 0.0))
    for _ in range(10):
        goal = memory.update([*told, 0.0, 0.0, 0.0, 0.0], (0.0, 0.0, 0.0))
    assert goal.mode is Mode.APPROACH
    assert (goal.x, goal.y) == pytest.approx(place)
    assert not MemoryConfig().predicted  # PID goes to where it would be by its last velocity


def test_an_unknown_follower_is_refused_with_the_list():
    with pytest.raises(InputError, match="followers: dwa, frontier, learned, mapper, mppi, pid"):
        make_follower("pdi")


def turned_until_touch(points, side, kept):
    """Return how far the robot's box, grown by `kept` (n,), can turn before it meets a point, step by step [rad]."""
    robot = FollowInterface()
    for angle in np.arange(0.0, np.pi, 1e-3):
        cos, sin = math.cos(side * angle), math.sin(side * angle)
        x, y = cos * points[:, 0] + sin * points[:, 1], cos * points[:, 1] - sin * points[:, 0]
        inside = (np.abs(x) < robot.half_length + kept - 1e-9) & (np.abs(y) < robot.half_width + kept - 1e-9)
        if inside.any():
            return angle
    return np.pi


def test_free_turns_are_those_after_which_the_box_meets_something():
    rng, robot, config = np.random.default_rng(4), FollowInterface(), AvoidanceConfig()
    for _ in range(60):
        points = rng.uniform(-0.5, 0.5, (rng.integers(1, 4), 2))
        gaps = np.maximum(np.abs(points[:, 0]) - robot.half_length, np.abs(points[:, 1]) - robot.half_width)
        points, gaps = points[gaps > 0.0], gaps[gaps > 0.0]
        kept = np.minimum(gaps, config.turning)
        left, right = free_turns(points, config, robot)
        assert left == pytest.approx(turned_until_touch(points, 1.0, kept), abs=2e-3)
        assert right == pytest.approx(turned_until_touch(points, -1.0, kept), abs=2e-3)


def test_what_touches_the_robot_already_does_not_hold_it():
    assert free_turns(np.array([[0.2, 0.1]]), AvoidanceConfig(), FollowInterface()) == (np.pi, np.pi)


@pytest.mark.parametrize("kind", [PIDFollower, PurePursuitFollower])
def test_a_corner_is_not_turned_into_a_door_frame_and_the_robot_drives_on(kind):
    interface = FollowInterface(bearings=np.deg2rad(np.linspace(-135, 135, BEAMS)))
    follower, scan = kind(interface), np.ones(BEAMS, dtype=np.float32)
    post = np.array([0.17, 0.386]) - interface.T_robot_lidar[:2]  # beside the left front corner
    beam = int(np.argmin(np.abs(interface.bearings - math.atan2(post[1], post[0]))))
    scan[beam] = np.hypot(*post) / interface.range_max
    leader = np.array([0.0, 3.0, 0.0, 0.0, 0.9, 1.0], dtype=np.float32)  # to the left, behind the post
    observation = {"leader": leader, "people": np.zeros((6, 6), np.float32), "velocity": np.zeros(2, np.float32)}
    hindered = [follower.act({"scan": scan, **observation}) for _ in range(10)][-1]
    follower.reset()
    free = [follower.act({"scan": np.ones(BEAMS, dtype=np.float32), **observation}) for _ in range(10)][-1]
    assert free[1] == 1.0
    assert hindered[1] < 0.7
    assert hindered[0] > 0.1 > 0.0 == pytest.approx(free[0], abs=1e-6)


def test_a_search_turns_back_where_it_cannot_turn_any_further():
    memory = LeaderMemory(MemoryConfig(dwell_s=0.0, approach_s=0.1, patience_s=0.0), 0.1)
    memory.update([1.0, 0.5, 0.0, 0.0, 0.9, 1.0], (0.0, 0.0, 0.0))
    for _ in range(4):
        goal = memory.update([0.0] * 6, (0.0, 0.0, 0.0))
    assert goal.mode is Mode.SEARCH
    assert memory.look_around(lambda turn: turn) == 0.5
    assert memory.look_around(lambda turn: min(turn, 0.0)) == 0.0
    assert memory.look_around(lambda turn: min(turn, 0.0)) == -0.5


QUICK = MemoryConfig(dwell_s=0.0, approach_s=0.1, patience_s=0.0)


@pytest.mark.parametrize(
    "follower",
    [
        PIDFollower(INTERFACE, PIDConfig(memory=QUICK)),
        PurePursuitFollower(INTERFACE, PurePursuitConfig(memory=QUICK)),
    ],
    ids=["pid", "pure_pursuit"],
)
@pytest.mark.parametrize(
    "leader",
    [[0.0] * 6, [1.2, 0.6, 0.0, 0.0, 0.9, 1.0], [0.75, 0.45, 0.0, 0.0, 0.9, 1.0]],
    ids=["lost", "at the distance kept", "too near"],
)
def test_between_two_posts_nobody_turns_whatever_the_leader_does(follower, leader):
    def turned(posts):
        scan = np.ones(BEAMS, dtype=np.float32)
        for post in np.array(posts).reshape(-1, 2) - INTERFACE.T_robot_lidar[:2]:
            beam = int(np.argmin(np.abs(INTERFACE.bearings - math.atan2(post[1], post[0]))))
            scan[beam] = np.hypot(*post) / INTERFACE.range_max
        follower.reset()
        for row in [[1.0, 0.5, 0.0, 0.0, 0.9, 1.0], *[leader] * 8]:
            leads = np.array(row, dtype=np.float32)
            seen = {"leader": leads, "people": np.zeros((6, 6), np.float32), "velocity": np.zeros(2, np.float32)}
            action = follower.act({"scan": scan, **seen})
        return abs(action[1])

    assert turned([]) > 0.2
    assert turned([[0.27, 0.3], [0.27, -0.3]]) < 0.1
