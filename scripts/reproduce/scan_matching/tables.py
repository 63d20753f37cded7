"""The tables of the report."""

from collections.abc import Mapping, Sequence
from typing import Any

from ..report import Table
from .answers import Answers, percent
from .claims import EQUAL, LEVEL, NEAR, SIGNIFICANT, Claim
from .plan import (
    AXIS_MATCHERS,
    DISTANCES,
    GRID_MATCHERS,
    NOISES,
    PAIR_MATCHERS,
    PATH,
    PEOPLE,
    POINTS,
    POLISHED,
    ROOM_MATCHERS,
    TABLE_ONE,
    TURNS,
    VIEW_MATCHERS,
    corridor_name,
    distance_name,
    view_name,
)
from .searches import ALGORITHMS
from .targets import Row

_PAPER = {
    ("hglasm-g-large", POINTS[0]): "93",
    ("hglasm-g-medium", POINTS[0]): "93",
    ("hglasm-g-small", POINTS[0]): "85",
    ("mbicp", POINTS[0]): "20",
    ("mbicp-plain", POINTS[0]): "20",
    ("hglasm-g-large", POINTS[1]): "90",
}
_ROOMS = {
    "plicp": "0.13 / 0.29 cm, 0.77 ms",
    "icp": "0.14 cm, 1.55 ms, 2 failures of 114",
    "mbicp": "0.18 / 0.47 cm, 3.4 ms",
}
_CONSECUTIVE = {
    ("plicp", False): "0.24",
    ("plicp", True): "0.9-2.4",
    ("mbicp", False): "1.5",
    ("mbicp", True): "5.5-6.2",
}


def claims_table(claims: Sequence[Claim]) -> Table:
    """Return the paper's claims with verdicts."""
    return Table(
        title="The paper's claims",
        columns=("claim", "paper", "ours [95 % interval]", "verdict"),
        rows=[(c.text, c.paper, c.ours, c.verdict) for c in claims],
        note=f'A share "about p" is confirmed where our interval meets p +- {NEAR:.0%}; a ratio below '
        f"{SIGNIFICANT:.0%} is not significant; costs are compared where the pre-alignment succeeds {LEVEL:.0%} of the "
        f"time; ratios within {EQUAL:.0%} are equal; iterations are reduced where intervals of means are apart.",
    )


def targets_table(rows: Sequence[Row]) -> Table:
    """Return what we ask of our matchers."""
    return Table(
        title="What we ask of our matchers",
        columns=("what", "asked", "ours [95 % interval]", "met"),
        rows=[(r["what"], r["asked"], r["ours"], "yes" if r["met"] else "no") for r in rows],
        note="Met where the mean is; the interval says how sure that is.",
    )


def points_table(answers: Answers, simulated: bool) -> Table:
    """Return success and errors at the paper's two points."""
    rows = []
    for at in POINTS:
        for matcher in (*GRID_MATCHERS, *POLISHED):
            found = answers.at_point(matcher, at, simulated)
            before = found["prealigned"]
            rows.append(
                (
                    f"{matcher}, {_error(at)}",
                    _PAPER.get((matcher, at), ""),
                    percent(found["success"]),
                    percent(before) if before is not None else "",
                    _spread(found["error_mm"]),
                    _spread(found["error_deg"]),
                    f"{_ms(found['timing']['total_ms'])} + {_ms(found['timing']['table_ms'])}",
                )
            )
    where = "simulated scans" if simulated else ", ".join(answers.plan.sources)
    return Table(
        title=f"Success and accuracy: {where}, {answers.plan.extent.point_trials} trials a row",
        columns=(
            "matcher, error of the guess",
            "paper [%]",
            "success [%]",
            "pre-aligned [%]",
            "error [mm]: mean +- SD (median, p95)",
            "error [deg]: the same",
            "time [ms], table of it",
        ),
        rows=rows,
        note="Errors of the converged trials. Time: process time of one match from scratch, median.",
    )


def buildings_table(answers: Answers) -> Table:
    """Return success by building."""
    sources = answers.plan.sources
    rows = [
        (f"{matcher}, {_error(at)}", *(percent(answers.at_point(matcher, at)["by_source"][s]) for s in sources))
        for at in POINTS
        for matcher in (*GRID_MATCHERS, *POLISHED)
    ]
    return Table(title="Success by building [%]", columns=("matcher, error of the guess", *sources), rows=rows)


def grid_table(answers: Answers) -> Table:
    """Return the numbers of Figs. 7 and 8."""
    extent = answers.plan.extent
    rows = [
        (
            f"{matcher}, {translation:g} m",
            *(percent(answers.on_grid(matcher, (translation, r))["success"]) for r in extent.rotations),
        )
        for matcher in GRID_MATCHERS
        for translation in extent.translations
    ]
    columns = ("matcher, translation error", *(f"{r:g} deg" for r in extent.rotations))
    return Table(
        title=f"Success over the error of the guess [%], {extent.trials} trials a cell", columns=columns, rows=rows
    )


def search_table(answers: Answers) -> Table:
    """Return the numbers of Figs. 5 and 6."""
    rows = []
    for space, pairs in answers.plan.configurations.items():
        for k, (population, generations) in enumerate(pairs):
            for algorithm in ALGORITHMS:
                found = answers.searches(algorithm, space)[k]
                rows.append(_search_row(f"{space}, {population} x {generations}, {algorithm}", found))
    for size, (population, generations, runs) in TABLE_ONE.items():
        label = f"Table 1: {size}, {population} x {generations} x {runs}, glasm-g"
        rows.append(_search_row(label, answers.results[f"table-1/{size}"]))
    return Table(
        title="Genetic search alone, the guess anywhere in its space",
        columns=(
            "space, population x generations",
            "evaluations",
            "success [%]",
            "median error",
            "search [ms]",
            "table [ms]",
        ),
        rows=rows,
        note="Success: within 0.30 m and 0.1 rad. Times: process time, medians.",
    )


def iterations_table(answers: Answers) -> Table:
    """Return the iterations of MbICP with and without pre-alignment."""
    matchers = ("mbicp-plain", "mbicp", "hglasm-g-small", "hglasm-g-medium", "hglasm-g-large")
    rows = []
    for at in PATH:
        found = [answers.on_grid(m, at) for m in matchers]
        rows.append(
            (
                _error(at),
                *(
                    f"{r['iterations']['mean']:.1f} [{r['iterations']['low']:.1f}, {r['iterations']['high']:.1f}]"
                    for r in found
                ),
                *(f"{r['timing']['total_ms']['mean']:.2f}" for r in found),
            )
        )
    return Table(
        title="Iterations of MbICP, and total time [ms], with and without pre-alignment",
        columns=("error of the guess", *matchers, *(f"{m} [ms]" for m in matchers)),
        rows=rows,
        note="Means over all trials, converged or not; time with the table and the surfaces of the reference.",
    )


def disturbance_table(answers: Answers) -> Table:
    """Return success with noise and with people."""
    columns = ("matcher", "as it is", *(f"noise {n:g} m" for n in NOISES), *(f"{p} people" for p in PEOPLE))
    rows = [
        (
            matcher,
            percent(answers.disturbed(matcher)["success"]),
            *(percent(answers.disturbed(matcher, noise=n)["success"]) for n in NOISES),
            *(percent(answers.disturbed(matcher, people=p)["success"]) for p in PEOPLE),
        )
        for matcher in AXIS_MATCHERS
    ]
    return Table(
        title="Success at 0.57 m and 20 deg with added noise, and with moving people [%]", columns=columns, rows=rows
    )


def corridor_table(answers: Answers) -> Table | None:
    """Return the errors across and along corridors; None without logs."""
    if corridor_name(AXIS_MATCHERS[0], POINTS[0]) not in answers.results:
        return None
    rows, scans = [], 0
    for matcher in AXIS_MATCHERS:
        for at in POINTS:
            found = answers.results[corridor_name(matcher, at)]
            scans = found["scans"]
            rows.append(
                (
                    f"{matcher}, {_error(at)}",
                    percent(found["across"]),
                    percent(found["along"]),
                    f"{found['across_mm']['median']:.1f}, {found['across_mm']['p95']:.1f}",
                    f"{found['along_mm']['median']:.1f}, {found['along_mm']['p95']:.1f}",
                )
            )
    return Table(
        title=f"Corridors apart ({scans} scans of all logs)",
        columns=(
            "matcher, error of the guess",
            "right across [%]",
            "right along [%]",
            "across [mm]: median, p95",
            "along [mm]",
        ),
        rows=rows,
        note="Corridor: the normals of the walls have less than 5 % of their squares in one direction. Right across: "
        "within 0.10 m of the axis and 0.01 rad, either way round; right along: within 0.10 m. Errors over all trials.",
    )


def distance_table(answers: Answers) -> Table:
    """Return success between scans of a drive at growing distances."""
    rows = [
        (m, *(percent(answers.results[distance_name(m, reach)]["success"]) for reach in DISTANCES))
        for m in PAIR_MATCHERS
    ]
    return Table(
        title="Real pairs of Intel at growing distances, no guess: success within 0.20 m and 2 deg [%]",
        note="Turned by less than 45 deg; the matcher is told that the robot stood still.",
        columns=("matcher", *(f"{a:g}-{b:g} m" for a, b in DISTANCES)),
        rows=rows,
    )


def views_table(answers: Answers, building: str) -> Table:
    """Return success between different viewpoints."""
    rows = []
    for matcher in VIEW_MATCHERS:
        found = [answers.results[view_name(building, matcher, turns)] for turns in TURNS]
        rows.append(
            (
                matcher,
                *(percent(r["success"]) for r in found),
                *(percent(r["right_of_believed"]) for r in found),
                f"{found[0]['timing']['total_ms']['median']:.2f}",
            )
        )
    spans = [f"{a:g}-{b:g} deg" for a, b in TURNS]
    return Table(
        title=f"Different viewpoints, {building.capitalize()}: success within 0.20 m and 2 deg [%]",
        columns=("matcher", *spans, *(f"right of believed, {span}" for span in spans), "time [ms]"),
        rows=rows,
        note="Places 0.2 to 2 m apart, the guess up to 1 m off in x and y, with any heading. global scores free space "
        "in a second exact search where the first answer explains the scans worse than each explains itself "
        "(odd beams against even ones).",
    )


def speed_table(answers: Answers) -> Table | None:
    """Return times on consecutive scans and on the pairs of simulated rooms; None without data."""
    rows = []
    for name, found in answers.results.items():
        if name.startswith("consecutive/"):
            _, building, matcher = name.split("/")
            original = _CONSECUTIVE[matcher, found["beams"] > 300]
            rows.append(
                (
                    f"{matcher}, consecutive scans of {building}, {found['beams']} beams",
                    f"{original} ms",
                    f"{found['iterations']['mean']:.1f}",
                    "",
                    "",
                    _both(found["timing"]["total_ms"]),
                )
            )
    for matcher in ROOM_MATCHERS if answers.plan.pairs_file is not None else ():
        found = answers.results[f"rooms/{matcher}"]
        rows.append(
            (
                f"{matcher}, {found['pairs']} pairs of four simulated rooms, 360 beams",
                _ROOMS[matcher],
                f"{found['iterations']['mean']:.1f}",
                f"{found['error_cm']['median']:.3f}, {found['error_cm']['p95']:.3f}",
                f"{found['error_deg']['median']:.3f}, {found['error_deg']['p95']:.3f}",
                _both(found["timing"]["total_ms"]),
            )
        )
    if not rows:
        return None
    return Table(
        title="Speed of the iterative matchers, one core, process time",
        columns=(
            "matcher, scans",
            "originals",
            "iterations",
            "error [cm]: median, p95",
            "error [deg]",
            "time [ms]: median, p95",
        ),
        rows=rows,
        note="Originals: Censi's csm and Minguez' MbICP in C, measured on another machine.",
    )


def degenerate_table(answers: Answers) -> Table:
    """Return what matchers said about scans that say little."""
    found: Mapping[str, Any] = {n.split("/")[1]: r for n, r in answers.results.items() if n.startswith("degenerate/")}
    kinds = tuple(next(iter(found.values()))["kinds"])
    rows = [
        (
            name,
            *(" / ".join(str(r["kinds"][k][key]) for key in ("believed", "blind", "confidently_wrong")) for k in kinds),
        )
        for name, r in found.items()
    ]
    return Table(
        title="Scans that say little or nothing: believed / of those blind / confidently wrong, of 10",
        columns=("matcher", *kinds),
        rows=rows,
        note="Blind: the covariance says that a direction is open, as along a corridor (`Match.is_blind`). Confidently "
        "wrong: believed, and off by more than three of the answer's own standard deviations and 0.10 m or 0.02 rad.",
    )


def _search_row(label: str, found: Mapping[str, Any]) -> tuple[str, ...]:
    return (
        label,
        str(found["evaluations"]),
        percent(found["success"]),
        f"{100 * found['median_m']:.1f} cm, {found['median_deg']:.2f} deg",
        f"{found['timing']['search_ms']['median']:.3f}",
        f"{found['timing']['table_ms']['median']:.3f}",
    )


def _error(at: tuple[float, float | None]) -> str:
    return f"{at[0]:g} m, {'any rotation' if at[1] is None else f'{at[1]:g} deg'}"


def _spread(values: Mapping[str, float | None]) -> str:
    if values["mean"] is None:
        return ""
    return f"{values['mean']:.2f} +- {values['sd']:.2f} ({values['median']:.2f}, {values['p95']:.2f})"


def _ms(values: Mapping[str, float]) -> str:
    return f"{values['median']:.2f}"


def _both(values: Mapping[str, float]) -> str:
    return f"{values['median']:.3f}, {values['p95']:.3f}"
