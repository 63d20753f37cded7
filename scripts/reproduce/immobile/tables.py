"""Tables of the report."""

from collections.abc import Sequence
from typing import Any

from ....slam.immobile.grid import UNKNOWN, moving_lambda, still_lambda
from ...lab.statistics import Estimate
from ..report import Table
from .counted import BOUNDS, GAIN, Counted, CountedShare
from .drives import MAPPERS, METHOD
from .measures import HIDDEN
from .plan import CLEAN, ways_of


def decision_table() -> Table:
    """Return Fig. 2 of the paper as a table."""
    rows = [("walls, tops, other planes", *_words(still_lambda)), ("people, what came or left", *_words(moving_lambda))]
    return Table(
        title="What lambda becomes (the paper's Fig. 2)",
        columns=("what was recognised", "likelihood 0", "0.5", "1"),
        rows=[*rows, ("nothing in particular", *[f"{UNKNOWN:g}"] * 3), ("a ray passed", *[f"{UNKNOWN:g}"] * 3)],
        note="beta = lambda P(O); P(O) is 0.7 of a return and 0.4 where a ray passed.",
    )


def _words(rule: Any) -> list[str]:
    return [f"{float(rule(likelihood)):g}" for likelihood in (0.0, 0.5, 1.0)]


def claims_table(counted: Counted) -> Table:
    """Return what the paper says in words, as numbers of all drives together, for each way to map."""
    rows = []
    errors = {mapper: counted.errors(mapper) for mapper in MAPPERS}
    for name, bound in BOUNDS.items():
        measured = [str(errors[mapper][name]) for mapper in MAPPERS]
        rows.append((name, f"<= {100.0 * bound:g} %", *measured))
    for mark in HIDDEN:
        gains = [_gain(counted.known(mapper, mark)) for mapper in MAPPERS]
        rows.append((f"known area in {mark}, over the laser's", f">= {GAIN:g}", *gains))
    rows.append(
        ("known cells of boxes there that count as free", "-", *[str(counted.wrongly_free(m)) for m in MAPPERS])
    )
    return Table(
        title="The numbers behind the paper's words",
        columns=("all drives together", "asked of immobile", *MAPPERS),
        rows=rows,
        note=_NOTE,
    )


_NOTE = """\
People: occupied cells within 0.35 m of where somebody ever was and more than 0.1 m from things, over those of the
conventional map. Door: cells of the leaf that were occupied when it opened, and for how many it took longer than 2 s
from the first ray through them to their release. Desk tops and seats: cells of which the camera measured a point.
Static: cells that hold a true surface at the laser's height and are occupied in the conventional map, and are not
in this one. A door is watched on two maps only."""


def _gain(share: CountedShare) -> str:
    return f"{share.value:.2f}" if share.whole else "-"


def seeds_table(counted: Counted) -> Table:
    """Return the figures of the method, drive by drive."""
    columns = ("seed", "minutes", "pose error [m]", *BOUNDS, *(f"known {mark}" for mark in HIDDEN), "door, longest [s]")
    rows = []
    for seed in counted.seeds:
        row, errors = counted.row(seed), counted.errors(METHOD, seed=seed)
        longest = counted.door(METHOD, seed)["longest_s"]
        rows.append(
            (
                str(seed),
                f"{row['time_s'] / 60.0:.1f}",
                f"{row['pose_error_m']:.3f}",
                *(str(errors[name]) for name in BOUNDS),
                *(_gain(counted.known(METHOD, mark, seed=seed)) for mark in HIDDEN),
                "-" if longest is None else f"{longest:.1f}",
            )
        )
    return Table(title="The method, drive by drive", columns=columns, rows=rows)


def disturbed_table(counted: Counted, disturbances: Sequence[str]) -> Table:
    """Return the method's errors under each disturbance."""
    rows = []
    for disturbance in disturbances:
        errors = counted.errors(METHOD, disturbance)
        gains = [_gain(counted.known(METHOD, mark, disturbance)) for mark in HIDDEN]
        off = f"{counted.pose_error(disturbance):.3f}"
        rows.append((disturbance, off, *(str(errors[name]) for name in BOUNDS), *gains))
    columns = ("disturbance", "pose error [m]", *BOUNDS, *(f"known {mark}" for mark in HIDDEN))
    return Table(title="Disturbed: the errors, all drives together", columns=columns, rows=rows)


def doubled_table(counted: Counted, disturbances: Sequence[str]) -> Table:
    """Return how each disturbed error compares with the undisturbed one, and by two rules whether it at most doubles.

    The rules were written down before the drives that they judge.
    """
    calm, rows = counted.errors(METHOD), []
    for disturbance in disturbances:
        for name, error in counted.errors(METHOD, disturbance).items():
            rows.append((disturbance, name, *_doubled(calm[name], error, counted.ratio(METHOD, disturbance, name))))
    return Table(
        title="Disturbed: does each error at most double?",
        columns=("disturbance", "error", "as it is", "disturbed", "ratio, its interval", "by share", "by bound"),
        rows=rows,
        note=_DOUBLED_NOTE,
    )


_DOUBLED_NOTE = """\
All drives together. Ratio: of the shares, with its 95 % interval over the drives (Fieller). By share: yes where the
disturbed share is at most twice the other one; where that is 0, a single cell is too many. By bound: yes where the
largest error that the disturbed drives leave believable (upper 95 % bound of Clopper and Pearson) is at most twice
that of the undisturbed ones: of none of n cells, about 3 / n is believable."""


def _doubled(calm: CountedShare, error: CountedShare, ratio: Estimate) -> tuple[str, ...]:
    """Return the last five cells of a row."""
    if not (error.whole and calm.whole):
        return str(calm), str(error), "-", "-", "-"
    words = "-" if ratio.mean != ratio.mean else f"{ratio.mean:.2f}"
    if ratio.low == ratio.low:
        words += f" [{ratio.low:.2f}, {ratio.high:.2f}]"
    by_share, by_bound = error.value <= 2.0 * calm.value + 1e-12, error.bound <= 2.0 * calm.bound
    return str(calm), str(error), words, _verdict(by_share), _verdict(by_bound)


def _verdict(good: bool) -> str:
    return "yes" if good else "NO"


def door_table(counted: Counted) -> Table:
    """Return how soon the opened door left each map."""
    rows = []
    for mapper in ("conventional", METHOD):
        found = [counted.door(mapper, seed) for seed in counted.seeds]
        longest = [door["longest_s"] for door in found if door["longest_s"] is not None]
        rows.append(
            (
                mapper,
                str(sum(door["cells"] for door in found)),
                str(sum(door["within_2_s"] for door in found)),
                str(sum(door["within_2_s_of_looking"] for door in found)),
                str(sum(door["never"] for door in found)),
                f"{max(longest):.1f}" if longest else "-",
            )
        )
    columns = ("map", "cells", "cleared within 2 s", "within 2 s of looking", "never", "longest [s]")
    note = (
        "From the first scan through a cell; of looking: only the time is counted in which scans go through the cell."
    )
    return Table(title="The opened door (c)", columns=columns, rows=rows, note=note)


def lead(counted: Counted) -> str:
    """Return what was found, in a few sentences."""
    errors, plain = counted.errors(METHOD), counted.errors("laser")
    gains = " and ".join(f"{_gain(counted.known(METHOD, mark))} ({mark})" for mark in HIDDEN)
    return (
        f"Of the cells that people leave in the conventional map, the method keeps {errors['people cells left']}. "
        f"It misses {errors['desk top cells missing']} of the desk tops seen and {errors['seat cells missing']} of the "
        f"seats (the laser alone: {plain['desk top cells missing']} and {plain['seat cells missing']}), knows {gains} "
        f"times the area behind screens and boxes, and loses {errors['static cells lost']} of the static cells."
    )


def numbers(counted: Counted, disturbances: Sequence[str]) -> dict[str, Any]:
    """Return the numbers of all tables with 95 % intervals over the drives; ends that are not known are NaN."""
    return {
        disturbance: {mapper: _figures(counted, mapper, disturbance) for mapper in ways_of(disturbance)}
        for disturbance in disturbances
    }


def _figures(counted: Counted, mapper: str, disturbance: str) -> dict[str, Any]:
    figures: dict[str, Any] = {}
    for name, error in counted.errors(mapper, disturbance).items():
        if error.whole:
            estimate = counted.share(mapper, disturbance, name).to_dict()
            figures[name] = {"cells": error.part, "of": error.whole, "believable": error.bound, **estimate}
            if disturbance != CLEAN:
                figures[name]["ratio_to_undisturbed"] = counted.ratio(mapper, disturbance, name).to_dict()
    for mark in HIDDEN:
        if counted.known(mapper, mark, disturbance).whole:
            figures[f"known area in {mark} over the laser's"] = counted.gain(mapper, disturbance, mark).to_dict()
    return figures
