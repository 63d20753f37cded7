"""Values of options and arguments: numbers, words, lists and what is none of what was asked for."""

from typing import Any

from fuzzer.mutations import EXTREMES, WORDS, choice, extreme_float
from numpy.random import Generator

_WHOLE = (0, 1, 2, 3, -1, 7, 100, 1000, 65536, 10**6, 2**31, 2**63, -(2**63), 10**18, 10**30, 10**400)
_ODD: tuple[Any, ...] = (None, True, False, "", "x", b"x", [], {}, [1], [1.0, 2.0], [None], {"a": 1}, [[1]], "nan")


def hostile_value(rng: Generator, usual: Any = None) -> Any:
    """Return a value for a field: near what is usual, extreme, or of another kind."""
    draw = rng.random()
    if isinstance(usual, bool) and draw < 0.5:
        return bool(rng.random() < 0.5)
    if isinstance(usual, int) and draw < 0.6:
        return _WHOLE[int(rng.integers(len(_WHOLE)))] if draw < 0.3 else usual + int(rng.integers(-2, 3))
    if isinstance(usual, float) and draw < 0.7:
        most = 6.0 if draw < 0.5 else 0.5
        return extreme_float(rng) if draw < 0.3 else usual * float(10.0 ** rng.uniform(-most, most))
    if isinstance(usual, tuple | list) and usual and draw < 0.5:
        return [hostile_value(rng, entry) for entry in usual]
    if draw < 0.8:
        return extreme_float(rng) if rng.random() < 0.5 else _WHOLE[int(rng.integers(len(_WHOLE)))]
    return hostile_word(rng) if draw < 0.9 else _ODD[int(rng.integers(len(_ODD)))]


def hostile_word(rng: Generator) -> str:
    """Return a word of a command line: a number, a path, a sign, an option, something very long."""
    others = ["/dev/zero", "/", ".", "..", "/nowhere/at/all", "a" * 5000]
    others += ["--help", "--", "-1", "x=y", "(" * 300, "[" * 3000 + "]" * 3000, "a\nb", "\udcff"]
    draw = rng.random()
    return choice(rng, EXTREMES if draw < 0.5 else WORDS if draw < 0.7 else others)


def said(value: Any) -> str:
    """Return a value as a word of a command line."""
    return value if isinstance(value, str) else repr(value)[:6000]
