"""The simulator as a whole: seeds, snapshots, contacts, the tour."""

import os
import pickle
import subprocess
import sys

import numpy as np
import pytest
from tagalong.envs.scenes.polyline import resample
from tagalong.envs.sensors.lidar import LidarConfig
from tagalong.envs.world.drawing import draw_episode
from tagalong.envs.world.world import World, WorldConfig
from tagalong.slam import InputError
from tagalong.slam.geometry import wrap_angle

SCENES = ["corridor", "meeting_room"]
FEW_BEAMS = LidarConfig(beams=61)


def make(seed=0, **options):
    return World(WorldConfig(**{"lidar": FEW_BEAMS, **options}), np.random.default_rng(seed))


def test_importing_mujoco_starts_no_process_that_a_kill_would_leave_behind():
    code = (
        "import sys; begun = []; sys.addaudithook(lambda event, _: begun.append(event) if event == 'subprocess.Popen'"
        " else None); from tagalong.envs.physics import mj; import glfw, os; print(begun, glfw.get_version()[0] >= 3,"
        " 'PYGLFW_LIBRARY' in os.environ)"
    )
    plain = {name: value for name, value in os.environ.items() if name != "MUJOCO_GL"}  # OpenGL's loader asks ldconfig
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=plain)
    assert answer.stdout.strip() == "[] True False"


def test_a_building_without_room_for_so_many_gives_way_to_another_and_always_the_same():
    config = WorldConfig(scene="narrow_doors", people=14)
    with pytest.raises(InputError, match="no room for 14 people"):
        draw_episode(config, np.random.default_rng(4), 1)
    routes = [draw_episode(config, np.random.default_rng(4)).plan.scene.route for _ in range(2)]
    assert np.array_equal(*routes)
    with pytest.raises(InputError, match="people"):
        make(scene="corridor", people=100)


def record(world, steps, command=(0.4, 0.1)):
    rows = []
    for _ in range(steps):
        world.step(command)
        truth = world.truth
        people = truth.people
        rows.append((truth.robot_pose, world.odometry, world.scan().ranges, people.positions, people.feet, people.legs))
    return b"".join(np.ascontiguousarray(array).tobytes() for row in rows for array in row)


@pytest.mark.parametrize("scene", SCENES)
def test_the_same_seed_gives_the_same_bytes_and_another_seed_another_start(scene):
    options = {"scene": scene, "people": 3, "standing": 1}
    assert record(make(3, **options), 30) == record(make(3, **options), 30)
    assert not np.allclose(make(3, **options).truth.robot_pose, make(4, **options).truth.robot_pose)


def test_the_building_and_the_start_do_not_depend_on_who_walks_in_it():
    alone, crowded = make(5, people=0), make(5, people=4, standing=1)
    assert alone.scene.solids == crowded.scene.solids
    assert np.array_equal(alone.truth.robot_pose, crowded.truth.robot_pose)
    assert alone.truth.leader_index == -1
    assert crowded.truth.leader_index == 0


def test_a_restored_world_continues_with_the_same_bytes_even_after_pickling():
    world = make(1, people=4)
    record(world, 25)
    state = world.save_state()
    copied = pickle.loads(pickle.dumps(world))
    onward = record(world, 25)
    world.restore_state(state)
    assert record(world, 25) == onward
    assert record(copied, 25) == onward


def follow(world, distance=1.3):
    """The command of a follower who knows everything."""
    truth = world.truth
    leader, velocity = truth.people.positions[truth.leader_index], truth.people.velocities[truth.leader_index]
    offset = leader - truth.robot_pose[:2]
    away = np.hypot(*offset)
    bearing = wrap_angle(np.arctan2(offset[1], offset[0]) - truth.robot_pose[2])
    speed = 1.5 * (away - distance) + velocity @ offset / away
    return np.clip(speed, 0.0, 1.3) * max(0.0, np.cos(bearing)), np.clip(2.0 * bearing, -2.0, 2.0)


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize(("seed", "people", "standing"), [(0, 2, 0), (1, 4, 1), (2, 5, 0)])
def test_a_perfect_follower_completes_the_tour_and_no_two_bodies_overlap(scene, seed, people, standing):
    world = make(seed, scene=scene, people=people, standing=standing)
    errors = []
    for _ in range(1200):
        world.step(follow(world))
        truth = world.truth
        bodies = truth.people
        apart = np.hypot(*(bodies.positions[:, None] - bodies.positions[None]).transpose(2, 0, 1))
        np.fill_diagonal(apart, 9.0)
        assert np.all(apart > bodies.radii[:, None] + bodies.radii[None])
        assert np.all(world.scene.clearance(bodies.positions, of_people=True) > bodies.radii)
        assert np.all(world.scene.clearance(bodies.legs, of_people=True) > bodies.leg_radii[:, None])
        legs, thick = bodies.legs.reshape(-1, 2), np.repeat(bodies.leg_radii, 2)
        between_legs = np.hypot(*(legs[:, None] - legs[None]).transpose(2, 0, 1)) - thick[:, None] - thick[None]
        assert between_legs[np.triu_indices(len(legs), 1)].min() > 0.0
        assert not truth.contact_person
        assert not truth.contact_static
        if truth.leader_walking and truth.time_s > 3.0:
            errors.append(np.hypot(*(bodies.positions[0] - truth.robot_pose[:2])) - 1.3)
        if truth.tour_done:
            break
    assert world.truth.tour_done
    assert np.sqrt(np.mean(np.square(errors))) < 0.1


def test_a_leader_who_waits_stops_for_a_robot_that_lags_and_a_steady_one_goes_on():
    ends = {}
    for style in ("waits", "steady"):
        world = make(0, people=1, leader_style=style)
        for _ in range(300):
            world.step([0.0, 0.0])
        truth = world.truth
        ends[style] = np.hypot(*(truth.people.positions[0] - truth.robot_pose[:2]))
    assert ends["waits"] < 4.0
    assert ends["steady"] > 10.0


def test_the_second_person_walks_ahead_of_the_robot_with_the_leader():
    world = make(7, people=2)
    for _ in range(250):
        world.step(follow(world))
    truth = world.truth
    leader, companion = between_points(truth.robot_pose, truth.people.positions)
    assert 1.0 < leader[0] < 1.6
    assert leader[0] < companion[0] < 4.0


def between_points(pose, points):
    offset = points - pose[:2]
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    return np.stack((cos * offset[:, 0] + sin * offset[:, 1], cos * offset[:, 1] - sin * offset[:, 0]), axis=-1)


def test_somebody_who_stands_walks_first_and_then_stands_for_twenty_seconds_and_more():
    world = make(1, scene="meeting_room", people=2, standing=1)
    speeds = []
    for _ in range(600):
        world.step(follow(world))
        speeds.append(float(np.hypot(*world.truth.people.velocities[2])))
    still = np.array(speeds) < 0.1
    runs = np.diff(np.flatnonzero(np.concatenate(([True], ~still, [True]))))
    assert max(speeds) > 0.4
    assert runs.max() > 200


def test_people_step_aside_for_a_robot_that_creeps_up_on_them():
    world = make(3, people=1, leader_style="waits")
    for _ in range(100):
        truth = world.truth
        leader = between_points(truth.robot_pose, truth.people.positions)[0]
        world.step([0.4, np.clip(2.0 * np.arctan2(leader[1], leader[0]), -1.0, 1.0)])
        assert not world.truth.contact_person


def test_without_a_leader_everybody_is_on_their_own():
    world = make(0, people=3, leader=False)
    record(world, 50)
    assert world.truth.leader_index == -1
    assert not world.truth.leader_walking
    assert len(world.truth.people) == 3


def test_a_robot_alone_has_done_the_tour_at_its_end():
    world = make(0, people=0, scene="meeting_room")
    route = resample(world.scene.route, 0.1)
    for _ in range(1500):
        pose = world.truth.robot_pose
        target = route[min(int(world.truth.robot_progress / 0.1) + 6, len(route) - 1)]
        bearing = wrap_angle(np.arctan2(*(target - pose[:2])[::-1]) - pose[2])
        world.step([0.9 * max(0.0, np.cos(bearing)), 2.0 * bearing])
        assert not world.truth.contact_static
        if world.truth.tour_done:
            break
    assert world.truth.tour_done


def test_impossible_worlds_are_errors():
    for options, word in (
        ({"scene": "plasa"}, "corridor, doorway, floor_plan, intersection, lab, landmarks"),
        ({"people": -1}, "people"),
        ({"leader_style": "slow"}, "hurried, steady, waits"),
        ({"odometry": "superb"}, "slipping"),
        ({"control_hz": 7.0}, "multiple"),
        ({"physics_dt": 0.004}, "multiple"),
    ):
        with pytest.raises(InputError, match=word):
            WorldConfig(**options)


def test_a_world_reserves_no_more_for_contacts_than_it_needs():
    world = World(WorldConfig(scene="plain_corridor"), np.random.default_rng(0))
    world.step([0.3, 0.0])
    assert world.data.narena <= 1 << 20
    assert world.data.maxuse_arena < 0.1 * world.data.narena
