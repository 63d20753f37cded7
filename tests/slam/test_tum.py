import gzip

import numpy as np
import pytest
from evo.tools import file_interface
from hypothesis import given, settings
from hypothesis import strategies as st
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between
from tagalong.slam.logs.tum import Trajectory, read_tum, write_tum


def some(n=20, seed=0):
    rng = np.random.default_rng(seed)
    poses = np.column_stack((rng.uniform(-50, 50, (n, 2)), rng.uniform(-np.pi, np.pi, n)))
    return Trajectory(976052857.340246 + np.arange(n) * 0.1, poses)


@settings(deadline=None, max_examples=25)
@given(st.integers(1, 30), st.integers(0, 1000))
def test_what_is_written_is_read_back(tmp_path_factory, n, seed):
    path = tmp_path_factory.mktemp("tum") / "a.tum.gz"
    trajectory = some(n, seed)
    write_tum(path, trajectory)
    back = read_tum(path)
    np.testing.assert_allclose(back.times_s, trajectory.times_s, atol=1e-6)
    assert np.abs(between(trajectory.poses, back.poses)).max() < 1e-5


def test_evo_reads_what_we_write(tmp_path):
    trajectory = some()
    write_tum(tmp_path / "a.tum", trajectory)
    read = file_interface.read_tum_trajectory_file(str(tmp_path / "a.tum"))
    np.testing.assert_allclose(read.positions_xyz[:, :2], trajectory.poses[:, :2], atol=1e-6)
    np.testing.assert_allclose(read.orientations_quat_wxyz[:, 3], np.sin(trajectory.poses[:, 2] / 2), atol=1e-8)


def test_gzipped_files_are_equal_to_the_byte_under_any_name(tmp_path):
    write_tum(tmp_path / "a.tum.gz", some())
    write_tum(tmp_path / "other.tum.gz", some())
    assert (tmp_path / "a.tum.gz").read_bytes() == (tmp_path / "other.tum.gz").read_bytes()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 2 3\n", r"x\.tum:1: .*8 numbers.*got 3"),
        ("# a comment\n0 0 0 0 0 0 0 one\n", r"x\.tum:2: expected a number, got 'one'"),
        ("0 0 0 0 0 0 0 0.5\n", "quaternion of length 1"),
        ("0 nan 0 0 0 0 0 1\n", "finite"),
        ("0 0 0 0 0.6 0 0 0.8\n", "rotation about z only"),
        ("# nothing\n", "at least one TUM line"),
    ],
)
def test_mistakes_are_named_with_their_line(tmp_path, text, message):
    (tmp_path / "x.tum").write_text(text)
    with pytest.raises(InputError, match=message):
        read_tum(tmp_path / "x.tum")


def test_missing_binary_and_cut_files_are_named(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_tum(tmp_path / "none.tum")
    (tmp_path / "image.tum").write_bytes(b"\xff\xfe\x00\x81")
    with pytest.raises(InputError, match="text file"):
        read_tum(tmp_path / "image.tum")
    whole = gzip.compress(b"0 0 0 0 0 0 0 1\n" * 1000)
    (tmp_path / "cut.tum.gz").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError, match="cut or broken"):
        read_tum(tmp_path / "cut.tum.gz")


def test_a_trajectory_needs_as_many_times_as_poses():
    with pytest.raises(InputError, match=r"\(2,\), \(3, 3\)"):
        Trajectory(np.zeros(2), np.zeros((3, 3)))
