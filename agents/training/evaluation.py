"""How good a policy is: episodes on held-out seeds, driven by the arrays as they will be shipped."""

from collections.abc import Callable
from contextlib import closing
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from .curriculum import held_out
from .drives import Arrays, DriveTask, TeacherDrive, drive_all
from .presets import TrainingPreset


@dataclass(frozen=True)
class Evaluation:
    """One evaluation.

    Attributes:
        after: What had been done, e.g. "imitation 3" or "steps 40960".
        mean_return: Mean over the episodes of the sum of the environment's rewards.
        success: Share of tours that were done.
        returns: The sum of each episode.
    """

    after: str
    mean_return: float
    success: float
    returns: tuple[float, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return it as a plain dict."""
        return {**asdict(self), "returns": list(self.returns)}


def evaluate(
    arrays: Arrays, preset: TrainingPreset, workers: int, after: str, tick: Callable[[str], None] = lambda _: None
) -> Evaluation:
    """TeacherDrive the preset's held-out episodes, the same ones every time.

    Args:
        arrays: Of the policy, as `learned.network` names them.
        preset: What is driven.
        workers: Processes that drive.
        after: What had been done.
        tick: Called with a line after each episode; what it raises ends the evaluation.
    """
    tasks = [
        DriveTask(
            drawn=drawn,
            env={**preset.env, **preset.fine},
            pilot=preset.pilot,
            policy=arrays,
            teach=False,
            most_steps=preset.most_steps,
        )
        for drawn in held_out(preset.curriculum, preset.evaluations)
    ]
    drives: list[TeacherDrive] = []
    with closing(drive_all(tasks, workers)) as coming:
        for one in coming:
            drives.append(one)
            tick(f"evaluating after {after}: episode {len(drives)}/{len(tasks)}")
    returns = tuple(round(one.total_reward, 6) for one in drives)
    return Evaluation(after, float(np.mean(returns)), float(np.mean([one.done for one in drives])), returns)
