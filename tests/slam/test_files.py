"""Files that come damaged."""

import os
import shutil
import zipfile
from pathlib import Path

import numpy as np
import pytest
from full_disk import full_disk
from tagalong.slam.errors import InputError
from tagalong.slam.files.output import made_folder, read_arrays, replacing, require_writable, write_json
from tagalong.slam.logs.text import write_lines


def test_arrays_come_back_by_name(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", one=np.arange(3), two=np.eye(2))
    arrays = read_arrays(tmp_path / "a.npz")
    assert sorted(arrays) == ["one", "two"]
    assert np.array_equal(arrays["one"], np.arange(3))


def test_wherever_a_file_is_damaged_it_is_one_error_with_the_name(tmp_path):
    """A damaged byte may stop the zip, its compression, the header's parser or the array."""
    np.savez_compressed(tmp_path / "a.npz", one=np.arange(2000.0) ** 0.5, two=np.eye(9))
    whole, said = (tmp_path / "a.npz").read_bytes(), []
    for k in range(0, len(whole), len(whole) // 60):
        damaged = bytearray(whole)
        damaged[k] ^= 0xFF
        (tmp_path / "b.npz").write_bytes(damaged)
        try:
            read_arrays(tmp_path / "b.npz")
        except InputError as error:
            said.append(str(error))
    assert len(said) > 40
    assert all("b.npz" in each for each in said)


@pytest.mark.parametrize(
    "text", ["{'descr': '<f8', 'shape'", "{'descr': '<f8', 'fortran_order': False, 'shape': (-1,)}"]
)
def test_an_array_with_a_senseless_header_is_an_error(tmp_path, text):
    header = text.encode().ljust(117) + b"\n"
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as file:
        file.writestr("one.npy", b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header)
    with pytest.raises(InputError, match=r"a\.npz"):
        read_arrays(tmp_path / "a.npz")


def test_what_is_no_npz_is_an_error(tmp_path):
    np.save(tmp_path / "a.npy", np.zeros(3))
    for name in ("a.npy", "nowhere.npz", "."):
        with pytest.raises(InputError):
            read_arrays(tmp_path / name)


def test_a_folder_in_the_way_of_a_file_is_named(tmp_path):
    (tmp_path / "scores.json").mkdir()
    with pytest.raises(InputError, match=r"scores\.json: cannot be written"):
        write_json(tmp_path / "scores.json", {})
    assert [entry.name for entry in tmp_path.iterdir()] == ["scores.json"]


def test_a_full_disk_is_one_error_and_leaves_nothing_behind(tmp_path):
    noise = np.random.default_rng(0).integers(0, 255, (99, 99, 3), dtype=np.uint8)
    lines = [f"{value}" for value in noise.ravel()[:2000]]
    for name, write in {
        "a.json": lambda path: write_json(path, {"a": lines}),
        "a.log.gz": lambda path: write_lines(path, lines * 5),
        "a.npz": lambda path: save_arrays(path, noise),
    }.items():
        write(tmp_path / name)
        whole = (tmp_path / name).read_bytes()
        with full_disk(), pytest.raises(InputError, match=rf"{name}: cannot be written \(File too large\)"):
            write(tmp_path / name)
        assert (tmp_path / name).read_bytes() == whole
        assert not list(tmp_path.glob(".*"))


def save_arrays(path, noise):
    with replacing(path) as temporary:
        np.savez_compressed(temporary, noise=noise)


def test_what_is_no_file_is_never_replaced(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to(tmp_path / "pipe")
    for target in (tmp_path / "pipe", tmp_path / "link", Path("/dev/null")):
        was = target.stat().st_mode
        with pytest.raises(InputError, match=r"cannot be written \(is a (pipe|device), not a file\)"):
            write_json(target, {})
        with pytest.raises(InputError, match=r"cannot be written \(is a (pipe|device), not a file\)"):
            require_writable(target)
        assert target.stat().st_mode == was


def test_a_link_stays_a_link_and_what_it_points_to_is_replaced(tmp_path):
    (tmp_path / "real.json").write_text("old")
    (tmp_path / "link.json").symlink_to(tmp_path / "real.json")
    (tmp_path / "new.json").symlink_to(tmp_path / "deep" / "made.json")
    for name in ("link", "new"):
        write_json(tmp_path / f"{name}.json", {"a": 1})
        assert (tmp_path / f"{name}.json").is_symlink()
    assert "1" in (tmp_path / "real.json").read_text()
    assert "1" in (tmp_path / "deep" / "made.json").read_text()


@pytest.mark.parametrize("name", ["n" * 300, "a\0b", "\ud800", "loop", "x" * 5000])
def test_names_that_no_file_can_have_are_one_error(name, tmp_path):
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    for attempt in (lambda path: write_json(path, {}), made_folder, require_writable):
        with pytest.raises(InputError) as error:
            attempt(tmp_path / name)
        assert "\n" not in str(error.value)
        assert len(str(error.value)) < 600


def test_the_longest_name_that_a_file_can_have_can_be_written(tmp_path):
    write_json(tmp_path / ("n" * 250 + ".json"), {})
    assert len(list(tmp_path.iterdir())) == 1


def test_a_folder_that_is_gone_meanwhile_is_one_error(tmp_path):
    with pytest.raises(InputError, match=r"a.json: cannot be written"), replacing(tmp_path / "out" / "a.json"):
        shutil.rmtree(tmp_path / "out")


def test_asking_whether_something_can_be_written_leaves_nothing_behind(tmp_path):
    for there in ("new", "new/and/deep"):
        require_writable(tmp_path / there)
    require_writable(tmp_path, folder=True)
    assert list(tmp_path.iterdir()) == []


def test_a_file_may_be_written_again_but_is_no_folder(tmp_path):
    log = tmp_path / "drive.txt"
    log.write_text("old")
    require_writable(log)
    assert log.read_text() == "old"
    with pytest.raises(InputError, match=r"drive.txt: Not a directory"):
        require_writable(log / "below")
    with pytest.raises(InputError, match=r"drive.txt: is a file, where a folder has to be written"):
        require_writable(log, folder=True)
    with pytest.raises(InputError, match="is a folder, where a file has to be written"):
        require_writable(tmp_path)
