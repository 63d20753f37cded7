"""`python -m tagalong.scripts.site.learning_curves PICTURE RUN...`: how runs of `tagalong train follower` came on.

Needs the extra `viz`.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...slam.errors import InputError
from ...slam.files.output import read_json
from ..console.last_words import told
from ..figures.plots import new_figure, save_figure

SHOWN = {"success": "tours done", "contacts": "ended in a contact", "lost": "leader lost"}
"""Figure of a row of curve.json -> its name."""


def draw_curves(runs: Sequence[Path], picture: Path) -> Path:
    """Draw the shares of episodes that ended so, over the steps, a line a run.

    Raises:
        InputError: If a folder holds no curve.
        MissingExtraError: If matplotlib is not installed.
    """
    curves = [_curve(run) for run in runs]
    figure = new_figure(10.5, 3.4)
    for place, (name, title) in enumerate(SHOWN.items()):
        axes = figure.add_subplot(1, len(SHOWN), place + 1)
        for rows in curves:
            axes.plot([row["steps"] / 1e6 for row in rows], [row[name] for row in rows], linewidth=1.2)
        axes.set(title=title, xlabel="steps of all worlds [million]", ylim=(0.0, 1.0))
        axes.grid(alpha=0.3)
    return save_figure(picture, figure)


def _curve(run: Path) -> list[dict[str, Any]]:
    file = run / "curve.json"
    content = read_json(file)
    rows = content.get("training") if isinstance(content, dict) else None
    if not rows or not all(isinstance(row, dict) and {"steps", *SHOWN} <= set(row) for row in rows):
        raise InputError(f"{file}: holds no curve of `tagalong train follower` on compiled worlds")
    return rows


def main() -> int:
    """Draw what the command line names."""
    picture, *runs = sys.argv[1:] or [""]
    if not runs:
        raise InputError("needs a picture to write and folders of runs")
    print(draw_curves([Path(run) for run in runs], Path(picture)))
    return 0


if __name__ == "__main__":
    raise SystemExit(told(main))
