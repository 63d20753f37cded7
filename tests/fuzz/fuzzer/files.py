"""Inputs as files on disk, among them those that are small and say that they are large."""

import zlib
from pathlib import Path
from typing import Any

MEGABYTE = 1 << 20


def put(folder: Path, name: str, content: bytes | dict[str, Any]) -> Path:
    """Write a file of a folder and return its path; {"bomb": line, "megabytes": n} is a stream that says it often."""
    path = folder / name
    if isinstance(content, dict):
        content = bomb(content["bomb"], content["megabytes"])
    if path.is_dir():
        path.rmdir()
    path.write_bytes(content)
    return path


def put_all(folder: Path, files: dict[str, bytes]) -> Path:
    """Write the files of a folder, which holds nothing else then, and return it."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.iterdir():
        if old.name not in files:
            old.unlink()
    for name, content in files.items():
        put(folder, name, content)
    return folder


def bomb(line: bytes, megabytes: int) -> bytes:
    """Return a gzip stream of a thousandth of the size that comes out of it: `line`, again and again."""
    block = (line * (MEGABYTE // len(line) + 1))[:MEGABYTE]
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    piece = packer.compress(block) + packer.flush(zlib.Z_FULL_FLUSH)  # stands for itself, so it can be repeated
    return b"\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\x03" + piece * megabytes + b"\x03\x00" + bytes(8)
