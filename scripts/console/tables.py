"""Tables of plain text."""

from collections.abc import Iterable, Sequence


def format_table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table with a line under its header; the first column is aligned left, numbers right, units left."""
    lines = [tuple(header), *(tuple(row) for row in rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(header))]
    left = [i == 0 or not any(line[i][:1].isdigit() for line in lines[1:]) for i in range(len(header))]
    text = ["  ".join(_aligned(line[i], widths[i], left[i]) for i in range(len(header))).rstrip() for line in lines]
    return "\n".join((text[0], "  ".join("-" * width for width in widths), *text[1:]))


def _aligned(word: str, width: int, left: bool) -> str:
    return word.ljust(width) if left else word.rjust(width)
