"""Equations of a page, written as LaTeX in fences called `math`, as MathML, which browsers show by themselves."""

import re

from ...slam.errors import MissingExtraError

_FENCE = re.compile(r"^```math\n(.*?)^```$", flags=re.S | re.M)


def with_equations(text: str) -> str:
    """Return a page whose fences `math` are MathML.

    Raises:
        MissingExtraError: If there is one and `latex2mathml` is not installed.
    """
    return _FENCE.sub(lambda found: _mathml(found[1]), text)


def _mathml(latex: str) -> str:
    try:
        from latex2mathml.converter import convert  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise MissingExtraError("the equations of the documentation", "docs") from None
    lines = [line for line in latex.strip().splitlines() if line.strip()]
    shown = "".join(f'<div class="equation">{convert(line, display="block")}</div>' for line in lines)
    return f'<div class="equations">{shown}</div>'
