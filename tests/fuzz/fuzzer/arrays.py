"""npz files made hostile: arrays left out, of other shapes, kinds or values, headers of gigabytes, flipped bytes.

A hostile file is described by small edits of a sound one, so that a finding is short.
"""

import io
import struct
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from fuzzer.files import MEGABYTE
from fuzzer.mutations import extreme_float
from numpy.random import Generator

KINDS = ("<f8", "<f4", "<i8", "<i4", "|i1", "|u1", "|b1", "<c16", "<U5", "|S3", "<f2", "<M8[s]")
_SHAPES = ([], [0], [1], [2], [3, 0], [1, 1], [2, 3], [4, 4, 4], [10**10], [2**31, 2**31], [2**63], [-1], [0, 10**12])


_CACHE: dict[str, dict[str, np.ndarray]] = {}


def arrays_of(path: Path) -> dict[str, np.ndarray]:
    """Return the arrays of a sound file, which is read once."""
    if str(path) not in _CACHE:
        with np.load(path, allow_pickle=False) as content:
            _CACHE[str(path)] = {name: content[name] for name in content.files}
    return _CACHE[str(path)]


def edits(rng: Generator, names: list[str]) -> list[list[Any]]:
    """Return one to three edits of a file with arrays of these names."""
    return [_edit(rng, names[int(rng.integers(len(names)))]) for _ in range(int(rng.integers(1, 4)))]


def _edit(rng: Generator, name: str) -> list[Any]:
    draw = rng.random()
    if draw < 0.3:
        return ["put", name, int(rng.integers(1 << 30)), extreme_float(rng)]
    if draw < 0.4:
        return ["fill", name, extreme_float(rng)]
    if draw < 0.48:
        return ["drop", name]
    if draw < 0.58:
        return ["shape", name, _SHAPES[int(rng.integers(9))]]
    if draw < 0.68:
        return ["kind", name, KINDS[int(rng.integers(len(KINDS)))]]
    if draw < 0.76:
        return ["cut", name, int(rng.integers(0, 5))]
    if draw < 0.82:
        return ["header", name, KINDS[int(rng.integers(len(KINDS)))], _SHAPES[int(rng.integers(len(_SHAPES)))]]
    if draw < 0.84:
        return ["bomb", name, int(rng.integers(1200, 3000))]
    if draw < 0.87:
        return ["pickle", name]
    return ["flip", int(rng.integers(1 << 30)), int(rng.integers(256))] if draw < 0.97 else ["end", float(rng.random())]


def packed(arrays: dict[str, np.ndarray], changes: list[list[Any]]) -> bytes:
    """Return an npz file with the edits made."""
    entries = {name: np.array(array) for name, array in arrays.items()}
    raw: dict[str, tuple[bytes, int]] = {}
    for kind, name, *more in (change for change in changes if change[0] not in ("flip", "end")):
        if kind == "header":
            raw[name] = (header(*more), 0)
        elif kind == "pickle":
            raw[name] = (header("|O", [1]) + b"\x80\x04N.", 0)
        elif kind == "bomb":
            raw[name] = (header("<f8", [more[0] * MEGABYTE // 8]), more[0])
        elif name in entries:
            _change(entries, name, kind, more)
    return _damaged(_zip(entries, raw), changes)


def _change(entries: dict[str, np.ndarray], name: str, kind: str, more: list[Any]) -> None:
    array = entries[name]
    if kind == "drop":
        del entries[name]
    elif kind == "cut":
        entries[name] = array.reshape(-1)[: more[0]]
    elif kind == "shape":
        size = int(np.prod(more[0])) if more[0] else 1
        if 0 <= size <= 10**6:
            entries[name] = np.resize(array, size).reshape(more[0])
    elif kind == "kind":
        plain = array if array.dtype.kind in "fiub" else np.zeros(array.shape)
        entries[name] = plain.astype("<i8" if more[0].startswith("<M") else plain.dtype).astype(more[0])
    elif array.dtype.kind not in "fiub":
        entries[name] = np.full(array.shape, str(more[-1]))
    elif kind == "fill" or array.size == 0:
        entries[name] = _cast(np.full(array.shape, more[-1]), array)
    else:
        values = array.astype(np.float64)
        values.reshape(-1)[more[0] % array.size] = more[1]
        entries[name] = _cast(values, array)


def _cast(values: np.ndarray, like: np.ndarray) -> np.ndarray:
    with np.errstate(all="ignore"):
        return values.astype(like.dtype)


def header(kind: str, shape: list[int]) -> bytes:
    """Return the beginning of an .npy that says it holds this."""
    sizes = ", ".join(map(str, shape)) + "," * (len(shape) == 1)
    text = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': ({sizes}), }}"
    text += " " * (-(len(text) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode()


def _zip(entries: dict[str, np.ndarray], raw: dict[str, tuple[bytes, int]]) -> bytes:
    """Return a zip of npy files; raw ones are a beginning and so many megabytes of zeros, packed a thousandfold."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for name, array in entries.items():
            if name not in raw:
                part = io.BytesIO()
                np.lib.format.write_array(part, array, allow_pickle=False)
                archive.writestr(zipfile.ZipInfo(f"{name}.npy"), part.getvalue())
        for name, (begin, megabytes) in raw.items():
            archive.writestr(zipfile.ZipInfo(f"{name}.npy"), begin if not megabytes else b"?" * 8)
    content = file.getvalue()
    for name, (begin, megabytes) in raw.items():
        if megabytes:
            content = _zip_bomb(f"{name}.npy", begin, megabytes)
    return content


def _zip_bomb(name: str, begin: bytes, megabytes: int) -> bytes:
    """Return a zip of one file that begins so and goes on with zeros."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    head = packer.compress(begin) + packer.flush(zlib.Z_FULL_FLUSH)
    piece = packer.compress(bytes(MEGABYTE)) + packer.flush(zlib.Z_FULL_FLUSH)
    data, size = head + piece * megabytes + b"\x03\x00", len(begin) + megabytes * MEGABYTE
    about = struct.pack("<HHHHHIIIHH", 20, 0, 8, 0, 33, 0, len(data), size, len(name), 0)
    local = b"PK\x03\x04" + about + name.encode() + data
    central = b"PK\x01\x02" + struct.pack("<H", 20) + about + struct.pack("<HHHII", 0, 0, 0, 0, 0) + name.encode()
    return local + central + b"PK\x05\x06" + struct.pack("<HHHHIIH", 0, 0, 1, 1, len(central), len(local), 0)


def _damaged(content: bytes, changes: list[list[Any]]) -> bytes:
    result = bytearray(content)
    for change in changes:
        if change[0] == "flip" and result:
            result[change[1] % len(result)] ^= change[2]
        elif change[0] == "end":
            del result[int(change[1] * len(result)) :]
    return bytes(result)
