"""A wish that would touch something gives way in time, to the side where the leader went."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.agents.learned.guard import GuardConfig
from tagalong.agents.learned.manoeuvres import drive_in_thought, resampled, thinned, turned_away
from tagalong.agents.learned.pilot import Pilot, PilotConfig
from tagalong.agents.learned.situation import Situation
from tagalong.agents.learned.steering import SteeringConfig
from tagalong.agents.learned.swerve import Swerve, SwerveConfig, foreseen
from tagalong.agents.scripted.leader_memory import Goal, Mode
from tagalong.envs.task import FollowInterface
from tagalong.slam import InputError

GUARD, STEERING, ROBOT = GuardConfig(), SteeringConfig(), FollowInterface()
ON = (0.8, 0.0, 0.0, 0.0)
POST = np.array([[1.0, 0.0], [1.0, 0.03], [1.0, -0.03]])


NOBODY = np.zeros((0, 6))


def avoided(wish, goal, things=POST, trail=((0.5, 0.0),), state=ON, people=NOBODY, **fields):
    swerve = Swerve(SwerveConfig(**fields), GUARD, STEERING, ROBOT)
    trail, things = np.asarray(trail, dtype=np.float64), np.asarray(things, dtype=np.float64)
    people = np.asarray(people, dtype=np.float64)
    return swerve.avoid(wish, Situation(state, goal, 0.0, trail, things, people, lambda: 0.0))


def gap_of(wish, state=ON, things=POST):
    plans = np.array([[*wish, np.inf, *wish]])
    return drive_in_thought(state, plans, things, 1.2, 0.1, STEERING, ROBOT).gaps[0]


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_post_in_the_way_is_passed_where_the_leader_passed_it(side):
    goal, trail = Goal(Mode.FOLLOW, 1.8, side * 0.7, 0.8, 0.0), [[0.5, side * 0.3], [1.0, side * 0.6]]
    speed, turn = avoided((0.8, 0.0), goal, trail=trail)
    assert turn * side > 0.2
    assert speed > 0.1
    assert gap_of((speed, turn)) > gap_of((0.8, 0.0))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_where_either_side_would_do_it_turns_to_the_leader_not_away(side):
    goal = Goal(Mode.FOLLOW, 1.5, side * 1.2)
    assert avoided((0.8, 0.0), goal, off_trail=0.0)[1] * side > 0.0


def test_what_touches_nothing_is_driven_as_wished():
    goal = Goal(Mode.FOLLOW, 2.0, 0.0, 0.8, 0.0)
    assert avoided((0.8, 0.1), goal, things=np.zeros((0, 2))) == (0.8, 0.1)
    assert avoided((0.8, 0.1), goal, things=[[0.5, 0.9], [0.5, -0.9]]) == (0.8, 0.1)
    assert avoided((0.8, 0.0), goal) != (0.8, 0.0)


def test_bystanders_who_walk_are_minded_where_they_will_be():
    things = np.array([[1.0, 0.3], [1.0, -0.3], [3.0, 0.0]])
    walker, stander = [1.0, 0.1, 0.0, 1.0, 0.9, 1.0], [3.0, 0.2, 0.1, 0.0, 0.9, 1.0]
    moved = foreseen(things, np.array([walker, stander, [0.0] * 6]), 0.6)
    assert moved == pytest.approx(np.array([[1.0, 0.9], [1.0, 0.3], [3.0, 0.0]]))
    assert things[0, 1] == 0.3
    assert foreseen(things, np.array([[*walker[:5], 0.0]]), 0.6) == pytest.approx(things)
    slow, stroll = [1.0, 0.1, 0.15, 0.0, 0.9, 1.0], [1.0, 0.1, 0.3, 0.0, 0.9, 1.0]
    assert foreseen(things, np.array([slow]), 1.0) == pytest.approx(things)
    wall = np.array([[1.4, 0.1], [1.6, 0.1]])  # the nearer one may be a leg, the other is none
    assert foreseen(wall, np.array([stroll]), 1.0) == pytest.approx(np.array([[1.7, 0.1], [1.6, 0.1]]))


def test_who_leaves_the_way_is_not_swerved_and_who_comes_into_it_is():
    goal = Goal(Mode.FOLLOW, 2.0, 0.0, 0.8, 0.0)
    assert avoided((0.8, 0.0), goal, people=[[1.1, 0.0, 0.0, 1.5, 0.9, 1.0]]) == (0.8, 0.0)
    beside, comes = POST + np.array([0.0, 0.9]), [[1.1, 0.9, 0.0, -1.5, 0.9, 1.0]]
    assert avoided((0.8, 0.0), goal, things=beside) == (0.8, 0.0)
    assert avoided((0.8, 0.0), goal, things=beside, people=comes) != (0.8, 0.0)
    assert avoided((0.8, 0.0), goal, things=beside, people=comes, foresight_s=0.0) == (0.8, 0.0)


def test_who_stands_or_has_lost_the_leader_is_left_to_the_detour():
    rest = (0.0, 0.0, 0.0, 0.0)
    assert avoided((0.05, 0.5), Goal(Mode.FOLLOW, 2.0, 0.0), things=[[0.4, 0.0]], state=rest) == (0.05, 0.5)
    assert avoided((0.8, 0.0), Goal(Mode.APPROACH, 2.0, 0.0)) == (0.8, 0.0)


def test_a_manoeuvre_in_thought_goes_where_it_leads_and_tells_how_near_it_came():
    plans = np.array([[0.5, 0.0, np.inf, 0.0, 0.0], [0.5, 0.0, 0.0, 0.5, 0.0]])
    driven = drive_in_thought((0.5, 0.0, 0.0, 0.0), plans, np.array([[1.5, 0.0]]), 2.0, 0.1, STEERING, ROBOT)
    assert driven.poses == pytest.approx(np.array([[1.0, 0.0, 0.0]] * 2), abs=1e-9)
    assert driven.gaps == pytest.approx(1.5 - 1.0 - ROBOT.half_length)
    turned = drive_in_thought((0.0, 0.0, 1.0, 0.0), np.array([[0, 1.0, 0.5, 0, -1.0]]), POST, 0.5, 0.1, STEERING, ROBOT)
    assert turned.poses[0] == pytest.approx((0.0, 0.0, 0.5))


def test_who_faces_away_is_told_by_the_lesser_angle():
    poses = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 3.0], [2.0, 0.0, -3.0]])
    assert turned_away(poses, np.array([1.0, 0.0])) == pytest.approx([0.0, 2 * np.pi - 3.0 - np.pi / 2, np.pi - 3.0])
    assert turned_away(poses, poses[:, :2] + (0.0, 1.0))[0] == pytest.approx(np.pi / 2)


def test_a_path_is_resampled_from_here_to_so_much_before_its_end():
    assert resampled(np.array([[1.0, 0.0]]), 0.45)[:, 0] == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5])
    assert resampled(np.array([[9.0, 0.0]]), 0.0)[-1, 0] == pytest.approx(2.4)
    assert not len(resampled(np.array([[1.0, 0.0]]), 1.3))


def test_points_are_thinned_to_one_a_cell_and_far_ones_left_out():
    points = np.array([[1.0, 0.0], [1.001, 0.001], [1.2, 0.0], [3.0, 0.0]])
    assert sorted(thinned(points, 2.0)[:, 0]) == pytest.approx([1.0, 1.2])


def turned(swerve, aside=0.0):
    """Return the least turn rate while a network drives straight at a post that the leader passed on the right.

    `aside`: it is no post but somebody who walks out of the way so fast [m/s].
    """
    bearings = np.deg2rad(np.linspace(-135.0, 135.0, 271))
    pilot = Pilot(replace(PilotConfig(), keep_up=None, detour=None, swerve=swerve), FollowInterface(bearings=bearings))
    least = 0.0
    for k in range(12):
        scan = np.ones(271, dtype=np.float32)
        scan[np.abs(bearings) < 0.06] = (1.5 - 0.06 * k) / 30.0
        pilot.inputs(
            {
                "scan": scan,
                "leader": np.array([1.6, -0.8, 0.6, 0.0, 0.9, 1.0], dtype=np.float32),
                "people": np.array([[1.7 - 0.06 * k, 0.0, 0.0, aside, 0.9, 1.0]], dtype=np.float32),
                "velocity": np.array((pilot.commanded[0], pilot.commanded[2]), dtype=np.float32),
            }
        )
        pilot.drive(pilot.config.steering.output(0.9, 0.0))
        least = min(least, pilot.commanded[2])
    return least


def test_the_pilot_swerves_before_the_guard_has_to_brake():
    assert turned(SwerveConfig()) < -0.05
    assert turned(None) == pytest.approx(0.0, abs=1e-9)
    assert turned(SwerveConfig(), aside=1.5) == pytest.approx(0.0, abs=1e-9)


def test_looking_no_time_ahead_is_refused():
    with pytest.raises(InputError, match="ahead_s"):
        SwerveConfig(ahead_s=0.0)
