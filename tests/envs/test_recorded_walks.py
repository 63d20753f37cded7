"""Bystanders who walk as recorded."""

import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.envs.sensors.lidar import LidarConfig
from tagalong.envs.world.world import World, WorldConfig
from tagalong.slam import InputError

DATA = os.environ.get("TAGALONG_DATA")


@pytest.fixture
def recording(tmp_path):
    """Six people who walk 8 m straight on at 0.5, 0.6, ... m/s."""
    lines = [
        f"{10 * k} {p} {0.4 * k * (0.5 + 0.1 * p)} {p}" for p in range(6) for k in range(int(8 / (0.2 + 0.04 * p)))
    ]
    (tmp_path / "walks.txt").write_text("\n".join(lines) + "\n")
    return str(tmp_path / "walks.txt")


def make(seed=0, **options):
    return World(WorldConfig(lidar=LidarConfig(beams=31), **options), np.random.default_rng(seed))


@pytest.mark.parametrize("scene", ["office", "corridor", "meeting_room"])
def test_bystanders_walk_where_there_is_room_and_as_fast_as_recorded(recording, scene):
    world = make(scene=scene, walking_paths=recording, people=4)
    for walk in world.scene.walks:
        assert world.scene.clearance(walk.points, of_people=True).min() > 0.3
        assert np.allclose(walk.speed, walk.speed[0], atol=0.02)
        assert 0.49 < walk.speed[0] < 1.01
    fastest = np.zeros(4)
    for _ in range(200):
        world.step([0.0, 0.0])
        people = world.truth.people
        apart = np.hypot(*(people.positions[:, None] - people.positions[None]).transpose(2, 0, 1))
        np.fill_diagonal(apart, 9.0)
        assert np.all(apart > people.radii[:, None] + people.radii[None])
        fastest = np.maximum(fastest, np.hypot(*people.velocities.T))
    assert np.all(fastest[1:] < 1.25)


def test_what_does_not_fit_is_said(recording, tmp_path):
    with pytest.raises(InputError, match="have a script"):
        make(scene="lab", walking_paths=recording)
    with pytest.raises(InputError, match="cannot be read"):
        make(walking_paths=str(tmp_path / "none.txt"))
    (tmp_path / "short.txt").write_text("\n".join(f"{10 * k} 1 {0.01 * k} 0" for k in range(9)))
    with pytest.raises(InputError, match="no piece of"):
        make(walking_paths=str(tmp_path / "short.txt"))


@pytest.mark.skipif(DATA is None, reason="needs TAGALONG_DATA with recorded walks")
@pytest.mark.parametrize("file", ["zara01/obsmat.txt.gz", "crowds_zara02.txt.gz"])
def test_recordings_of_eth_and_ucy_drive_bystanders(file):
    path = str(Path(DATA or "") / "pedestrians" / file)
    world = make(scene="office", walking_paths=path, people=5)
    assert len(world.scene.walks) >= 5
    speeds = np.concatenate([walk.speed for walk in world.scene.walks])
    assert 0.8 < np.median(speeds) < 1.6
    start = world.truth.people.positions
    for _ in range(50):
        world.step([0.0, 0.0])
    assert np.hypot(*(world.truth.people.positions - start).T).max() > 1.0


def test_a_walk_of_a_hundred_kilometres_is_refused(tmp_path):
    file = tmp_path / "walks.txt"
    file.write_text("".join(f"{10 * k} 1 {90.0 * k} 0.0\n" for k in range(1200)))
    with pytest.raises(InputError, match=r"somebody walks 1.08e\+05 m"):
        World(WorldConfig(scene="corridor", walking_paths=file), np.random.default_rng(0))
