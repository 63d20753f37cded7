"""The robot's motion and its contacts."""

import numpy as np
import pytest
from tagalong.envs.robot.robot import Robot, RobotConfig
from tagalong.envs.sensors.lidar import LidarConfig
from tagalong.envs.world.world import World, WorldConfig
from tagalong.slam import InputError
from tagalong.slam.geometry import between

FEW_BEAMS = LidarConfig(beams=11)


def alone(seed=0, **options):
    return World(WorldConfig(people=0, lidar=FEW_BEAMS, **options), np.random.default_rng(seed))


def test_a_steady_command_is_reached_and_kept():
    world = alone(scene="corridor", route="forward")
    for _ in range(30):
        world.step([0.8, 0.0])
    assert world.truth.robot_velocity == pytest.approx([0.8, 0.0, 0.0], abs=0.01)


def test_a_turn_on_the_spot_stays_on_the_spot():
    world = alone()
    start = world.truth.robot_pose
    for _ in range(40):
        world.step([0.0, 1.0])
    moved = between(start, world.truth.robot_pose)
    assert np.hypot(*moved[:2]) < 1e-3
    assert world.truth.robot_velocity[2] == pytest.approx(1.0, abs=0.01)


def test_speeds_and_accelerations_are_limited():
    world = alone()
    speeds = [0.0]
    for _ in range(20):
        world.step([9.0, 0.0])
        speeds.append(world.truth.robot_velocity[0])
    assert max(speeds) <= 1.3 + 1e-3
    assert np.diff(speeds).max() <= 2.0 * 0.1 + 0.02


@pytest.mark.parametrize("seed", range(4))
def test_a_robot_stops_at_walls_and_says_so(seed):
    world = alone(seed, scene="meeting_room")
    touched = False
    for _ in range(150):
        world.step([1.3, 0.25])
        touched |= world.truth.contact_static
        assert not world.truth.contact_person
        assert world.scene.clearance(world.truth.robot_pose[:2]) > 0.2
    assert touched
    assert abs(world.truth.robot_pose[0]) < 7.0


def test_the_holonomic_drive_goes_sideways_and_the_differential_one_refuses():
    world = alone(robot=RobotConfig(drive="holonomic"))
    start = world.truth.robot_pose
    for _ in range(10):
        world.step([0.0, 0.3, 0.0])
    moved = between(start, world.truth.robot_pose)
    assert moved[1] > 0.2
    assert abs(moved[0]) < 0.01
    with pytest.raises(InputError, match="differential"):
        alone().step([0.0, 0.3, 0.0])


def test_commands_that_are_not_finite_are_errors():
    with pytest.raises(InputError, match="finite"):
        alone().step([np.nan, 0.0])
    with pytest.raises(InputError, match="mass"):
        RobotConfig(mass=0.0)


def test_the_setpoint_is_cut_to_the_largest_speed_in_its_direction():
    robot = Robot(RobotConfig(drive="holonomic"))
    assert robot.command([3.0, 4.0, 9.0]) == pytest.approx([0.78, 1.04, 4.0])
