"""Tables of the report."""

import numpy as np

from ...lab.statistics import metric_mean, t_mean
from ..report import Table
from .measured import DECIDES, FIGURES, OTHERS, SCALES, Measured
from .rule import METHODS, PAPER, pluses, verdict


def signs_table(measured: Measured) -> Table:
    """Return the plus signs, ours beside the paper's, with the verdict on each cell."""
    rows = []
    for criterion, printed in PAPER.items():
        found = measured.comparisons(criterion)
        ours = pluses(tuple(METHODS), found)
        for guide, title in METHODS.items():
            value = t_mean(measured.burden(guide, criterion), least=0.0)
            others = [o for o in METHODS if o != guide]
            tests = "; ".join(f"{o}: p = {found[guide, o].p:.2g}" for o in others)
            if criterion == "convenience":
                commands = measured.values(guide, "commands").mean()
                words = f"{commands:.0f} commands, {measured.values(guide, 'active_s').mean():.0f} s"
            else:
                words = value.text()
            signs = ("+" * printed[guide], "+" * ours[guide])
            rows.append((criterion, title, *signs, words, tests, verdict(criterion, guide, found)))
    return Table(
        title="Table I of the paper, and ours",
        columns=("criterion", "guide", "paper", "ours", "mean [95 % interval]", "against", "verdict"),
        rows=rows,
        note="Lower is better: commands, then operator's time [s]; time to 90 % of the floor [s]; RMS jerk [m/s3]; "
        "contacts and near misses of a whole job.",
    )


def scenes_table(measured: Measured) -> Table:
    """Return our plus signs in each building, and by other figures."""
    rows = []
    for criterion in DECIDES:
        for scene in measured.scenes:
            ours = pluses(tuple(METHODS), measured.comparisons(criterion, scene))
            rows.append((criterion, scene.replace("_", " "), *("+" * ours[guide] for guide in METHODS)))
        for figure in OTHERS[criterion]:
            ours = pluses(tuple(METHODS), measured.comparisons_by(figure))
            rows.append((criterion, f"all, by {FIGURES[figure][0]}", *("+" * ours[guide] for guide in METHODS)))
    return Table(
        title="The same building by building, and decided by other figures",
        columns=("criterion", "where, by what", *METHODS.values()),
        rows=rows,
    )


def figures_table(measured: Measured, scene: str) -> Table:
    """Return every figure of every guide in one building."""
    rows = []
    for figure, (title, unit, digits) in FIGURES.items():
        cells = []
        for guide in measured.guides:
            values = measured.values(guide, figure, scene)
            estimate = metric_mean(figure, values)
            if not estimate.n:
                cells.append("never" if figure.startswith("time_to") else "-")
                continue
            missing = int(np.isnan(values).sum()) if figure.startswith("time_to") else 0
            censored = f" ({missing} of {len(values)} never)" if missing else ""
            cells.append(estimate.text(SCALES.get(unit, 1.0), digits) + censored)
        rows.append((f"{title} [{unit}]" if unit else title, *cells))
    rows.append(("needs an eye on the robot", *("yes" if guide == "joystick" else "no" for guide in measured.guides)))
    return Table(
        title=f"Every guide in the {scene.replace('_', ' ')}",
        columns=("mean [95 % interval]", *measured.guides),
        rows=rows,
        note="Times are means of the drives that got there; how many never did is said beside.",
    )


def numbers(measured: Measured) -> dict[str, object]:
    """Return the numbers behind the tables."""
    table: dict[str, object] = {}
    for criterion in PAPER:
        found = measured.comparisons(criterion)
        table[criterion] = {
            "paper": PAPER[criterion],
            "ours": pluses(tuple(METHODS), found),
            "verdict": {guide: verdict(criterion, guide, found) for guide in METHODS},
            "p": {f"{a} / {b}": found[a, b].p for a, b in found},
            "ratio_of_means": {f"{a} / {b}": [_or_none(c.low), _or_none(c.high)] for (a, b), c in found.items()},
        }
    means = {
        scene: {
            guide: {figure: metric_mean(figure, measured.values(guide, figure, scene)).to_dict() for figure in FIGURES}
            for guide in measured.guides
        }
        for scene in measured.scenes
    }
    return {"table_1": table, "figures": means}


def lead(measured: Measured) -> str:
    """Return what was found, in a few sentences."""
    verdicts = [verdict(criterion, guide, measured.comparisons(criterion)) for criterion in PAPER for guide in METHODS]
    counts = {word: verdicts.count(word) for word in ("confirmed", "refuted", "not separable")}
    drives, buildings = len(measured.scenes) * len(measured.seeds), len(measured.scenes)
    return (
        f"Of the 12 cells of the paper's Table I, {counts['confirmed']} are confirmed, {counts['refuted']} refuted "
        f"and {counts['not separable']} not separable, on {drives} drives of each guide in {buildings} buildings."
    )


def _or_none(value: float) -> float | None:
    return value if np.isfinite(value) else None
