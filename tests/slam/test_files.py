"""Files that come damaged."""

import zipfile

import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.files import read_arrays, write_json


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
