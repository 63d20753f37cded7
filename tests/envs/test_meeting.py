"""Who comes towards whom, with known answers."""

import numpy as np
import pytest
from tagalong.envs.people.movement.meeting import first_coming, group_comes

FAR_ROBOT = np.array([-50.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.3, 0.25])
AHEAD = np.array([[1.0, 0.0]] * 3)
HERE = np.array([7.0, -4.0])


def people(*rows):
    """Positions (3, 2) and velocities (3, 2); person 0 stands at `HERE`, from where `rows` count, and walks along x."""
    table = np.array([(0.0, 0.0, 1.0, 0.0), *rows], dtype=np.float64)
    return table[:, :2] + HERE, table[:, 2:].copy()


@pytest.mark.parametrize(
    ("other", "comes"),
    [
        ((3.0, 0.5, -1.0, 0.0), True),
        ((5.5, 0.0, -1.0, 0.0), False),  # too far
        ((-0.6, 0.0, -1.0, 0.0), False),  # past
        ((3.0, 1.2, -1.0, 0.0), False),  # aside
        ((3.0, 0.0, -0.1, 0.0), False),  # hardly moves
        ((3.0, 0.0, 1.0, 0.0), False),  # walks ahead
    ],
)
def test_somebody_comes_who_walks_against_the_way_near_and_before(other, comes):
    positions, velocities = people(other, (40.0, 0.0, 0.0, 0.0))
    candidates = np.array([False, True, True])
    assert first_coming(0, candidates, positions, velocities, AHEAD) == (1 if comes else -1)
    assert first_coming(0, np.array([False, False, True]), positions, velocities, AHEAD) == -1


def test_the_first_of_several_counts():
    positions, velocities = people((4.0, 0.0, -1.0, 0.0), (2.0, 0.0, -1.0, 0.0))
    assert first_coming(0, np.array([False, True, True]), positions, velocities, AHEAD) == 1


@pytest.mark.parametrize(
    ("other", "comes"),
    [
        ((1.5, 0.0, -1.0, 0.0), True),
        ((2.1, 0.0, -1.0, 0.0), False),  # too far
        ((-1.0, 0.0, 1.0, 0.0), False),  # behind
        ((1.5, 0.0, 0.5, 0.0), False),  # goes away
    ],
)
def test_the_group_comes_if_one_of_it_or_the_robot_walks_towards_somebody(other, comes):
    positions, velocities = people(other, (40.0, 0.0, 0.0, 0.0))
    order = [1, 0, 2]  # the other leads, the person is no part of the group
    arguments = positions[order], velocities[order], AHEAD
    assert group_comes(1, 1, FAR_ROBOT, *arguments) is comes
    assert not group_comes(1, 0, FAR_ROBOT, *arguments)
    robot = FAR_ROBOT.copy()
    robot[[0, 1, 4, 5]] = other
    robot[:2] += HERE
    assert group_comes(1, 0, robot, *arguments) is comes
