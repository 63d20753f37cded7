"""Logs and maps that would take all memory or time end soon, with the bound that they broke."""

import gzip
from itertools import islice

import numpy as np
import pytest
from tagalong.slam.drives.log import read_log
from tagalong.slam.errors import InputError
from tagalong.slam.files import sizes
from tagalong.slam.logs import text
from tagalong.slam.logs.beesoft import read_beesoft_map
from tagalong.slam.logs.carmen import read_carmen
from tagalong.slam.logs.flat_yaml import read_flat_yaml
from tagalong.slam.logs.g2o import read_g2o
from tagalong.slam.logs.pedestrians import read_pedestrians
from tagalong.slam.logs.ros_map import read_ros_map
from tagalong.slam.logs.scans_npz import read_scans_npz
from tagalong.slam.logs.text import numbered_lines
from tagalong.slam.logs.tum import read_tum

LINE = "FLASER 3 1 2 1 0 0 0 0 0 0 0 h 0\n"
DIGITS = "9" * 5000


def test_a_stream_that_expands_beyond_the_bound_is_refused_before_its_lines_are_read(tmp_path, monkeypatch):
    monkeypatch.setattr(text, "MOST_BYTES", 1 << 20)
    monkeypatch.setattr(text, "_COUNTED_FROM", 1 << 16)
    monkeypatch.setattr(text.numbered_bytes, "__defaults__", (text.MOST_LINES, 1 << 20))
    (tmp_path / "a.log.gz").write_bytes(gzip.compress(LINE.encode() * 100_000))
    lines = text.numbered_bytes(tmp_path / "a.log.gz")
    assert len(list(islice(lines, 1000))) == 1000
    with pytest.raises(InputError, match=r"a\.log\.gz: unpacks to more than 1048576 bytes"):
        list(islice(lines, 2000))


def test_a_line_without_an_end_is_refused_when_it_is_too_long(tmp_path):
    (tmp_path / "a.log.gz").write_bytes(gzip.compress(bytes(1 << 24)))
    with pytest.raises(InputError, match="has a line of more than 1048576 bytes"):
        read_log(tmp_path / "a.log.gz")


def test_a_file_of_very_many_lines_says_how_many_it_may_have(tmp_path):
    (tmp_path / "a.tum").write_text("\n" * 200)
    with pytest.raises(InputError, match="has more than 100 lines: cut it into parts"):
        list(numbered_lines(tmp_path / "a.tum", most_lines=100))


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("block", [1, 2, 3, 7, 1 << 16])
def test_lines_are_those_that_python_finds_whatever_the_blocks(end, block, tmp_path, monkeypatch):
    monkeypatch.setattr(text, "_BLOCK", block)
    content = end.join(["one", "", "drei ü", "four", "", ""])
    (tmp_path / "a.txt").write_bytes(content.encode())
    with (tmp_path / "a.txt").open(encoding="utf-8") as file:
        expected = [(k, line.rstrip("\n")) for k, line in enumerate(file, start=1)]
    assert list(numbered_lines(tmp_path / "a.txt")) == expected


def test_scans_and_ranges_are_counted_as_they_are_read(tmp_path, monkeypatch):
    (tmp_path / "a.log").write_text(LINE * 50)
    monkeypatch.setattr(sizes, "MOST_RANGES", 90)
    with pytest.raises(InputError, match="a drive has at most 1000000 scans and 90 ranges, got 31 and 93 or more"):
        read_carmen(tmp_path / "a.log")
    np.savez(
        tmp_path / "a.npz", ranges=np.ones((50, 3)), angle_min=0.0, angle_increment=0.1, range_min=0.0, range_max=9.0
    )
    with pytest.raises(InputError, match="a drive has at most 1000000 scans and 90 ranges"):
        read_scans_npz(tmp_path / "a.npz")


@pytest.mark.parametrize(
    ("read", "content"),
    [
        (read_log, f"FLASER {DIGITS} 1 2 3"),
        (read_log, f"FLASER 3 1 2 {'x' * 5000} 0 0 0 0 0 0 0 h 0"),
        (read_log, f"Odometry 0 0 0\nLaser {DIGITS} 1 2"),
        (read_log, f"Odometry 0 0 {'x' * 5000}"),
        (read_log, f"L {'x ' * 187}{'y' * 5000}"),
        (read_log, "O " + "x" * 5000),
        (read_beesoft_map, f"robot_specifications->resolution 10\nglobal_map[0]: {DIGITS} {DIGITS}"),
        (read_beesoft_map, "robot_specifications->resolution 10\nglobal_map[0]: 99999 99999\n"),
        (read_beesoft_map, f"robot_specifications->resolution 10\nglobal_map[0]: 1 1\n{'x' * 5000}"),
        (read_tum, " ".join(["1" * 5000] * 8)),
        (read_tum, "0 1e300 0 0 0 0 0 1"),
        (read_g2o, f"VERTEX_SE2 {DIGITS} 0 0 0"),
        (read_g2o, f"VERTEX_SE2 0 {'x' * 5000} 0 0"),
        (read_pedestrians, "x" * 5000),
        (read_pedestrians, "1e300 1 1 1\n" * 9),
        (read_flat_yaml, "x" * 5000),
        (read_flat_yaml, "a: b\n" * 2),
        (read_flat_yaml, "k: " + "a " * 40_000),
    ],
)
def test_what_is_wrong_is_told_in_a_few_words(read, content, tmp_path):
    (tmp_path / "a.log").write_text(content)
    with pytest.raises(InputError, match=r"a\.log") as error:
        read(tmp_path / "a.log")
    assert len(str(error.value)) < 400 + len(str(tmp_path))
    assert str(error.value).isprintable()


@pytest.mark.parametrize("header", ["P5\n99999 99999\n255\n", "P2\n99999 99999\n255\n", "P5\n3000 3000\n255\n"])
def test_an_image_that_states_more_pixels_than_there_are_is_refused(header, tmp_path):
    (tmp_path / "m.pgm").write_text(header)
    (tmp_path / "m.yaml").write_text(
        "image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    with pytest.raises(InputError, match=r"m\.pgm: .*(at most|is cut)"):
        read_ros_map(tmp_path / "m.yaml")


def test_a_recording_with_a_person_a_line_is_read_in_no_time(tmp_path):
    (tmp_path / "walks.txt").write_text("".join(f"{k} {k} 0 0\n" for k in range(20_000)))
    with pytest.raises(InputError, match="nobody walks"):
        read_pedestrians(tmp_path / "walks.txt")
