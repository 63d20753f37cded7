"""Followers compared cell by cell on the same episodes: shares of done tours, paired, and corrected for many cells."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from .statistics import Estimate, Paired, holm, metric_mean, paired_shares, share

MEANS = {
    "jerk_rms_mps3": "jerk RMS [m/s3]",
    "distance_error_rms_m": "distance error RMS [m]",
    "personal_space_compliance": "personal space kept",
}
"""Figure of an episode -> its name in the report."""
ALL = "all cells"


@dataclass(frozen=True)
class ComparedCell:
    """One cell.

    Attributes:
        name: Of the suite and the cell.
        episodes: How many each follower drove.
        done: Follower -> share of tours done, with Wilson's interval.
        contacts: Follower -> episodes that ended in a contact.
        means: Follower -> figure -> mean over the episodes.
        paired: Follower -> how it compares with the first.
        corrected: Follower -> p of that, corrected for the number of cells (Holm).
    """

    name: str
    episodes: int
    done: dict[str, Estimate]
    contacts: dict[str, int]
    means: dict[str, dict[str, Estimate]]
    paired: dict[str, Paired]
    corrected: dict[str, float]

    def to_dict(self) -> dict[str, Any]:
        """Return it as a plain dict."""
        return asdict(self)


def compare_cells(rows: Sequence[Mapping[str, Any]], followers: Sequence[str]) -> list[ComparedCell]:
    """Return the cells in the order of `rows`, and, of several, all of them together at the end.

    Args:
        rows: One an episode: "follower", "suite", "cell", "episode", "ending" and the figures `MEANS`; the same
            episodes of each follower.
        followers: The first is what the others are compared with.
    """
    names = list(dict.fromkeys((row["suite"], row["cell"]) for row in rows))
    parts = [(f"{s}: {c}", [row for row in rows if (row["suite"], row["cell"]) == (s, c)]) for s, c in names]
    made = [_cell(name, part, followers) for name, part in parts]
    corrected = {who: holm([cell.paired[who].p for cell in made]) for who in followers[1:]}
    cells = [
        ComparedCell(**{**vars(cell), "corrected": {who: values[k] for who, values in corrected.items()}})
        for k, cell in enumerate(made)
    ]
    return cells if len(cells) < 2 else [*cells, _cell(ALL, rows, followers)]


def _cell(name: str, rows: Sequence[Mapping[str, Any]], followers: Sequence[str]) -> ComparedCell:
    by = {who: [row for row in rows if row["follower"] == who] for who in followers}
    done = {who: [row["ending"] == "tour_done" for row in part] for who, part in by.items()}
    paired = {who: paired_shares(done[followers[0]], done[who]) for who in followers[1:]}
    return ComparedCell(
        name=name,
        episodes=len(done[followers[0]]),
        done={who: share(values) for who, values in done.items()},
        contacts={who: sum(row["ending"].startswith("collision") for row in part) for who, part in by.items()},
        means={who: {key: metric_mean(key, _values(part, key)) for key in MEANS} for who, part in by.items()},
        paired=paired,
        corrected={who: test.p for who, test in paired.items()},
    )


def _values(rows: Sequence[Mapping[str, Any]], key: str) -> list[float]:
    return [np.nan if row[key] is None else float(row[key]) for row in rows]


def report(cells: Sequence[ComparedCell], followers: Sequence[str]) -> str:
    """Return Markdown: tours done with intervals, the paired differences, and the other figures."""
    first, others = followers[0], followers[1:]
    parts = ["# Followers compared", "Tours done, 95 % interval (Wilson):", _table(("cell", "n", *followers), [
        (cell.name, str(cell.episodes), *(cell.done[who].text() for who in followers)) for cell in cells
    ])]  # fmt: skip
    parts += [f"Tours done, less those of {first}; p of McNemar's exact test, corrected for the cells (Holm):"]
    parts += [_table(("cell", *others), [(cell.name, *(_difference(cell, who) for who in others)) for cell in cells])]
    parts += ["Episodes that ended in a contact:"]
    parts += [_table(("cell", *followers), [(c.name, *(str(c.contacts[who]) for who in followers)) for c in cells])]
    for key, title in MEANS.items():
        parts += [f"{title}:"]
        rows = [(c.name, *(c.means[who][key].text() for who in followers)) for c in cells]
        parts += [_table(("cell", *followers), rows)]
    return "\n\n".join(parts) + "\n"


def _difference(cell: ComparedCell, who: str) -> str:
    test = cell.paired[who]
    return f"{test.difference:+.2f} [{test.low:+.2f}, {test.high:+.2f}], p {cell.corrected[who]:.2g}"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
