"""Who is held up before a door post, and who has lost the leader, is helped out of it."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.agents.learned.detour import Detour, DetourConfig
from tagalong.agents.learned.guard import GuardConfig, box_gaps
from tagalong.agents.learned.pilot import Pilot, PilotConfig
from tagalong.agents.learned.situation import Situation
from tagalong.agents.learned.steering import REST, SteeringConfig
from tagalong.agents.scripted.leader_memory import Goal, Mode
from tagalong.envs.task import FollowInterface
from tagalong.slam import InputError
from tagalong.slam.geometry import inverse, transform_points

GUARD = GuardConfig()
INTERFACE = FollowInterface(bearings=np.deg2rad(np.linspace(-135.0, 135.0, 271)))
POST = (1.6, 0.6)  # a wall goes from here to the right; behind it the leader turns to the right
WALL = np.stack((np.full(150, POST[0]), np.linspace(POST[1] - 4.5, POST[1], 150)), axis=1)
WAY = np.array([[1.3, 0.0], [1.5, 1.1], [2.3, 1.1], [2.6, 0.0], [2.6, -3.0]])


def known(room):
    """Ground behind that is known to be free so far [m]."""
    return lambda: room


FREE = known(1.0)


def scan_of(pose):
    """What the laser at `pose` sees of the wall."""
    origin = transform_points(pose, np.array([[0.1, 0.0]]))[0]
    angles = INTERFACE.bearings + pose[2]
    with np.errstate(divide="ignore", invalid="ignore"):
        ranges = (POST[0] - origin[0]) / np.cos(angles)
        across = origin[1] + ranges * np.sin(angles)
    met = (ranges > 0.0) & (across < POST[1]) & (across > POST[1] - 4.5)
    return (np.where(met, ranges, 30.0) / 30.0).astype(np.float32)


def pursue(detour, seconds, seen=lambda t: True):
    """Drive by somebody who wishes straight at the leader, wall or no wall; return the poses and the least gap."""
    pilot = Pilot(replace(PilotConfig(), keep_up=None, detour=detour, swerve=None), INTERFACE)
    arc = np.append(0.0, np.cumsum(np.hypot(*np.diff(WAY, axis=0).T)))
    pose, poses, least = np.zeros(3), [], np.inf
    for k in range(round(10 * seconds)):
        way = 0.6 * 0.1 * np.array((k, k + 1))
        here, then = (np.array([np.interp(s, arc, WAY[:, i]) for i in (0, 1)]) for s in way)
        place = transform_points(inverse(pose), here[None])[0]
        speed = transform_points(np.array((0.0, 0.0, -pose[2])), (then - here)[None])[0] / 0.1
        leader = [*place, *speed, 0.9, 1.0] if seen(k / 10) else [0.0] * 6
        told = {
            "scan": scan_of(pose),
            "leader": np.array(leader, dtype=np.float32),
            "people": np.zeros((6, 6), dtype=np.float32),
            "velocity": np.array((pilot.commanded[0], pilot.commanded[2]), dtype=np.float32),
        }
        pilot.inputs(told)
        bearing = np.arctan2(place[1], place[0])
        wish = np.clip(0.8 * (np.hypot(*place) - 1.0), -0.2, 0.8), np.clip(2.0 * bearing, -1.0, 1.0)
        pilot.drive(pilot.config.steering.output(*wish))
        v, w = pilot.commanded[0], pilot.commanded[2]
        pose = pose + 0.1 * np.array((v * np.cos(pose[2] + 0.05 * w), v * np.sin(pose[2] + 0.05 * w), w))
        poses.append(pose)
        least = min(least, float(box_gaps(pose[None], WALL, FollowInterface())[0]))
    return np.array(poses), least


def test_who_wishes_into_a_door_post_for_ever_is_led_round_it_without_a_touch():
    poses, least = pursue(None, 16)
    assert poses[-1, 0] < POST[0]  # the guard alone: there it stands
    assert least > 0.0
    poses, least = pursue(DetourConfig(), 16)
    assert poses[-1, 0] > POST[0] + 0.4
    assert poses[-1, 1] < 0.0
    assert least > 0.0


def test_a_lost_leader_is_looked_for_where_its_trail_ends_whatever_the_network_wishes():
    poses, least = pursue(DetourConfig(), 22, seen=lambda t: t < 5.0)
    assert np.hypot(*(poses[:, :2] - (2.6, 0.1)).T).min() < 0.8
    assert least > 0.0
    assert abs(poses[-1, 2] - poses[-20, 2]) > 0.8  # it looks around


def escaped(detour, wish, goal, trail, things, room, state=REST, search_turn=0.0):
    return detour.escape(wish, Situation(state, goal, search_turn, trail, things, np.zeros((0, 6)), room))


def relieved(state, wish, goal, trail, search_turn=0.0):
    detour = Detour(DetourConfig(), SteeringConfig(), FollowInterface())
    for _ in range(40):
        last = escaped(detour, wish, goal, np.array(trail), np.array([[0.5, 0.0]]), FREE, state, search_turn)
    return last


def test_who_gets_on_or_may_well_stand_is_left_alone():
    on = relieved((0.8, 0.0, 0.0, 0.0), (0.9, 0.1), Goal(Mode.FOLLOW, 2.5, 0.0, 0.9, 0.0), [[1.0, 0.0]])
    assert on == (0.9, 0.1)
    assert relieved(REST, (0.05, 0.0), Goal(Mode.FOLLOW, 1.4, 0.0), [[1.4, 0.0]]) == (0.05, 0.0)
    assert relieved(REST, (0.1, 0.2), Goal(), np.zeros((0, 2))) == (0.1, 0.2)  # there is no leader yet


def test_who_is_where_the_leader_was_last_looks_around():
    assert relieved(REST, (1.0, 0.0), Goal(Mode.SEARCH, 0.3, 0.0), [[0.3, 0.0]], search_turn=-0.5) == (0.0, -0.5)


def wishes_before_a_wall(keep):
    """Return what is wished, held up before a short wall, step by step, by a robot that does not move at all."""
    detour = Detour(DetourConfig(keep=keep), SteeringConfig(), FollowInterface())
    goal, trail = Goal(Mode.FOLLOW, 3.0, 0.0), np.array([[1.0, 0.0], [2.0, 0.0]])
    wall = np.column_stack((np.full(9, 0.5), np.linspace(-0.25, 0.25, 9)))
    return [escaped(detour, (0.5, 0.0), goal, trail, wall, FREE) for _ in range(24)][9:]


def test_a_manoeuvre_that_was_begun_goes_on_to_its_second_part_instead_of_beginning_anew():
    anew = wishes_before_a_wall(keep=0.0)
    assert set(anew) == {anew[0]}
    on = wishes_before_a_wall(keep=0.15)
    assert on[0] == anew[0]
    assert on[-1] == (0.0, 0.0)  # the robot has not moved, so the second part still is to stand before the wall


def test_nobody_is_led_back_over_ground_that_was_not_seen():
    ends, sides = np.linspace(0.0, 0.2, 3), np.linspace(-0.1, 0.3, 5)  # a pocket: the only way out is back
    left, right = (np.column_stack((sides, np.full(5, y))) for y in (0.3, -0.3))
    pocket = np.vstack((np.column_stack((np.full(3, 0.33), ends)), left, right))
    goal, trail = Goal(Mode.FOLLOW, 3.0, 0.0), np.array([[1.0, 0.0], [2.0, 0.0]])
    least = {}
    for room in (1.0, 0.0):
        detour = Detour(DetourConfig(), SteeringConfig(), FollowInterface())
        least[room] = min(escaped(detour, (0.5, 0.0), goal, trail, pocket, known(room))[0] for _ in range(24))
    assert least[1.0] < 0.0 <= least[0.0]


def test_a_manoeuvre_may_come_a_little_nearer_to_things_than_the_guard_would_let_the_network():
    gate = np.array([[0.8, 0.295], [0.8, -0.295]])  # table legs: driven through, the robot comes as near as 0.036 m
    goal, trail = Goal(Mode.FOLLOW, 3.0, 0.0), np.array([[1.0, 0.0], [2.0, 0.0]])
    wishes = []
    for touch in (DetourConfig().touch, GUARD.margin):
        detour = Detour(DetourConfig(touch=touch), SteeringConfig(), FollowInterface())
        wishes.append([escaped(detour, (0.5, 0.0), goal, trail, gate, FREE) for _ in range(12)][-1])
    assert wishes[0] == (0.9, 0.0)
    assert wishes[1] != (0.9, 0.0)


def test_a_horizon_within_the_first_part_is_refused():
    with pytest.raises(InputError, match="horizon"):
        DetourConfig(horizon_s=1.0)
