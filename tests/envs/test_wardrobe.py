"""What people wear before a camera."""

import numpy as np
import pytest
from tagalong.envs.appearance.pattern import SurfacePattern
from tagalong.envs.appearance.wardrobe import ARMS, WARDROBES, draw_outfit, wardrobe
from tagalong.envs.sensors.camera.config import RgbdConfig
from tagalong.envs.sensors.lidar import LidarConfig
from tagalong.envs.world.world import World, WorldConfig
from tagalong.slam import InputError


def world(clothing=None, seed=0):
    camera = None if clothing is None else RgbdConfig(width=32, height=24, wardrobe=clothing)
    config = WorldConfig(scene="corridor", people=3, lidar=LidarConfig(beams=181), camera=camera)
    return World(config, np.random.default_rng(seed))


def test_the_wardrobes_share_no_pose_pattern_extra_or_hue():
    first, second = WARDROBES["everyday"], WARDROBES["training"]
    assert not set(first.arms) & set(second.arms)
    assert set(first.arms) | set(second.arms) == set(ARMS)
    assert set(first.patterns) & set(second.patterns) == {SurfacePattern.PLAIN}
    assert set(first.extras) & set(second.extras) == {"none"}
    assert set(first.garments) & set(second.garments) == {"trousers"}
    for low, high in first.hues:
        assert all(high <= other[0] or other[1] <= low for other in second.hues)


def test_colours_are_of_the_hues_of_their_wardrobe():
    rng = np.random.default_rng(0)
    for name in WARDROBES:
        for _ in range(50):
            red, green, blue = draw_outfit(rng, wardrobe(name)).shirt
            most, least = max(red, green, blue), min(red, green, blue)
            assert 0.0 <= least <= most <= 1.0
            order = {red: ((green - blue) / (most - least)) % 6.0, green: 2.0 + (blue - red) / (most - least)}
            hue = order.get(most, 4.0 + (red - green) / (most - least)) / 6.0
            assert any(low - 1e-6 <= hue <= high + 1e-6 for low, high in wardrobe(name).hues)


def test_bodies_have_arms_before_a_camera_alone_and_the_laser_sees_the_same_people():
    bare, everyday, training = world(), world("everyday"), world("training")
    assert bare.model.ngeom < min(everyday.model.ngeom, training.model.ngeom)
    names = {everyday.model.geom(geom).name for geom in range(everyday.model.ngeom)}
    assert {f"person {k} skin left hand" for k in range(3)} <= names
    for _ in range(10):
        scans = []
        for each in (bare, everyday, training):
            each.step([0.3, 0.1])
            scans.append(each.scan().ranges.tobytes())
        assert scans[0] == scans[1] == scans[2]


def test_hands_are_where_the_pose_says():
    everyday = world("everyday")
    model = everyday.model
    for person in range(3):
        hand = model.geom(f"person {person} skin left hand").pos
        below = hand[2] - 0.53
        assert any(abs(below - pose[side][5]) < 1e-6 for pose in ARMS.values() for side in (0, 1))
        assert model.geom(f"person {person} skin left hand").contype == 0


def test_an_unknown_wardrobe_is_an_error():
    with pytest.raises(InputError, match="everyday, training"):
        RgbdConfig(wardrobe="carnival")
