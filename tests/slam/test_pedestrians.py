"""Recorded walks of pedestrians: both forms, and what is wrong with a file."""

import gzip
import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.logs.pedestrians import read_pedestrians

DATA = os.environ.get("TAGALONG_DATA")
PLAIN = "".join(f"{10 * k} 7 {0.5 * k} 2.0\n{10 * k} 8 3.0 {-0.2 * k}\n" for k in range(9))
OBSMAT = "".join(f"{6 * k}.0 7 {0.5 * k} 0 2.0 1.2 0 0\n" for k in range(9))


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("text", [PLAIN, OBSMAT])
def test_both_forms_are_read(tmp_path, text, packed):
    file = tmp_path / "walks.txt"
    file.write_bytes(gzip.compress(text.encode()) if packed else text.encode())
    walk = read_pedestrians(file)[0]
    assert walk.person == 7
    assert np.allclose(walk.time_s, 0.4 * np.arange(9))
    assert np.allclose(walk.points, np.stack((0.5 * np.arange(9), np.full(9, 2.0)), axis=-1))


def test_smoothing_leaves_straight_walks_and_ends_alone(tmp_path):
    (tmp_path / "walks.txt").write_text(PLAIN)
    walk = read_pedestrians(tmp_path / "walks.txt")[0]
    assert np.allclose(walk.smoothed().points, walk.points)
    walk.points[4] += 0.1
    assert np.abs(walk.smoothed().points[4] - (2.0, 2.0)).max() < 0.05


@pytest.mark.parametrize(
    ("text", "word"), [("1 2 3\n", "line 1"), ("1 2 3 x\n", "line 1"), ("", "nobody walks"), ("1 2 3 4\n", "nobody")]
)
def test_what_is_wrong_is_said(tmp_path, text, word):
    (tmp_path / "walks.txt").write_text(text)
    with pytest.raises(InputError, match=word):
        read_pedestrians(tmp_path / "walks.txt")


def test_ways_that_nobody_walks_are_refused(tmp_path):
    rows = [f"{6 * k} 1 {0.5 * k} 0.0" for k in range(12)]
    (tmp_path / "walks.txt").write_text("\n".join([*rows, "72 1 1e8 0.0"]))
    with pytest.raises(InputError, match="person 1 goes 1e\\+08 m"):
        read_pedestrians(tmp_path / "walks.txt")


def test_a_damaged_gzip_file_is_one_clear_error(tmp_path):
    packed = bytearray(gzip.compress(PLAIN.encode() * 50))
    packed[25] ^= 0xFF
    (tmp_path / "walks.txt.gz").write_bytes(packed)
    with pytest.raises(InputError, match="cut or broken"):
        read_pedestrians(tmp_path / "walks.txt.gz")


@pytest.mark.skipif(DATA is None, reason="needs TAGALONG_DATA with recorded walks")
@pytest.mark.parametrize(
    ("file", "people", "speed"),
    [("seq_hotel/obsmat.txt.gz", 390, 1.28), ("zara01/obsmat.txt.gz", 148, 1.19), ("crowds_zara02.txt.gz", 204, 1.05)],
)
def test_recordings_of_eth_and_ucy_are_read(file, people, speed):
    walks = read_pedestrians(Path(DATA or "") / "pedestrians" / file)
    assert 0.75 * people < len(walks) <= people
    speeds = [np.hypot(*np.diff(w.points, axis=0).T) / np.diff(w.time_s) for w in walks]
    assert np.median(np.concatenate(speeds)) == pytest.approx(speed, abs=0.15)
