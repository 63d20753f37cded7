"""Checkpoints of a training run: what SIGKILL leaves behind is always whole."""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.vec_env.base_vec_env import VecEnv

from ...slam.files import replacing, write_json
from .models import CLASSES

_INDEX = "checkpoint.json"


@dataclass
class Progress:
    """How far a run is.

    Attributes:
        rounds: Rounds of imitation that are done.
        steps: Steps of reinforcement that are done.
        rollouts: Rollouts of reinforcement that are done.
        minutes: Time spent, over all starts of the run.
        best: The best mean return of an evaluation so far.
        evaluations: All evaluations so far.
        curriculum: State of the curriculum.
    """

    rounds: int = 0
    steps: int = 0
    rollouts: int = 0
    minutes: float = 0.0
    best: float = float("-inf")
    evaluations: list[dict[str, Any]] = field(default_factory=list)
    curriculum: dict[str, Any] = field(default_factory=dict)


def save_checkpoint(folder: Path, model: BaseAlgorithm, progress: Progress) -> None:
    """Write the model, then the index that points to it, then drop the model before."""
    name = f"model_{progress.rounds}_{progress.rollouts}.zip"
    with replacing(folder / name) as temporary:  # it may have the name of the one before
        model.save(temporary)
    best = None if progress.best == float("-inf") else progress.best
    write_json(folder / _INDEX, {**progress.__dict__, "best": best, "model": name})
    for old in folder.glob("model_*.zip"):
        if old.name != name:
            old.unlink()


def load_checkpoint(folder: Path) -> tuple[Progress, Path] | None:
    """Return how far the run in `folder` is, and the file of its model; None if it has none."""
    if not (folder / _INDEX).is_file():
        return None
    content = json.loads((folder / _INDEX).read_text())
    model = folder / content.pop("model")
    best = content.pop("best")
    return Progress(best=float("-inf") if best is None else best, **content), model


def load_model(algo: str, file: Path, env: VecEnv) -> BaseAlgorithm:
    """Return the model of a user's own run; its file holds pickles, so nothing else is ever loaded by this."""
    return CLASSES[algo].load(file, env=env, device="cpu")
