"""What is read is a regular file of a bounded size, whatever stands in its place."""

import io
import json
import os
import struct
import zipfile

import numpy as np
import pytest
from tagalong.slam.errors import InputError, one_line, shown, unknown_name
from tagalong.slam.files.input import opened, read_bytes
from tagalong.slam.files.output import read_arrays, read_json

NO_FILES = ["/dev/zero", "/dev/null", ".", "pipe", "nowhere", "n" * 5000, "nul\0"]


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe")
    return tmp_path


@pytest.mark.parametrize("name", NO_FILES)
def test_nothing_but_a_regular_file_is_read(name, here):
    for read in (read_json, read_arrays, lambda path: read_bytes(path, 1 << 20, "small")):
        with pytest.raises(InputError) as error:
            read(name)
        assert len(str(error.value)) < 500
        assert str(error.value).isprintable()


def test_a_file_that_is_exchanged_for_a_pipe_is_not_waited_for(here, monkeypatch):
    monkeypatch.setattr("tagalong.slam.files.input.require_regular", lambda path: None)
    with pytest.raises(InputError, match="pipe: is a pipe, where a file is needed"), opened("pipe", 9, "small"):
        pass


def test_what_is_too_large_says_how_large_it_may_be(tmp_path):
    (tmp_path / "a.json").write_text("[" + "1, " * 40 + "1]")
    with pytest.raises(InputError, match=r"a.json: is too large \(123 bytes\); a JSON file has at most 100 bytes"):
        read_json(tmp_path / "a.json", most_bytes=100)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ('{"a": 1,\n "b": }', r"a.json:2:7: no JSON \(Expecting value\)"),
        ("[" * 100_000, "a.json: is nested too deeply"),
        ("9" * 5000, "a.json: no JSON"),
        ("[1, NaN]", "'NaN' is no finite number"),
        ("1e999", "'1e999' is no finite number"),
        ("", "a.json:1:1: no JSON"),
    ],
)
def test_what_is_no_json_says_where(text, complaint, tmp_path):
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(InputError, match=complaint):
        read_json(tmp_path / "a.json")


def test_json_comes_back_as_it_was(tmp_path):
    content = {"a": [1, 2.5, None, True], "b": {"c": "ü"}}
    (tmp_path / "a.json").write_text(json.dumps(content))
    assert read_json(tmp_path / "a.json") == content


def npy(header: str, data: bytes = b"") -> bytes:
    text = header.encode().ljust(117) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + data


def npz(path, content: bytes, **more) -> None:
    with zipfile.ZipFile(path, "w", **more) as file:
        file.writestr("one.npy", content)


@pytest.mark.parametrize(
    "header",
    [
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000,), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (999999999999, 999999999999, 999999999999), }",
        "{'descr': '|O', 'fortran_order': False, 'shape': (1,), }",
        "{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (1,), }",
        "{'descr': '<U999999999', 'fortran_order': False, 'shape': (), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': " + "(" * 90 + ")",
        "{'descr': '|b1', 'fortran_order': False, 'shape': (8,), }",
        "{'descr': '<U2', 'fortran_order': False, 'shape': (1,), }",
    ],
)
def test_a_size_that_an_array_only_states_is_not_believed(header, tmp_path):
    npz(tmp_path / "a.npz", npy(header, b"\xff" * 8))
    with pytest.raises(InputError, match=r"a\.npz: no readable npz file \('one.npy'"):
        read_arrays(tmp_path / "a.npz")


def test_an_array_that_expands_to_gigabytes_is_refused_by_what_its_entry_states(tmp_path, monkeypatch):
    monkeypatch.setattr("tagalong.slam.files.npz.MOST_BYTES", 1 << 16)
    np.savez_compressed(tmp_path / "a.npz", one=np.zeros(1 << 20))
    with pytest.raises(InputError, match="an npz file and all its arrays together have at most"):
        read_arrays(tmp_path / "a.npz")


def test_a_zip_of_very_many_entries_is_refused_before_they_are_listed(tmp_path, monkeypatch):
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as file:
        for k in range(1100):
            file.writestr(f"{k}.npy", b"")
    monkeypatch.setattr("zipfile.ZipFile", lambda *_: pytest.fail("it was listed"))
    with pytest.raises(InputError, match="1100 entries; an npz file has at most 1000"):
        read_arrays(tmp_path / "a.npz")


def test_arrays_of_all_plain_kinds_come_back_as_numpy_reads_them(tmp_path):
    arrays = {
        "scalar": np.array(3.5),
        "text": np.array(["one", "two"]),
        "transposed": np.arange(6.0).reshape(2, 3).T,
        "none": np.zeros((0, 3), np.float32),
        "truth": np.array([True, False]),
        "small": np.arange(5, dtype=np.uint8),
    }
    np.savez_compressed(tmp_path / "a.npz", **arrays)
    found = read_arrays(tmp_path / "a.npz")
    for name, array in arrays.items():
        assert found[name].dtype == array.dtype
        assert found[name].shape == array.shape
        assert np.array_equal(found[name], array)
    np.savez(tmp_path / "big_endian.npz", one=np.arange(3, dtype=">f8"))
    assert read_arrays(tmp_path / "big_endian.npz")["one"].dtype == np.dtype("f8").newbyteorder("=")


def test_a_value_in_an_error_is_short_and_on_one_line():
    deep: list = []
    for _ in range(5000):
        deep = [deep]
    for value in ("x" * 5000, "a\nb\x1b[31m", list(range(5000)), deep, 10**9000, np.zeros((50, 50)), b"\n" * 5000):
        assert len(shown(value)) <= 80
        assert shown(value).isprintable()
    assert shown("short") == "'short'"
    assert shown([1, 2.5]) == "[1, 2.5]"
    assert one_line("begin" + "." * 500 + "end", 40) == "begin.................. ... .........end"
    assert len(str(unknown_name("scene", "y" * 5000, ["office"]))) < 150


def test_a_damaged_entry_is_found_by_its_check_sum(tmp_path):
    buffer = io.BytesIO()
    np.savez(buffer, one=np.zeros(1000))
    content = bytearray(buffer.getvalue())
    content[4000] ^= 1
    (tmp_path / "a.npz").write_bytes(content)
    with pytest.raises(InputError, match="CRC"):
        read_arrays(tmp_path / "a.npz")
