"""The lab: its scripted people, its door, and the scripted operator."""

import gymnasium as gym
import numpy as np
import pytest
import tagalong  # noqa: F401 (registers the ids)
from tagalong.envs.recording.operator import Operator
from tagalong.envs.sensors.camera.config import RgbdConfig
from tagalong.envs.sensors.lidar import LidarConfig
from tagalong.envs.world.world import World, WorldConfig
from tagalong.slam import InputError

LASER = LidarConfig(beams=61, range_max=10.0, height=0.32)


def make(seed=0, **options):
    defaults = {"scene": "lab", "route": "operator", "people": 0, "leader": False, "lidar": LASER}
    return World(WorldConfig(**{**defaults, **options}), np.random.default_rng(seed))


@pytest.fixture(scope="module", params=[0, 3])
def drive(request):
    """The whole drive of the operator: (world, times, people (n, 4, 2), doors, touched, robot)."""
    world = make(request.param)
    operator = Operator(world.scene)
    rows = []
    while not operator.done(world.truth) and world.time_s < 400.0:
        world.step(operator.command(world.truth))
        truth = world.truth
        touched = truth.contact_person or truth.contact_static
        rows.append((truth.time_s, truth.people.positions, world.doors_open[0], touched, truth.robot_pose))
    times, people, doors, touched, robot = (np.array(column) for column in zip(*rows, strict=True))
    return world, times, people, doors, touched, robot


def test_the_operator_drives_round_the_room_and_out_in_about_five_minutes_without_a_contact(drive):
    _, times, _, _, touched, robot = drive
    assert 250.0 < times[-1] < 330.0
    assert not touched.any()
    assert robot[:, 1].max() > 4.5
    assert robot[-1, 1] < -0.5


def test_two_people_stand_still_all_the_time(drive):
    _, _, people, _, _, _ = drive
    assert np.ptp(people[:, :2], axis=0).max() < 0.05


def test_the_third_opens_the_door_and_walks_out_before_the_robot(drive):
    world, times, people, doors, _, robot = drive
    opens, leaves = np.argmax(doors > 0.0), np.argmax(robot[:, 1] < 0.0)
    assert doors[0] == 0.0
    assert doors[-1] == 1.0
    assert 215.0 < times[opens] < times[leaves]
    assert people[leaves, 2, 1] < -0.3
    assert people[-1, 2] == pytest.approx(world.scene.marks["f"].mean(axis=0), abs=0.3)


def test_the_fourth_walks_in_the_passage_and_then_stops_there(drive):
    world, times, people, _, _, _ = drive
    early = times < 150.0
    assert np.ptp(people[early, 3, 0]) > 4.0
    assert people[-1, 3] == pytest.approx(world.scene.marks["g"].mean(axis=0), abs=0.3)
    assert np.ptp(people[times > times[-1] - 20.0, 3], axis=0).max() < 0.1


def test_a_closed_door_stops_laser_and_robot_and_an_open_one_does_not():
    world = make()
    door = world.scene.doors[0]
    x, y = door.middle
    world.data.qpos[:3] = (x, y + 1.5, -np.pi / 2.0)
    world.step([0.0, 0.0])
    ahead = len(world.scan()) // 2
    assert world.scan().ranges[ahead] == pytest.approx(1.4, abs=0.1)
    for _ in range(60):
        world.step([0.4, 0.0])
    assert world.truth.contact_static
    state = world.save_state()
    state.changing.doors.angle[:] = 1.0
    world.restore_state(state)
    world.data.qpos[:3] = (x, y + 1.5, -np.pi / 2.0)
    world.step([0.0, 0.0])
    assert world.scan().ranges[ahead] > 3.0


def test_the_marks_are_where_things_happen():
    scene = make(2).scene
    assert set(scene.marks) == {"a", "b", "c", "d1", "d2", "e", "f", "g"}
    for name, kinds in (("a", {"carton"}), ("b", {"carton"})):
        low, high = scene.marks[name].min(axis=0), scene.marks[name].max(axis=0)
        boxes = [s for s in scene.solids if s.kind in kinds and (low < (s.x, s.y)).all() and ((s.x, s.y) < high).all()]
        assert len(boxes) == (2 if name == "a" else 0)


def test_an_operator_needs_a_plan_for_the_tour():
    with pytest.raises(InputError, match="operator"):
        Operator(make(route="tour").scene)
    with pytest.raises(InputError, match="none"):
        Operator(World(WorldConfig(people=0, lidar=LASER), np.random.default_rng(0)).scene)


def test_a_robot_can_follow_somebody_out_of_the_lab():
    world = make(1, route="tour", people=1, leader=True)
    for _ in range(1200):
        truth = world.truth
        offset = truth.people.positions[0] - truth.robot_pose[:2]
        bearing = (np.arctan2(offset[1], offset[0]) - truth.robot_pose[2] + np.pi) % (2.0 * np.pi) - np.pi
        speed = 1.5 * (np.hypot(*offset) - 1.3) + truth.people.velocities[0] @ offset / np.hypot(*offset)
        world.step([np.clip(speed, 0.0, 1.3) * max(0.0, np.cos(bearing)), np.clip(2.0 * bearing, -2.0, 2.0)])
        assert not world.truth.contact_static
        if world.truth.tour_done:
            break
    assert world.truth.tour_done
    assert world.doors_open[0] == 1.0


def test_the_camera_is_an_option_of_the_environment():
    env = gym.make("tagalong/Lab-v0", camera=RgbdConfig(width=32, height=24), beams=91, slam=None, people="truth")
    observation, _ = env.reset(seed=0)
    again = env.step(np.zeros(2))[0]
    assert env.observation_space.contains(observation)
    assert env.observation_space.contains(again)
    assert observation["rgb"].shape == (24, 32, 3)
    assert observation["rgb"].std() > 5.0
    assert (observation["depth"] != again["depth"]).any()
    assert not np.shares_memory(observation["rgb"], again["rgb"])
    with pytest.raises(InputError, match="unknown camera 'sonar'; cameras: None, kinect-v2"):
        gym.make("tagalong/Lab-v0", camera="sonar")


@pytest.mark.parametrize("seed", [100018, 100045, 100114, 100116, 100159, 100201])
def test_nobody_begins_inside_the_robot_or_inside_a_scripted_person(seed):
    """The tour comes by its own start again."""
    config = WorldConfig(scene="lab", people=None, split="test" if seed % 2 else "train", lidar=LidarConfig(beams=5))
    world = World(config, np.random.default_rng(seed))
    people = world.truth.people
    places = np.vstack((people.positions, world.truth.robot_pose[:2]))
    radii = np.append(people.radii, world.config.robot.radius)
    gap = np.hypot(*(places[:, None] - places).transpose(2, 0, 1)) - radii[:, None] - radii
    assert gap[np.triu_indices(len(gap), 1)].min() > 0.0
