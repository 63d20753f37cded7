"""Arrays of npz and npy files, read without ever believing a size that the file only states."""

import re
import struct
import sys
import zipfile
import zlib
from math import prod
from pathlib import Path
from typing import IO, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, one_line, shown
from .input import MIB, Source, named, opened

MOST_BYTES = 512 * MIB
"""Of a file, and of all its arrays together: 64 million numbers; an hour of a laser with 1081 beams at 16 Hz."""
_MOST_ARRAYS = 1000
_MOST_DIRECTORY = MIB  # bytes of the zip's table of contents: a thousand names of a thousand characters
_MOST_HEADER = 10_000  # bytes, as numpy has it
_MOST_DIMENSIONS, _MOST_DIGITS = 8, 12
_END, _END_64 = b"PK\x05\x06", b"PK\x06\x07"
# as numpy writes it; of plain kinds: bool, whole numbers, floats, text
_HEADER = re.compile(
    r"\{ *'descr': *'(?P<dtype>[<>|=](?:b1|[iu][1248]|f[248]|[US]\d{1,9}))', *"
    r"'fortran_order': *(?P<order>True|False), *'shape': *\((?P<shape>[\d, ]{0,200})\),? *\} *\n?"
)
_DAMAGE = (
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    EOFError,
    IndexError,
    KeyError,
    NotImplementedError,
    OverflowError,
    RuntimeError,
    ValueError,
)
"""What the library of zip files raises for damaged bytes."""


def read_arrays(path: Source) -> dict[str, NDArray[Any]]:
    """Return the arrays of an npz file by name, in the machine's byte order; no objects, no pickles.

    Every size that the file states is held against `MOST_BYTES` and against what is there before room is made for it.

    Raises:
        InputError: If there is no such file, it is damaged, no npz, too large, or holds something else than arrays of
            numbers and text.
    """
    with opened(path, MOST_BYTES, _too_large()) as file:
        try:
            _check_end(file)
            with zipfile.ZipFile(file) as content:
                entries = content.infolist()
                _check_entries(entries)
                return {entry.filename.removesuffix(".npy"): _entry(content, entry) for entry in entries}
        except _DAMAGE as error:
            raise InputError(f"{named(path)}: no readable npz file ({one_line(str(error), 200)})") from error


def read_array(path: Source, most_bytes: int = MOST_BYTES) -> NDArray[Any]:
    """Return the array of an npy file, in the machine's byte order; no objects, no pickles.

    Raises:
        InputError: If there is no such file, it is damaged, no npy, larger than `most_bytes`, or holds something else
            than numbers or text.
    """
    with opened(path, most_bytes, f"an npy file has at most {most_bytes // MIB} MiB here") as file:
        size = file.seek(0, 2)
        file.seek(0)
        try:
            return _array(file, Path(path).name, size)
        except _DAMAGE as error:
            raise InputError(f"{named(path)}: no readable npy file ({one_line(str(error), 200)})") from error


def _too_large() -> str:
    return f"an npz file and all its arrays together have at most {MOST_BYTES // MIB} MiB"


def _check_end(file: BinaryIO) -> None:
    """Refuse a zip whose table of contents is long before it is read: of names alone one could make gigabytes."""
    size = file.seek(0, 2)
    file.seek(max(0, size - 42))
    end = file.read(42)
    if end[-22:-18] != _END or end[:4] == _END_64:
        raise ValueError("no zip file as numpy writes it")
    count, directory = struct.unpack("<HI", end[-12:-6])
    if count > _MOST_ARRAYS or directory > _MOST_DIRECTORY:
        raise ValueError(f"{count} entries; an npz file has at most {_MOST_ARRAYS}")
    file.seek(0)


def _check_entries(entries: list[zipfile.ZipInfo]) -> None:
    for entry in entries:
        if not entry.filename.endswith(".npy"):
            raise ValueError(f"{shown(entry.filename)} is no array")
        if entry.flag_bits & 0x1 or entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise ValueError(f"{shown(entry.filename)} is encrypted, or compressed as numpy does not")
    if len({entry.filename for entry in entries}) != len(entries):
        raise ValueError("an array comes twice")
    if sum(entry.file_size for entry in entries) > MOST_BYTES:
        raise ValueError(_too_large())


def _entry(content: zipfile.ZipFile, entry: zipfile.ZipInfo) -> NDArray[Any]:
    """Return one array; the zip gives no more bytes than its entry states, which was checked."""
    with content.open(entry) as stream:
        return _array(stream, entry.filename, entry.file_size)


def _array(stream: IO[bytes], name: str, length: int) -> NDArray[Any]:
    """Return the array of a npy stream of so many bytes."""
    dtype, shape, order, start = _header(stream, name)
    size = dtype.itemsize * prod(shape)
    if start + size != length:
        raise ValueError(
            f"{shown(name)} states {shown(shape)} of {dtype.str}, {shown(size)} bytes, and has {length - start}"
        )
    values = np.empty(size, dtype=np.uint8)
    _fill(values, stream)
    array = values.view(dtype).reshape(shape, order=order)
    array = array if dtype.isnative else array.astype(dtype.newbyteorder("="))
    # numpy would count other truths wrong, and index by the count; and make no text of other signs
    if (dtype.kind == "b" and values.max(initial=0) > 1) or (
        dtype.kind == "U" and array.ravel().view(np.uint32).max(initial=0) > sys.maxunicode
    ):
        raise ValueError(f"{shown(name)} holds bytes that are no {dtype}")
    return array


def _fill(values: NDArray[np.uint8], stream: IO[bytes]) -> None:
    """Read all of `values` from a stream, and its end, which is where its check sum is looked at."""
    got = 0
    while block := stream.read(MIB):
        values[got : got + len(block)] = np.frombuffer(block, np.uint8)
        got += len(block)
    if got != len(values):
        raise ValueError(f"an array is cut after {got} of {len(values)} bytes")


def _header(stream: IO[bytes], name: str) -> tuple[np.dtype[Any], tuple[int, ...], Any, int]:
    """Return type, shape, order ("C" or "F") of the array in a npy stream, and the number of bytes up to its data."""
    magic = stream.read(8)
    if magic[:6] != b"\x93NUMPY" or magic[6] not in (1, 2, 3):
        raise ValueError(f"{shown(name)} is no npy file")
    layout = "<H" if magic[6] == 1 else "<I"
    length = struct.unpack(layout, stream.read(struct.calcsize(layout)))[0]
    if length > _MOST_HEADER:
        raise ValueError(f"{shown(name)} has a header of {length} bytes; at most {_MOST_HEADER}")
    text = stream.read(length).decode("latin-1")
    found = _HEADER.fullmatch(text)
    if found is None:
        raise ValueError(f"{shown(name)} is no array of numbers or text: {shown(text.rstrip())}")
    words = found["shape"].replace(" ", "").removesuffix(",").split(",") if found["shape"].strip() else []
    if len(words) > _MOST_DIMENSIONS or not all(0 < len(word) <= _MOST_DIGITS for word in words):
        raise ValueError(f"{shown(name)} has the shape {shown(found['shape'])}; at most {_MOST_DIMENSIONS} numbers")
    shape = tuple(map(int, words))
    order = "F" if found["order"] == "True" else "C"
    return _dtype(found["dtype"], name), shape, order, 8 + struct.calcsize(layout) + length


def _dtype(word: str, name: str) -> np.dtype[Any]:
    try:
        return np.dtype(word)
    except (TypeError, ValueError) as error:  # texts of gigabytes
        raise ValueError(f"{shown(name)} is an array of {word}: {error}") from error
