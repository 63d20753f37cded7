"""The paper's claims, each with our figure and a verdict that a rule gives."""

from dataclasses import asdict, dataclass
from typing import Any

from ...lab.statistics import Estimate
from .answers import Answers, estimate
from .contestants import FAMILY, PLAIN
from .plan import PATH, POINTS, corridor_name

NEAR = 0.05
"""A share that the paper calls "about p" is confirmed within this."""
SIGNIFICANT = 0.20
"""A success ratio below this is not "significant"."""
LEVEL = 0.90
"""The success ratio at which costs are compared."""
EQUAL = 0.03
"""Success ratios that differ by less are equal."""


@dataclass(frozen=True, kw_only=True)
class Claim:
    """One claim.

    Attributes:
        text: What the paper says.
        paper: Its figure.
        ours: Ours, with its interval.
        verdict: "confirmed", or what came out.
    """

    text: str
    paper: str
    ours: str
    verdict: str

    def to_dict(self) -> dict[str, Any]:
        """Return it as a plain dict."""
        return asdict(self)


def about(ours: Estimate, paper: float, *, merit: bool = True, near: float = NEAR) -> str:
    """Return the verdict on a share: confirmed if its interval meets `paper` +- `near`, else higher or lower.

    A claim of `merit` is confirmed by what is higher, too.
    """
    if ours.low > paper + near:
        return f"confirmed and better, {ours.mean:.0%}" if merit else f"not so: higher, {ours.mean:.0%}"
    if ours.high < paper - near:
        return f"not so: lower, {ours.mean:.0%}"
    return "confirmed"


def paper_claims(answers: Answers) -> list[Claim]:
    """Return all claims whose figures do not depend on the clock."""
    return [
        *_shares(answers),
        *_limits(answers),
        *_searches(answers),
        _iterations(answers),
        *_corridors(answers),
    ]


def timed_claims(answers: Answers) -> list[Claim]:
    """Return the claims about time."""
    claims = []
    for space in ("small", "large"):
        times = answers.needed(space, LEVEL, timed=True)
        fastest = min(times, key=lambda name: times[name])
        claims.append(
            Claim(
                text=f"GLASM-g reaches {LEVEL:.0%} success in less time than PGA ({space} space)",
                paper="always",
                ours=_costs(times, "ms", 2),
                verdict="confirmed" if times["glasm-g"] < times["pga"] else f"not so: {fastest} is the fastest",
            )
        )
    rows = [(answers.on_grid("mbicp", at), answers.on_grid("hglasm-g-small", at)) for at in PATH]
    alone, after = ([row[k]["timing"]["total_ms"]["mean"] for row in rows] for k in (0, 1))
    faster = sum(b < a for a, b in zip(alone, after, strict=True))
    return [
        *claims,
        Claim(
            text="Pre-alignment (small) does not slow matching down, as MbICP gets shorter",
            paper="often",
            ours=f"faster at {faster} of {len(PATH)} errors; at {PATH[0][1]:g} deg {alone[0]:.2f} -> {after[0]:.2f} "
            f"ms, at {PATH[-1][1]:g} deg {alone[-1]:.2f} -> {after[-1]:.2f} ms",
            verdict="confirmed" if 2 * faster > len(PATH) else "not so: the search costs more than it saves",
        ),
    ]


def _shares(answers: Answers) -> list[Claim]:
    near, far = POINTS
    asked = [
        ("HGLASM-g large, 2.12 m and any rotation", "hglasm-g-large", far, 0.90),
        ("HGLASM-g large, 0.57 m and 20 deg", "hglasm-g-large", near, 0.93),
        ("HGLASM-g medium, 0.57 m and 20 deg", "hglasm-g-medium", near, 0.93),
        ("HGLASM-g small, 0.57 m and 20 deg", "hglasm-g-small", near, 0.85),
        ("MbICP alone (ours, robust), 0.57 m and 20 deg", "mbicp", near, 0.20),
        ("MbICP alone (without robust weights), 0.57 m and 20 deg", PLAIN, near, 0.20),
    ]
    claims = []
    for text, matcher, at, paper in asked:
        ours = estimate(answers.at_point(matcher, at)["success"])
        claims.append(
            Claim(
                text=text,
                paper=f"about {paper:.0%}",
                ours=ours.text(100.0, 1) + " %",
                verdict=about(ours, paper, merit=matcher in FAMILY),
            )
        )
    extent = answers.plan.extent
    grid = [(t, r) for t in extent.translations for r in extent.rotations]
    worst = min(grid, key=lambda at: answers.on_grid("hglasm-g-large", at)["success"]["mean"])
    ours = estimate(answers.on_grid("hglasm-g-large", worst)["success"])
    claims.append(
        Claim(
            text="HGLASM-g large, the worst of all errors up to 2.12 m and 180 deg",
            paper="about 90%",
            ours=f"{ours.text(100.0, 1)} % at {worst[0]:g} m, {worst[1]:g} deg",
            verdict=about(ours, 0.90),
        )
    )
    return claims


def _limits(answers: Answers) -> list[Claim]:
    claims = []
    for name, matcher, limit in (
        ("MbICP alone (ours, robust)", "mbicp", 40.0),
        ("MbICP alone (without robust weights)", PLAIN, 40.0),
        ("HGLASM-g small", "hglasm-g-small", 60.0),
        ("HGLASM-g medium", "hglasm-g-medium", 110.0),
    ):
        beyond = [r for r in answers.plan.extent.rotations if r > limit]
        best = max(beyond, key=lambda r: answers.on_grid(matcher, (0.57, r))["success"]["mean"])
        ours = estimate(answers.on_grid(matcher, (0.57, best))["success"])
        claims.append(
            Claim(
                text=f"{name} has no significant success past {limit:g} deg",
                paper=f"below {SIGNIFICANT:.0%}",
                ours=f"at most {ours.text(100.0, 1)} % ({best:g} deg, 0.57 m)",
                verdict="confirmed" if ours.mean < SIGNIFICANT else f"not so: {ours.mean:.0%} at {best:g} deg",
            )
        )
    return claims


def _searches(answers: Answers) -> list[Claim]:
    claims = []
    for space in ("small", "large"):
        needed = answers.needed(space, LEVEL)
        claims.append(
            Claim(
                text=f"GLASM-g takes fewer evaluations than PGA and GLASM to {LEVEL:.0%} success ({space} space)",
                paper="fewer",
                ours=_costs(needed, "evaluations", 0),
                verdict=_fewest(needed),
            )
        )
        last = {name: estimate(answers.searches(name, space)[-1]["success"]) for name in ("glasm", "glasm-g")}
        apart = last["glasm-g"].mean - last["glasm"].mean
        claims.append(
            Claim(
                text=f"GLASM equals GLASM-g where population and generations are high ({space} space)",
                paper="equal",
                ours=", ".join(f"{name} {value.text(100.0, 1)} %" for name, value in last.items()),
                verdict="confirmed" if abs(apart) < EQUAL else f"not so: {100 * apart:+.1f} points",
            )
        )
    return claims


def _iterations(answers: Answers) -> Claim:
    rows = [[estimate(answers.on_grid(m, at)["iterations"]) for m in ("mbicp", "hglasm-g-small")] for at in PATH]
    fewer = sum(after.high < alone.low for alone, after in rows)
    more = sum(after.low > alone.high for alone, after in rows)
    spans = [
        f"{alone.mean:.1f} -> {after.mean:.1f} at {at[1]:g} deg" for at, (alone, after) in zip(PATH, rows, strict=True)
    ]
    verdict = f"not so: fewer at {fewer}, more at {more} of {len(PATH)} errors"
    return Claim(
        text="Pre-alignment (small) reduces the iterations of MbICP",
        paper="typically",
        ours=f"{spans[0]}, {spans[-1]}",
        verdict="confirmed" if 2 * fewer > len(PATH) else verdict,
    )


def _corridors(answers: Answers) -> list[Claim]:
    name = corridor_name("hglasm-g-large", POINTS[1])
    if name not in answers.results:
        return []
    across, along = (estimate(answers.results[name][key]) for key in ("across", "along"))
    return [
        Claim(
            text="In corridors the error across is corrected even from far (large, 2.12 m and any rotation)",
            paper="it is",
            ours=f"across {across.text(100.0, 1)} %, along {along.text(100.0, 1)} %",
            verdict=about(across, LEVEL).replace(" and better", ""),
        )
    ]


def _fewest(needed: dict[str, float]) -> str:
    least = min(needed.values())
    names = [name for name, count in needed.items() if count == least]
    if names == ["glasm-g"]:
        return "confirmed"
    return f"not so: {names[0]} takes fewest" if len(names) == 1 else f"not so: {' and '.join(names)} take as few"


def _costs(costs: dict[str, float], unit: str, digits: int) -> str:
    return (
        ", ".join(f"{name} {value:.{digits}f}" if value < 1e9 else f"{name} never" for name, value in costs.items())
        + f" {unit}"
    )
