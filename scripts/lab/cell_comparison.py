"""Followers compared cell by cell on the same episodes: tours done and other figures, paired, corrected for many."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from .driven_episodes import FIGURES, MAP_FIGURES
from .statistics import Estimate, Paired, PairedValues, holm, metric_mean, paired_shares, paired_values, share

TITLES = {**MAP_FIGURES, **FIGURES}
"""Figure of an episode -> its name in the report."""
ALL = "all cells"


@dataclass(frozen=True)
class ComparedCell:
    """One cell.

    Attributes:
        name: Of the suite and the cell.
        episodes: How many each follower drove.
        done: Follower -> share of tours done, with Wilson's interval.
        endings: Follower -> ending -> episodes.
        means: Follower -> figure -> mean over the episodes; of the figures that there are.
        paired: Follower -> how its tours done compare with the first's.
        corrected: Follower -> p of that, corrected for the number of cells (Holm).
        paired_figures: Follower -> figure -> how it compares with the first; p is corrected for figures and followers.
    """

    name: str
    episodes: int
    done: dict[str, Estimate]
    endings: dict[str, dict[str, int]]
    means: dict[str, dict[str, Estimate]]
    paired: dict[str, Paired]
    corrected: dict[str, float]
    paired_figures: dict[str, dict[str, PairedValues]]

    def contacts(self, who: str) -> int:
        """Return how many of a follower's episodes ended in a contact."""
        return sum(count for ending, count in self.endings[who].items() if ending.startswith("collision"))

    def to_dict(self) -> dict[str, Any]:
        """Return it as a plain dict."""
        return asdict(self)


def compare_cells(rows: Sequence[Mapping[str, Any]], followers: Sequence[str]) -> list[ComparedCell]:
    """Return the cells in the order of `rows`, and, of several, all of them together at the end.

    Args:
        rows: One an episode: "follower", "suite", "cell", "episode", "ending" and figures of `TITLES`; the same
            episodes of each follower.
        followers: The first is what the others are compared with.
    """
    names = list(dict.fromkeys((row["suite"], row["cell"]) for row in rows))
    parts = [(f"{s}: {c}", [row for row in rows if (row["suite"], row["cell"]) == (s, c)]) for s, c in names]
    made = [_cell(name, part, followers) for name, part in parts]
    corrected = {who: holm([cell.paired[who].p for cell in made]) for who in followers[1:]}
    cells = [
        replace(cell, corrected={who: values[k] for who, values in corrected.items()}) for k, cell in enumerate(made)
    ]
    return cells if len(cells) < 2 else [*cells, _cell(ALL, rows, followers)]


def _cell(name: str, rows: Sequence[Mapping[str, Any]], followers: Sequence[str]) -> ComparedCell:
    by = {who: [row for row in rows if row["follower"] == who] for who in followers}
    done = {who: [row["ending"] == "tour_done" for row in part] for who, part in by.items()}
    values = {who: {key: _values(part, key) for key in TITLES} for who, part in by.items()}
    known = _known(values)
    paired = {who: paired_shares(done[followers[0]], done[who]) for who in followers[1:]}
    return ComparedCell(
        name=name,
        episodes=len(done[followers[0]]),
        done={who: share(flags) for who, flags in done.items()},
        endings={who: _endings(part) for who, part in by.items()},
        means={who: {key: metric_mean(key, figures[key]) for key in known} for who, figures in values.items()},
        paired=paired,
        corrected={who: test.p for who, test in paired.items()},
        paired_figures=_paired_figures(values, known, followers),
    )


def _endings(rows: Sequence[Mapping[str, Any]]) -> dict[str, int]:
    words = [row["ending"] or "out of time" for row in rows]
    return {one: words.count(one) for one in sorted(set(words))}


def _known(values: Mapping[str, Mapping[str, np.ndarray]]) -> list[str]:
    """Return the figures that there are of anybody."""
    return [key for key in TITLES if any(np.isfinite(figures[key]).any() for figures in values.values())]


def _paired_figures(
    values: Mapping[str, Mapping[str, np.ndarray]], known: Sequence[str], followers: Sequence[str]
) -> dict[str, dict[str, PairedValues]]:
    tests = {
        (who, key): paired_values(values[followers[0]][key], values[who][key]) for who in followers[1:] for key in known
    }
    corrected = dict(zip(tests, holm([test.p for test in tests.values()]), strict=True))
    return {
        who: {key: replace(tests[who, key], p=corrected[who, key]) for key in known} for who in followers[1:]
    }  # fmt: skip


def _values(rows: Sequence[Mapping[str, Any]], key: str) -> np.ndarray:
    return np.array([np.nan if row.get(key) is None else float(row[key]) for row in rows])


def report(cells: Sequence[ComparedCell], followers: Sequence[str]) -> str:
    """Return Markdown: tours done with intervals, the paired differences, contacts, and the other figures."""
    first, others, last = followers[0], followers[1:], cells[-1]
    parts = ["# Followers compared", "Tours done, 95 % interval (Wilson):", _table(("cell", "n", *followers), [
        (cell.name, str(cell.episodes), *(cell.done[who].text() for who in followers)) for cell in cells
    ])]  # fmt: skip
    parts += [f"Tours done, less those of {first}; p of McNemar's exact test, corrected for the cells (Holm):"]
    parts += [_table(("cell", *others), [(cell.name, *(_difference(cell, who) for who in others)) for cell in cells])]
    parts += ["Episodes that ended in a contact:"]
    parts += [_table(("cell", *followers), [(c.name, *(str(c.contacts(who)) for who in followers)) for c in cells])]
    parts += [
        f"Means over {last.name}; p of Wilcoxon's signed ranks against {first}, episode by episode, corrected for "
        "figures and followers (Holm):"
    ]
    rows = [(TITLES[key], *(_mean(last, who, key) for who in followers)) for key in last.means[first]]
    parts += [_table(("figure", *followers), rows)]
    for key in last.means[first] if len(cells) > 1 else ():
        told = [(c.name, *(_text(c, who, key) for who in followers)) for c in cells]
        parts += [f"{TITLES[key]}:", _table(("cell", *followers), told)]
    return "\n\n".join(parts) + "\n"


def _difference(cell: ComparedCell, who: str) -> str:
    test = cell.paired[who]
    return f"{test.difference:+.2f} [{test.low:+.2f}, {test.high:+.2f}], p {cell.corrected[who]:.2g}"


def _text(cell: ComparedCell, who: str, key: str) -> str:
    return cell.means[who][key].text(digits=4 if key in MAP_FIGURES else 2) if key in cell.means[who] else "-"


def _mean(cell: ComparedCell, who: str, key: str) -> str:
    text = _text(cell, who, key)
    test = cell.paired_figures.get(who, {}).get(key)
    return text if test is None else f"{text}, p {test.p:.2g}"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
