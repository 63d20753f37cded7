"""What all training runs share: their limits, the settings in their folder, and the time that they have taken."""

import json
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...slam.errors import InputError, shown
from ...slam.files.output import read_json, write_json

MOST_WORKERS = 64
"""Processes or threads that drive; a process takes about 300 MB, and no round has more drives to share out."""
LONGEST_MIN = 1e6  # two years; whoever wants no limit leaves it out


class TimeUp(Exception):
    """The time of the run is up."""


@dataclass(frozen=True, kw_only=True)
class RunLimits:
    """Seed and limits of a run.

    Attributes:
        seed: Of all draws.
        workers: Processes or threads that drive.
        max_minutes: Time after which the run stops, within a drive or a rollout, evaluations included; what was learned
            has been exported then. None trains to the end.
    """

    seed: int = 0
    workers: int = 1
    max_minutes: float | None = None

    def __post_init__(self) -> None:
        if not 1 <= self.workers <= MOST_WORKERS:
            raise InputError(f"a run needs 1 to {MOST_WORKERS} workers, got {shown(self.workers)}")
        if not 0 <= self.seed < 1 << 32:
            raise InputError(f"a run's seed is a whole number from 0 to {(1 << 32) - 1}, got {shown(self.seed)}")
        if self.max_minutes is not None and not 0.0 < self.max_minutes <= LONGEST_MIN:
            raise InputError(f"a run needs minutes above 0, at most {LONGEST_MIN:g}, got {self.max_minutes:g}")


class RunClock:
    """The time of a run, over all its starts.

    Args:
        before: Minutes that earlier starts have taken.
        most: Minutes after which it is up; None never.
    """

    def __init__(self, before: float, most: float | None) -> None:
        self._before, self._most, self._began = before, most, time.monotonic()

    @property
    def minutes(self) -> float:
        """Minutes taken so far."""
        return self._before + (time.monotonic() - self._began) / 60.0

    def check(self) -> None:
        """Raise `TimeUp` if it is."""
        if self._most is not None and self.minutes >= self._most:
            raise TimeUp


def settle(folder: Path, preset: dict[str, Any], name: str, seed: int) -> None:
    """Write the settings of a run into its folder.

    Raises:
        InputError: If a run of other settings is there.
    """
    plain = json.loads(json.dumps({"preset": preset, "name": name, "seed": seed}))
    file = folder / "settings.json"
    if file.is_file() and read_json(file) != plain:
        raise InputError(f"{folder} holds a run of other settings: give another --out, or the same settings")
    write_json(file, plain)
