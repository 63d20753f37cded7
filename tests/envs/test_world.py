"""The simulator as a whole: seeds, snapshots, contacts, the tour."""

import pickle

import numpy as np
import pytest
from tagalong.envs.lidar import LidarConfig
from tagalong.envs.world import World, WorldConfig

SCENES = ["corridor", "meeting_room"]
FEW_BEAMS = LidarConfig(beams=61)


def make(seed=0, **options):
    return World(WorldConfig(**{"lidar": FEW_BEAMS, **options}), np.random.default_rng(seed))


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
