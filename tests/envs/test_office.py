"""Offices: what is drawn, where people walk, and that training and testing never meet."""

from itertools import pairwise

import numpy as np
import pytest
from tagalong.envs.people.behaviours.mind import Around, MindKind, minds_of
from tagalong.envs.people.behaviours.wanderer import wanderer, wanderer_wish
from tagalong.envs.people.movement.bodies import Start, standing_bodies
from tagalong.envs.people.movement.ground import Ground
from tagalong.envs.people.movement.terrain import Terrain
from tagalong.envs.scenes.catalogue import make_scene
from tagalong.envs.scenes.office_layout import TESTING, TRAINING
from tagalong.envs.scenes.request import SceneRequest
from tagalong.envs.scenes.ways import folds
from tagalong.envs.sensors.lidar import LidarConfig
from tagalong.envs.world.world import World, WorldConfig
from tagalong.slam import InputError
from tagalong.slam.geometry import wrap_angle

FEW_BEAMS = LidarConfig(beams=31)


def office(seed, **asked):
    return make_scene("office", np.random.default_rng(seed), request=SceneRequest(**asked))


def world(seed, **options):
    return World(WorldConfig(scene="office", lidar=FEW_BEAMS, **options), np.random.default_rng(seed))


def test_training_and_testing_never_meet():
    assert not set(TRAINING) & set(TESTING)
    train = {office(seed).solids for seed in range(12)}
    test = {office(seed, split="test").solids for seed in range(12)}
    assert len(train) == len(test) == 12
    assert not train & test
    with pytest.raises(InputError, match="unknown split 'dev'; splits: test, train"):
        SceneRequest(split="dev")


@pytest.mark.parametrize("split", ["train", "test"])
def test_tours_are_long_enough_and_never_turn_on_the_spot(split):
    for seed in range(12):
        scene = office(seed, split=split)
        assert 14.0 <= scene.tour_length < 65.0
        assert not folds(scene.routes["tour"])
        assert np.array_equal(scene.routes["back"], scene.routes["tour"][::-1])


@pytest.mark.parametrize("split", ["train", "test"])
def test_bystanders_walk_in_free_space(split):
    for seed in range(12):
        scene = office(seed, split=split)
        assert len(scene.walks) >= 5
        for walk in scene.walks:
            assert scene.clearance(walk.points, of_people=True).min() > 0.33


def test_furniture_does_not_overlap_other_furniture_or_walls():
    for seed in range(6):
        solids = [s for s in office(seed).solids if s.kind in ("wall", "cabinet", "sofa", "table") and not s.is_round]
        low = np.array([(s.x - s.half_length, s.y - s.half_width) for s in solids]) + 1e-6
        high = np.array([(s.x + s.half_length, s.y + s.half_width) for s in solids]) - 1e-6
        overlap = (low[:, None] < high[None]).all(axis=2) & (low[None] < high[:, None]).all(axis=2)
        np.fill_diagonal(overlap, False)
        assert not overlap.any()


def test_the_number_of_bystanders_is_drawn_between_0_and_12():
    counts = [len(world(seed, people=None).truth.people) - 1 for seed in range(25)]
    assert min(counts) <= 2
    assert max(counts) >= 10
    assert all(0 <= count <= 12 for count in counts)


def test_bystanders_are_of_several_temperaments():
    people = world(0, people=13)._plan.casting.people
    wanderers = [person for person in people if person.behaviour.kind == MindKind.WANDERER]
    assert len(wanderers) >= 11
    assert np.ptp([person.behaviour.numbers[0] for person in wanderers]) > 0.4
    assert {person.behaviour.numbers[4] for person in wanderers} == {0.0, 1.0}
    assert len({person.path for person in wanderers}) > 5


def follow(simulator):
    """The command of a follower who knows where the leader is, and stops for whoever is in its way."""
    truth = simulator.truth
    offset = truth.people.positions - truth.robot_pose[:2]
    away = np.hypot(*offset.T)
    bearing = wrap_angle(np.arctan2(offset[:, 1], offset[:, 0]) - truth.robot_pose[2])
    free = 1.0 if np.min(np.where(np.abs(bearing[1:]) < 1.0, away[1:], 9.0), initial=9.0) > 1.0 else 0.0
    speed = 1.5 * (away[0] - 1.3) * max(0.0, np.cos(bearing[0]))
    return np.clip(speed, 0.0, 1.3) * free, np.clip(2.0 * bearing[0], -2.0, 2.0)


@pytest.mark.parametrize(("seed", "split"), [(0, "train"), (1, "train"), (2, "test"), (3, "test")])
def test_in_a_crowd_no_two_bodies_overlap_and_everybody_keeps_walking(seed, split):
    simulator = world(seed, people=12, standing=1, split=split)
    places = []
    for _ in range(350):
        simulator.step(follow(simulator))
        people = simulator.truth.people
        apart = np.hypot(*(people.positions[:, None] - people.positions[None]).transpose(2, 0, 1))
        np.fill_diagonal(apart, 9.0)
        assert np.all(apart > people.radii[:, None] + people.radii[None])
        assert np.all(simulator.scene.clearance(people.positions, of_people=True) > people.radii)
        places.append(people.positions)
    way = np.sum([np.hypot(*(b - a).T) for a, b in pairwise(places)], axis=0)
    assert np.median(way) > 8.0


def test_who_is_held_up_turns_round():
    mind = minds_of([wanderer(pace=1.0, side=0.3, patience=1.0, rest=5.0, gives_way=False)]).numbers[0]
    around = alone_in(Terrain(office(5)))
    around.wish[0] = 1.0
    senses = []
    for _ in range(12):
        around.sense[0] = wanderer_wish(0, mind, around, 0.1)[2]
        senses.append(float(around.sense[0]))
    assert senses == [1.0] * 10 + [-1.0] * 2


def alone_in(terrain):
    """What somebody sees who is alone in a building, 2 m along the first way beside the route."""
    b = standing_bodies([Start(0.0, 0.0, 0.0, arc=2.0)], np.array([0.1]))
    return Around(
        b.position, b.velocity, b.direction, b.arc, b.sense, b.lateral, b.wish, b.face, b.goal, np.array([1]),
        np.array([int(Ground.ELSEWHERE)]), np.array([True]), 0, np.zeros(8), 0.0, terrain.ways,
    )  # fmt: skip


def test_without_a_leader_the_same_people_walk_in_the_same_places():
    led, alone = world(3, people=6), world(3, people=5, leader=False)
    assert np.array_equal(led.truth.people.positions[1:], alone.truth.people.positions)
