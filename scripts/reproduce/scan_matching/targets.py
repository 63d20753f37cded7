"""What we ask of our matchers, and whether they do it."""

from collections.abc import Callable
from typing import Any

from ...lab.statistics import Estimate, paired_shares
from .answers import Answers, estimate
from .contestants import SUFFIX
from .plan import POINTS, TURNS, view_name
from .real_pairs import AT_TRUTH

Row = dict[str, Any]


def targets(answers: Answers) -> list[Row]:
    """Return rows (what, asked, ours, met) of what does not depend on the clock."""
    return [*_successes(answers), *_global(answers), *_views(answers), *_degenerate(answers)]


def _successes(answers: Answers) -> list[Row]:
    near, far = POINTS
    rows = []
    for matcher, at, least, key in (
        ("hglasm-g-large", near, 0.93, "success"),
        ("hglasm-g-medium", near, 0.93, "success"),
        ("hglasm-g-small", near, 0.86, "success"),
        ("hglasm-g-large", far, 0.92, "success"),
        ("hglasm-g-large", near, 0.98, "prealigned"),
        ("hglasm-g-medium", near, 0.98, "prealigned"),
        ("hglasm-g-large" + SUFFIX, near, 0.975, "success"),
        ("hglasm-g-medium" + SUFFIX, near, 0.975, "success"),
        ("hglasm-g-large" + SUFFIX, far, 0.975, "success"),
        ("global", near, 0.985, "success"),
        ("global", far, 0.985, "success"),
    ):
        ours = estimate(answers.at_point(matcher, at)[key])
        what = f"{matcher}, {key}, {at[0]:g} m and {'any rotation' if at[1] is None else f'{at[1]:g} deg'}"
        rows.append(_row(what, f">= {100 * least:g} %", ours, lambda mean, least=least: mean >= least))
    return rows


def _global(answers: Answers) -> list[Row]:
    rows = []
    for at in POINTS:
        result = answers.at_point("global", at)
        point = f"{at[0]:g} m and {'any rotation' if at[1] is None else f'{at[1]:g} deg'}"
        for what, key, unit, median, p95 in (
            ("", "error_mm", "mm", 2.5, 8.0),
            ("heading ", "error_deg", "deg", 0.05, 0.2),
        ):
            found = result[key]
            low, high = found["p95_interval"] or (float("nan"), float("nan"))
            rows.append(
                {
                    "what": f"global, {what}error, {point}",
                    "asked": f"median <= {median:g}, p95 <= {p95:g} {unit}",
                    "ours": f"{found['median']:.3f}, {found['p95']:.3f} [{low:.3f}, {high:.3f}] {unit}",
                    "met": found["median"] <= median and found["p95"] <= p95,
                }
            )
        large = estimate(answers.at_point("hglasm-g-large", at)["success"])
        ours = estimate(result["success"])
        rows.append(
            _row(f"global, {point}", f"no worse than large, {large.mean:.1%}", ours, lambda m, a=large: m >= a.mean)
        )
    exact = [value for name, value in answers.results.items() if name.startswith("exact/")]
    equal, trials = sum(r["equal"] for r in exact), sum(r["trials"] for r in exact)
    views = sum(r["equal_views"] for r in exact)
    rows.append(
        {
            "what": "global finds what trying every pose finds, to the bit (first and second search)",
            "asked": "always",
            "ours": f"{equal} and {views} of {trials}",
            "met": equal == views == trials,
        }
    )
    return rows


def _views(answers: Answers) -> list[Row]:
    rows = []
    for building in answers.plan.views:
        ours, at_truth = (answers.results[view_name(building, m, TURNS[0])] for m in ("global", AT_TRUTH))
        paired = paired_shares(at_truth["right"], ours["right"])
        what = f"global, {building}, views that differ by less than 45 deg"
        share = 100.0 * estimate(at_truth["success"]).mean
        rows.append(
            {
                "what": f"{what}, less PL-ICP from the reference",
                "asked": f"as good as its {share:.1f} %, by McNemar's test",
                "ours": f"{100 * paired.difference:+.1f} [{100 * paired.low:+.1f}, {100 * paired.high:+.1f}] %, "
                f"p = {paired.p:.2g}, n = {paired.n} ({paired.only_second} won, {paired.only_first} lost)",
                "met": paired.difference >= 0.0 or paired.p >= 0.05,
            }
        )
        if building == "aces":
            rows.append(_row(what, ">= 88 %", estimate(ours["success"]), lambda mean: mean >= 0.88))
    return rows


def _degenerate(answers: Answers) -> list[Row]:
    found = {name.split("/")[1]: r for name, r in answers.results.items() if name.startswith("degenerate/")}
    asked = sum(r["trials"] * len(r["kinds"]) for r in found.values())
    total = {
        key: sum(kind[key] for r in found.values() for kind in r["kinds"].values())
        for key in ("believed", "blind", "confidently_wrong", "finite")
    }
    return [
        {
            "what": "scans that say little or nothing: confidently wrong answers, all matchers",
            "asked": "none, all finite",
            "ours": f"{total['confidently_wrong']} of {asked}, {total['finite']} finite",
            "met": total["confidently_wrong"] == 0 and total["finite"] == asked,
        },
        {
            "what": "scans that say little or nothing: believed answers that say which direction is open",
            "asked": "all",
            "ours": f"{total['blind']} of {total['believed']}",
            "met": total["blind"] == total["believed"],
        },
    ]


def _row(what: str, asked: str, ours: Estimate, met: Callable[[float], bool]) -> Row:
    return {"what": what, "asked": asked, "ours": ours.text(100.0, 1) + " %", "met": bool(met(ours.mean))}
