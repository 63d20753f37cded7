"""Pure pursuit, dynamic window and exploration on ideal motion and drawn rooms; no simulator."""

import math
from dataclasses import replace

import numpy as np
import pytest
from grid_field_reference import way_field_reference
from tagalong.agents import EXPLORERS, FOLLOWERS, make_follower
from tagalong.agents.scripted.dwa import DWAFollower
from tagalong.agents.scripted.dynamic_window import DynamicWindow, DynamicWindowConfig, Obstacles, arcs
from tagalong.agents.scripted.footprint_kernel import box_gaps
from tagalong.agents.scripted.frontier import FrontierExplorer
from tagalong.agents.scripted.frontier_plan import FrontierConfig, frontiers, place_ahead, plan_way
from tagalong.agents.scripted.grid_field import way_field
from tagalong.agents.scripted.leader_trail import LeaderTrail
from tagalong.agents.scripted.passed_points import PassedPoints
from tagalong.agents.scripted.pure_pursuit import PurePursuitFollower
from tagalong.agents.scripted.random_walk import RandomWalk
from tagalong.envs.task import FollowInterface, OwnMap
from tagalong.slam import InputError, OccupancyMap

BEAMS = 181
BEARINGS = np.deg2rad(np.linspace(-135, 135, BEAMS))
INTERFACE = FollowInterface(bearings=BEARINGS, T_robot_lidar=(0.0, 0.0, 0.0))
NOTHING = Obstacles(np.empty((0, 2)), np.empty((0, 4)))


def observation(leader=None, speed=0.0, turn=0.0, ranges=30.0, people=()):
    table = np.zeros((6, 6), dtype=np.float32)
    for row, person in enumerate(people):
        table[row] = [*person, 0.9, 1.0]
    return {
        "scan": (np.broadcast_to(ranges, BEAMS) / 30.0).astype(np.float32),
        "leader": np.array([0.0] * 6 if leader is None else [*leader, 0.9, 1.0], dtype=np.float32),
        "people": table,
        "velocity": np.array([speed, turn], dtype=np.float32),
    }


def drive(follower, leader_at, seconds):
    """Run an ideal unicycle behind a leader; return rows of (robot x, y, leader x, y, speed)."""
    x = y = theta = speed = turn = 0.0
    rows = []
    for t in np.arange(0.0, seconds, 0.1):
        lx, ly = leader_at(t)
        vx, vy = (np.array(leader_at(t + 1e-3)) - (lx, ly)) / 1e-3
        cos, sin = math.cos(theta), math.sin(theta)
        local = (cos * (lx - x) + sin * (ly - y), -sin * (lx - x) + cos * (ly - y))
        action = follower.act(observation([*local, cos * vx + sin * vy, -sin * vx + cos * vy], speed, turn))
        assert np.all(np.abs(action) <= 1.0)
        speed, turn = action[0] * INTERFACE.max_speed, action[1] * INTERFACE.max_turn_rate
        x, y, theta = x + speed * math.cos(theta) * 0.1, y + speed * math.sin(theta) * 0.1, theta + turn * 0.1
        rows.append((x, y, lx, ly, speed))
    return np.array(rows)


@pytest.mark.parametrize("make", [PurePursuitFollower, DWAFollower])
def test_the_distance_settles_near_1_3_m_behind_a_straight_leader(make):
    rows = drive(make(INTERFACE), lambda t: (1.3 + 0.8 * t, 0.0), 15.0)
    distance = np.hypot(rows[:, 2] - rows[:, 0], rows[:, 3] - rows[:, 1])
    assert np.abs(distance[60:] - 1.3).max() < 0.4


@pytest.mark.parametrize("make", [PurePursuitFollower, DWAFollower])
def test_it_backs_away_from_a_leader_who_comes_near(make):
    rows = drive(make(INTERFACE), lambda t: (1.3 + 0.8 * t if t < 3.0 else max(2.8, 5.2 - 0.5 * t), 0.0), 10.0)
    assert rows[-1, 2] - rows[-1, 0] > 1.0


@pytest.mark.parametrize("name", ["pure_pursuit", "dwa"])
def test_it_waits_until_a_leader_was_seen_and_looks_for_a_lost_one(name):
    follower = make_follower(name, INTERFACE)
    assert not follower.act(observation()).any()
    follower.act(observation([1.3, 0.0, 0.0, 0.0]))
    unseen = {**observation(), "leader": np.zeros(6, dtype=np.float32)}
    turns = [follower.act(unseen)[1] for _ in range(200)]
    assert np.abs(turns[-1]) > 0.1
    follower.reset()
    assert not follower.act(unseen).any()


def test_pure_pursuit_goes_round_a_corner_where_the_leader_went():
    def corner(t):
        return (1.3 + 0.8 * t, 0.0) if t < 5.0 else (5.3, 0.8 * (t - 5.0))

    rows = drive(PurePursuitFollower(INTERFACE), corner, 14.0)
    off_trail = np.minimum(np.abs(rows[:, 1]), np.abs(rows[:, 0] - 5.3))
    assert off_trail.max() < 0.45
    assert rows[-1, 1] > 4.0


def test_arcs_are_those_of_a_unicycle():
    poses = arcs(np.array([1.0, 1.0]), np.array([0.0, math.pi / 2]), np.array([1.0]))
    assert poses[0, 0] == pytest.approx([1.0, 0.0, 0.0])
    assert poses[1, 0] == pytest.approx([2 / math.pi, 2 / math.pi, math.pi / 2])


def run_window(around, target, seconds=6.0, robot=INTERFACE):
    """Drive towards a fixed place among fixed things, on ideal motion; return the poses (n, 3)."""
    window, pose, poses = DynamicWindow(DynamicWindowConfig(), robot), np.zeros(3), []
    for _ in range(int(seconds * 10)):
        cos, sin = math.cos(pose[2]), math.sin(pose[2])
        into = np.array([[cos, -sin], [sin, cos]])
        people = np.array([[*((p[:2] - pose[:2]) @ into), 0.0, 0.0] for p in around.people]).reshape(-1, 4)
        local = Obstacles((around.obstacles - pose[:2]) @ into, people)
        goal = (np.asarray(target) - pose[:2]) @ into
        speed, turn = window.choose(goal, goal, local)
        pose += np.array([speed * cos, speed * sin, turn]) * 0.1
        poses.append(pose.copy())
    return np.array(poses)


def test_the_window_drives_to_the_target_and_around_what_stands_in_the_way():
    free = run_window(NOTHING, (3.0, 0.0))
    assert free[-1, :2] == pytest.approx([3.0, 0.0], abs=0.2)
    post = np.stack((np.full(9, 1.5), np.linspace(0.1, 0.35, 9)), axis=-1)
    poses = run_window(Obstacles(post, np.empty((0, 4))), (3.5, 0.0), 10.0)
    assert box_gaps_reference(poses[None], post, INTERFACE, 9.0).min() > 0.03
    assert poses[-1, :2] == pytest.approx([3.5, 0.0], abs=0.3)


def box_gaps_reference(poses, obstacles, robot, far):
    """As `box_gaps`, pair by pair, by numpy."""
    gaps = np.full(poses.shape[:2], far)
    for index in np.ndindex(*gaps.shape):
        x, y, theta = poses[index]
        into = np.array([[math.cos(theta), -math.sin(theta)], [math.sin(theta), math.cos(theta)]])
        beyond = np.abs((obstacles - (x, y)) @ into) - (robot.half_length, robot.half_width)
        outside, inside = np.hypot(*np.maximum(beyond, 0.0).T), np.minimum(beyond.max(axis=1), 0.0)
        gaps[index] = min(far, (outside + inside).min(initial=far))
    return gaps


def test_gaps_of_the_footprint_are_those_of_a_box():
    rng = np.random.default_rng(3)
    poses, obstacles = rng.uniform(-3.0, 3.0, (20, 6, 3)), rng.uniform(-3.0, 3.0, (60, 2))
    box = INTERFACE.half_length, INTERFACE.half_width
    gaps = box_gaps(poses, obstacles, *box, 0.4)
    assert gaps == pytest.approx(box_gaps_reference(poses, obstacles, INTERFACE, 0.4))
    assert (gaps < 0.0).any()
    assert (gaps == 0.4).any()
    assert (box_gaps(poses, np.empty((0, 2)), *box, 0.4) == 0.4).all()


def test_the_window_never_creeps_up_to_what_is_in_the_way():
    wall = np.stack((np.full(61, 1.8), np.linspace(-3, 3, 61)), axis=-1)
    rng, window, x = np.random.default_rng(0), DynamicWindow(DynamicWindowConfig(), INTERFACE), 0.0
    for _ in range(900):
        seen = wall - (x, 0.0) + rng.normal(0.0, 0.01, wall.shape)
        target = np.array([4.0 - x, 0.0])
        x += 0.1 * window.choose(target, target, Obstacles(seen, np.empty((0, 4))))[0]
    assert 1.8 - x - INTERFACE.half_length > DynamicWindowConfig().margin - 0.01


def test_the_window_passes_a_door_that_is_little_wider_than_the_robot():
    jambs = np.stack(
        (np.full(40, 1.5), np.concatenate((np.linspace(0.375, 2.0, 20), -np.linspace(0.375, 2.0, 20)))), -1
    )
    poses = run_window(Obstacles(jambs, np.empty((0, 4))), (3.0, 0.0), 10.0)
    assert poses[-1, :2] == pytest.approx([3.0, 0.0], abs=0.3)


def test_a_turn_on_the_spot_touches_nothing():
    window = DynamicWindow(DynamicWindowConfig(), INTERFACE)
    beside = Obstacles(np.array([[0.2, 0.31]]), np.empty((0, 4)))
    assert window.turn(0.5, beside) == (0.0, 0.0)
    assert window.turn(0.5, NOTHING)[1] > 0.0


def test_what_the_laser_has_passed_is_minded_until_it_is_behind():
    passed, points = PassedPoints(INTERFACE, 1.0), np.array([[0.0, 0.5], [1.0, 0.0]])
    assert passed.update(points, (0.0, 0.0, 0.0)) == pytest.approx(points)
    kept = passed.update(np.empty((0, 2)), (8.0, 0.0, 0.0))  # 0.8 m on: one is beside the tail, the other in view, gone
    assert kept == pytest.approx(np.array([[-0.8, 0.5]]))
    turned = passed.update(np.empty((0, 2)), (0.0, 0.0, 1.0))
    assert turned == pytest.approx(
        np.array([[-0.8 * math.cos(0.1) + 0.5 * math.sin(0.1), 0.5 * math.cos(0.1) + 0.8 * math.sin(0.1)]])
    )
    for _ in range(9):
        left = passed.update(np.empty((0, 2)), (0.0, 0.0, 0.0))
    assert not len(left)


def test_the_trail_is_the_way_of_the_leader_seen_from_the_robot():
    trail = LeaderTrail(0.1, 0.1)
    for k in range(30):
        trail.extend(0.05 * k, 0.0)
    trail.carry_along((10.0, 0.0, 0.0))  # a metre on
    ahead = trail.ahead()
    assert ahead[0] == pytest.approx([0.0, 0.0], abs=0.08)
    assert ahead[-1] == pytest.approx([0.4, 0.0], abs=0.08)
    assert (np.diff(ahead[:, 0]) > 0.1 - 1e-9).all()
    assert trail.aim(0.3) == pytest.approx((0.35, 0.0), abs=0.08)
    assert trail.aim(2.0) is None


def test_the_window_follower_hurries_round_a_corner_where_the_leader_went():
    def fast(t):
        return (1.3 + 1.6 * t, 0.0) if t < 3.0 else (6.1, min(1.6 * (t - 3.0), 4.0))

    rows = drive(DWAFollower(INTERFACE), fast, 9.0)
    assert np.minimum(np.abs(rows[:, 1]), np.abs(rows[:, 0] - 6.1)).max() < 0.6
    assert rows[-1, 1] > 2.0


def test_the_window_follower_does_not_back_into_what_it_saw_before_it_turned():
    def backing(post):
        follower, ranges = DWAFollower(INTERFACE), np.full(BEAMS, 30.0)
        if post:
            ranges[np.argmin(np.abs(BEARINGS - math.pi / 2))] = 0.34
        follower.act(observation([0.0, 1.3, 0.0, 0.0], ranges=ranges))
        follower.act(observation([0.6, 0.0, 0.0, 0.0], turn=-5.0 * math.pi))  # a quarter to the right: it is behind now
        return min(follower.act(observation([0.6, 0.0, 0.0, 0.0]))[0] for _ in range(6)) * INTERFACE.max_speed

    assert backing(post=False) == pytest.approx(-0.3, abs=0.02)
    assert backing(post=True) > -0.15


SMALL, LARGE = (replace(INTERFACE, half_length=a, half_width=b) for a, b in ((0.228, 0.191), (0.5, 0.4)))


@pytest.mark.parametrize("robot", [SMALL, INTERFACE, LARGE])
def test_the_window_stops_in_front_of_a_wall_where_the_robot_can_still_turn(robot):
    wall = np.stack((np.full(61, 1.8), np.linspace(-3, 3, 61)), axis=-1)
    poses = run_window(Obstacles(wall, np.empty((0, 4))), (4.0, 0.0), 6.0, robot)
    assert 1.8 - poses[:, 0].max() == pytest.approx(robot.half_length + DynamicWindowConfig().comfort, abs=0.08)
    assert 1.8 - poses[:, 0].max() > robot.turning_radius


@pytest.mark.parametrize("wall", [0.0, 0.9])
def test_commands_of_the_window_change_no_faster_than_the_robot_can(wall):
    config = DynamicWindowConfig()
    window, commands = DynamicWindow(config, INTERFACE), [(0.0, 0.0)]
    ahead = np.stack((np.full(31, wall), np.linspace(-1.5, 1.5, 31)), axis=-1) if wall else np.empty((0, 2))
    for k in range(40):
        target = np.array([2.0 * math.cos(0.3 * k), 2.0 * math.sin(0.3 * k)])
        commands.append(window.choose(target, target, Obstacles(ahead, np.empty((0, 4)))))
    change = np.diff(commands, axis=0)
    assert change[:, 0].max() <= 0.1 * config.acceleration + 1e-9
    assert change[:, 0].min() >= -0.15 * config.acceleration - 1e-9
    assert np.abs(change[:, 1]).max() <= 0.1 * config.turn_acceleration + 1e-9
    assert np.abs(change[:, 1]).max() > 0.0


def test_people_are_given_more_room_than_things():
    beside = np.array([[1.5, 0.75]])
    thing = run_window(Obstacles(beside, np.empty((0, 4))), (3.5, 0.0))
    person = run_window(Obstacles(np.empty((0, 2)), np.array([[1.5, 0.75, 0.0, 0.0]])), (3.5, 0.0))
    nearest = [np.hypot(*(poses[:, :2] - beside).T).min() for poses in (thing, person)]
    assert nearest[1] > nearest[0] + 0.03


@pytest.mark.parametrize("seed", range(3))
def test_the_way_kernel_agrees_with_dijkstra(seed):
    rng = np.random.default_rng(seed)
    cost = np.where(rng.random((25, 40)) < 0.25, np.inf, rng.uniform(1.0, 3.0, (25, 40)))
    cost[5, 7] = 1.0
    field, parent = np.empty_like(cost), np.empty(cost.shape, dtype=np.int32)
    way_field(cost, 5, 7, field, parent)
    assert field == pytest.approx(way_field_reference(cost, 5, 7))
    assert parent[5, 7] == -1
    assert np.all((parent >= 0) == (np.isfinite(field) & (field > 0.0)))


def half_known_room():
    """A room of 6 x 3 m whose right half is not known yet; the robot stands in the left one."""
    probability = np.full((60, 120), np.nan, dtype=np.float32)
    probability[:, :60] = 0.1
    probability[[0, 59], :60] = 0.9
    probability[:, 0] = 0.9
    return OccupancyMap(probability, 0.05, (0.0, 0.0))


def test_the_frontier_is_where_the_known_floor_ends():
    free = np.zeros((6, 8), dtype=bool)
    free[1:5, 1:4] = True
    occupied = np.zeros_like(free)
    occupied[[0, 5], :5] = True
    occupied[:, 0] = True
    labels = frontiers(free, occupied)
    assert set(map(tuple, np.argwhere(labels > 0))) == {(1, 3), (2, 3), (3, 3), (4, 3)}


def test_the_way_leads_to_the_frontier_and_none_is_left_in_a_closed_room():
    own = OwnMap(half_known_room(), np.array([1.0, 1.5, 0.0]))
    way = plan_way(own, own.pose[None, :2], np.empty((0, 2)), INTERFACE, FrontierConfig())
    assert way is not None
    assert way.places[0] == pytest.approx([1.05, 1.55], abs=0.11)
    assert way.frontier[0] == pytest.approx(2.95, abs=0.15)
    other = plan_way(own, own.pose[None, :2], way.frontier[None], INTERFACE, FrontierConfig())
    assert other is not None
    assert np.hypot(*(other.frontier - way.frontier)) >= 0.5
    everywhere = np.column_stack((np.full(31, way.frontier[0]), np.linspace(0.0, 3.0, 31)))
    assert plan_way(own, own.pose[None, :2], everywhere, INTERFACE, FrontierConfig()) is None
    closed = half_known_room().probability.copy()
    closed[:, 59:] = 0.9
    shut = OwnMap(OccupancyMap(closed, 0.05, (0.0, 0.0)), own.pose)
    assert plan_way(shut, own.pose[None, :2], np.empty((0, 2)), INTERFACE, FrontierConfig()) is None


def test_a_narrow_robot_plans_through_a_gap_that_is_too_narrow_for_a_wide_one():
    room = half_known_room().probability.copy()
    room[:27, 35] = room[39:, 35] = 0.9  # 0.6 m are open
    own = OwnMap(OccupancyMap(room, 0.05, (0.0, 0.0)), np.array([0.7, 1.65, 0.0]))
    plans = [
        plan_way(own, own.pose[None, :2], np.empty((0, 2)), r, FrontierConfig()) for r in (SMALL, INTERFACE, LARGE)
    ]
    assert [plan is not None for plan in plans] == [True, False, False]


def test_a_frontier_that_begins_beside_the_robot_is_followed_to_where_it_is_not():
    own = OwnMap(half_known_room(), np.array([2.8, 1.5, 0.0]))
    way = plan_way(own, own.pose[None, :2], np.empty((0, 2)), INTERFACE, FrontierConfig())
    assert way is not None
    assert 0.6 <= np.hypot(*(way.frontier - own.pose[:2])) < 0.9
    far_ends = np.column_stack((np.full(60, 2.95), [*np.linspace(0.0, 0.95, 30), *np.linspace(2.05, 3.0, 30)]))
    beside = plan_way(own, own.pose[None, :2], far_ends, INTERFACE, FrontierConfig(reached=0.9))
    assert beside is not None, "what is left beside the robot counts when nothing else is left"
    assert np.hypot(*(beside.frontier - own.pose[:2])) < 0.6


def test_the_place_ahead_lies_on_the_way():
    places = np.stack((np.linspace(0.0, 5.0, 51), np.zeros(51)), axis=-1)
    assert place_ahead(places, np.array([1.0, 0.2, np.pi / 2]), 1.0) == pytest.approx([-0.2, -1.0], abs=0.11)


def test_the_frontier_explorer_drives_towards_the_unknown_and_then_is_done():
    own = OwnMap(half_known_room(), np.array([1.0, 1.5, 0.0]))
    explorer = FrontierExplorer(FollowInterface(bearings=BEARINGS, own_map=lambda: own))
    actions = [explorer.act(observation()) for _ in range(10)]
    assert actions[-1][0] > 0.3
    assert not explorer.done
    known = OwnMap(OccupancyMap(np.full((60, 120), 0.9, dtype=np.float32), 0.05, (0.0, 0.0)), own.pose)
    nowhere = FrontierExplorer(FollowInterface(bearings=BEARINGS, own_map=lambda: known))
    assert not nowhere.act(observation()).any()
    assert nowhere.done


def test_frontier_exploration_needs_a_map():
    with pytest.raises(InputError, match="own map"):
        make_follower("frontier", INTERFACE)


def test_the_random_walk_goes_straight_turns_away_from_a_wall_and_repeats_itself():
    walk = RandomWalk(INTERFACE)
    straight = [walk.act(observation(speed=0.5)) for _ in range(10)]
    assert straight[-1][0] > 0.5
    assert abs(straight[-1][1]) < 0.05
    wall = np.where(np.abs(BEARINGS) < 1.2, 0.7, 5.0)
    turned = [walk.act(observation(ranges=wall)) for _ in range(15)]
    assert max(abs(action[1]) for action in turned) > 0.1
    walk.reset()
    again = [walk.act(observation(speed=0.5)) for _ in range(10)]
    again += [walk.act(observation(ranges=wall)) for _ in range(15)]
    assert np.array_equal(again, straight + turned)


def test_there_are_followers_and_explorers():
    assert sorted(FOLLOWERS) == ["dwa", "learned", "mppi", "pid", "plain_pid", "pure_pursuit", "reinforced"]
    assert sorted(EXPLORERS) == ["frontier", "random"]
    with pytest.raises(InputError, match="pure_pursuit"):
        make_follower("nobody")


@pytest.mark.parametrize("make", [DWAFollower, RandomWalk])
def test_what_is_planned_can_be_driven(make):
    """A plan that turns faster than the robot may is cut on the way to the wheels: it would foresee another arc."""
    limited = FollowInterface(bearings=BEARINGS, max_turn_rate=0.5, max_speed=0.4)
    follower = make(limited)
    for _ in range(30):
        follower.act(observation([0.3, 2.5, 0.0, 0.0]))
        assert abs(follower._window._turn) <= 0.5
        assert abs(follower._window._speed) <= 0.4
    assert DynamicWindowConfig().within(FollowInterface()) == DynamicWindowConfig()


@pytest.mark.parametrize("name", ["pure_pursuit", "dwa", "random"])
def test_a_holonomic_robot_gets_three_numbers(name):
    follower = make_follower(name, FollowInterface(bearings=BEARINGS, holonomic=True))
    sight = observation([2.0, 0.0, 0.0, 0.0])
    sight["velocity"] = np.zeros(3, dtype=np.float32)
    action = follower.act(sight)
    assert action.shape == (3,)
    assert action[0] > 0.0
    assert action[1] == 0.0


@pytest.mark.parametrize("path", ["nowhere:Bold", "math:nothing", "math:pi", "collections:Counter", ":"])
def test_a_follower_of_ones_own_that_is_none_is_refused(path):
    with pytest.raises(InputError):
        make_follower(path, INTERFACE)


def test_a_follower_of_ones_own_may_ask_for_the_interface():
    follower = make_follower("tagalong.agents.scripted.pid:PIDFollower", INTERFACE)
    assert follower.interface is INTERFACE
