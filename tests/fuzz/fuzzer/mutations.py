"""Valid input made hostile: numbers replaced by extreme ones, bytes flipped, lines cut, spliced and repeated."""

import gzip

import numpy as np
from numpy.random import Generator

EXTREMES = (
    "0", "-0.0", "nan", "inf", "-inf", "-1", "1", "1e308", "-1e308", "1e25", "-1e25", "9.2e18", "1e19", "1e10", "1e6",
    "1e-320", "5e-324", "1e-9", "1e9999", "2147483647", "2147483648", "-2147483649", "4294967296",
    "9223372036854775807",
    "9223372036854775808", "-9223372036854775809", "18446744073709551616", "65536", "255", "1000000", "1000000000",
    "0x10", "1_000", "1,5", "1e", "--1", "+1", "3.14", "180", "٣", "½", "", "NaN", "None", "True", "1" * 300,
)  # fmt: skip
"""Numbers, and what is nearly one, as words."""
HUGE_COUNT = "9" * 5000
WORDS = (
    "\x00",
    "\ufeff",
    "é",
    "\u2028",
    "日本",
    "\x1b[31m",
    "#",
    "-",
    "--",
    ":",
    "[",
    "]",
    "{",
    "}",
    "'",
    '"',
    "../",
    "x" * 3000,
)


def choice(rng: Generator, options: tuple[str, ...] | list[str]) -> str:
    """Return one of the options."""
    return options[int(rng.integers(len(options)))]


def extreme(rng: Generator) -> str:
    """Return an extreme number as a word, one in fifty of 5,000 digits."""
    return HUGE_COUNT if rng.random() < 0.02 else choice(rng, EXTREMES)


def extreme_float(rng: Generator) -> float:
    """Return an extreme number."""
    return float(
        choice(
            rng,
            ["0", "-0.0", "nan", "inf", "-inf", "-1", "1e308", "-1e308", "1e25", "-1e25", "9.2e18", "1e19", "1e-320",
             "1e-9", "1e6", "-1e6", "1e4", "2147483648", "1e12", "1e3"],
        )
    )  # fmt: skip


def mutated_text(rng: Generator, text: bytes) -> bytes:
    """Return a text with one to four changes to its lines, words or bytes, now and then gzipped."""
    lines = text.split(b"\n")
    for _ in range(int(rng.integers(1, 5))):
        lines = _changed_lines(rng, lines)
    result = b"\n".join(lines)
    if rng.random() < 0.15:
        result = mutated_bytes(rng, result)
    return gzipped(rng, result) if rng.random() < 0.03 else result


def _changed_lines(rng: Generator, lines: list[bytes]) -> list[bytes]:
    draw, at = rng.random(), int(rng.integers(len(lines)))
    if draw < 0.7:
        return [*lines[:at], _changed_words(rng, lines[at]), *lines[at + 1 :]]
    if draw < 0.77:
        return [*lines[:at], *[lines[at]] * int(rng.integers(2, 6)), *lines[at + 1 :]]
    if draw < 0.84:
        return lines[:at] + lines[at + 1 :] or [b""]
    if draw < 0.89:
        other = int(rng.integers(len(lines)))
        return [*lines[:at], lines[other], *lines[at:]]
    if draw < 0.93:
        return [*lines[:at], lines[at][: int(rng.integers(len(lines[at]) + 1))]]
    return [*lines[:at], choice(rng, WORDS).encode() + lines[at], *lines[at + 1 :]]


def _changed_words(rng: Generator, line: bytes) -> bytes:
    words = line.split(b" ")
    at, draw = int(rng.integers(len(words))), rng.random()
    if draw < 0.75:
        words[at] = extreme(rng).encode()
    elif draw < 0.83:
        del words[at]
    elif draw < 0.91:
        words.insert(at, words[int(rng.integers(len(words)))])
    else:
        words[at] = choice(rng, WORDS).encode()
    return b" ".join(words)


def mutated_bytes(rng: Generator, data: bytes) -> bytes:
    """Return bytes with some flipped, a piece cut, doubled or overwritten, or the end missing."""
    content = bytearray(data)
    for _ in range(int(rng.integers(1, 4))):
        size = len(content)
        if size == 0:
            return b""
        at, draw = int(rng.integers(size)), rng.random()
        length = int(rng.integers(1, min(64, size) + 1))
        if draw < 0.45:
            content[at] ^= 1 << int(rng.integers(8))
        elif draw < 0.6:
            content[at : at + length] = rng.bytes(length)
        elif draw < 0.7:
            del content[at : at + length]
        elif draw < 0.8:
            content[at:at] = content[at : at + length]
        elif draw < 0.92:
            width = (1, 2, 4, 8)[int(rng.integers(4))]
            content[at : at + width] = (b"\xff" * width, b"\x00" * width, b"\x7f" + b"\xff" * (width - 1))[
                int(rng.integers(3))
            ]
        else:
            del content[at:]
    return bytes(content)


def gzipped(rng: Generator, data: bytes) -> bytes:
    """Return bytes in a gzip stream, one in three damaged."""
    stream = gzip.compress(data, 1, mtime=0)
    return mutated_bytes(rng, stream) if rng.random() < 0.33 else stream


def bomb(rng: Generator, line: bytes) -> bytes:
    """Return a small gzip stream that says `line` for hundreds of megabytes: the work of a few bytes of the sender."""
    import zlib

    packer = zlib.compressobj(9, zlib.DEFLATED, 31)
    block = line * max(1, 2**20 // max(len(line), 1))
    megabytes = int(rng.integers(200, 400))
    return b"".join([*(packer.compress(block) for _ in range(megabytes)), packer.flush()])


def with_extremes(rng: Generator, values: np.ndarray, share: float) -> np.ndarray:
    """Return numbers of which about `share`, at least one, are extreme."""
    result = np.array(values, dtype=np.float64)
    flat = result.reshape(-1)
    for _ in range(max(1, int(rng.binomial(flat.size, share)))) if flat.size else ():
        flat[int(rng.integers(flat.size))] = extreme_float(rng)
    return result
