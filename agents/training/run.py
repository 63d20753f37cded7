"""One training run, from nothing to an exported policy; killed at any time, it goes on from its last checkpoint."""

import json
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.logger import Logger, configure

from ...slam.errors import InputError
from ...slam.files import made_folder, write_json
from .checkpoint import Progress, load_checkpoint, load_model, save_checkpoint
from .curriculum import Curriculum
from .evaluation import Evaluation, evaluate
from .export import write_policy
from .imitation import Imitation
from .models import arrays_of, make_model
from .presets import TrainingPreset
from .reinforcement import Watch
from .vec_env import FollowerVecEnv


@dataclass(frozen=True, kw_only=True)
class RunConfig:
    """A run.

    Attributes:
        preset: What is trained.
        name: Of the preset, for the card.
        seed: Of all draws.
        workers: Processes that drive.
        max_minutes: Time after which the best policy so far is exported; None trains to the end.
    """

    preset: TrainingPreset
    name: str
    seed: int = 0
    workers: int = 1
    max_minutes: float | None = None

    def __post_init__(self) -> None:
        if self.workers < 1 or (self.max_minutes is not None and not self.max_minutes > 0.0):
            raise InputError(f"a run needs workers >= 1 and minutes > 0, got {self.workers} and {self.max_minutes}")


class TrainingRun:
    """Trains in a folder.

    Args:
        config: What and how long.
        folder: Of checkpoints, demonstrations, TensorBoard, evaluations and the policy.
        tick: Called with a line on the progress.

    Raises:
        InputError: If the folder holds a run of other settings.
    """

    def __init__(self, config: RunConfig, folder: Path, tick: Callable[[str], None]) -> None:
        self.config, self.folder, self._tick = config, made_folder(folder), tick
        self._preset = config.preset
        self._settle()
        torch.set_num_threads(1)
        self._curriculum = Curriculum(self._preset.curriculum, config.seed)
        self._env = FollowerVecEnv(
            self._preset.reinforcement.num_envs, min(config.workers, self._preset.reinforcement.num_envs),
            self._preset.env, self._preset.pilot, self._preset.rewards, self._curriculum, self._preset.most_steps,
        )  # fmt: skip
        saved = load_checkpoint(self.folder)
        if saved is None:
            self.progress = Progress()
            self._model: BaseAlgorithm = make_model(self._preset, self._env, config.seed, None)
        else:
            self.progress, file = saved
            self._model = load_model(self._preset.algo, file, self._env)
            self._curriculum.restore(self.progress.curriculum)
        self._log: Logger = configure(str(self.folder / "tensorboard"), ["tensorboard"])
        self._model.set_logger(self._log)
        self._began, self._before = time.monotonic(), self.progress.minutes

    def train(self) -> Progress:
        """Train to the end or until the time is up; return how far it came. The best policy is in the folder."""
        try:
            self._imitate()
            self._reinforce()
        finally:
            self._env.close()
        return self.progress

    def _settle(self) -> None:
        settings = {"preset": asdict(self._preset), "name": self.config.name, "seed": self.config.seed}
        file = self.folder / "settings.json"
        plain = json.loads(json.dumps(settings))
        if file.is_file() and json.loads(file.read_text()) != plain:
            raise InputError(f"{self.folder} holds a run of other settings: give another --out, or the same settings")
        write_json(file, plain)

    def _imitate(self) -> None:
        demonstrations = made_folder(self.folder / "demonstrations")
        imitation = Imitation(self._preset, self.config.seed, self.config.workers, demonstrations)
        while self.progress.rounds < self._preset.imitation.rounds and not self._late():
            error = imitation.round(self.progress.rounds, self._model, self._tick)
            self.progress.rounds += 1
            self._log.record("imitation/error", error)
            self._judge(f"imitation {self.progress.rounds}", self.progress.rounds)

    def _reinforce(self) -> None:
        config = self._preset.reinforcement
        left = config.steps - self.progress.steps
        if left <= 0 or self._late() or self.progress.rounds < self._preset.imitation.rounds:
            return
        self._model.learn(left, callback=Watch(config, self.progress.rollouts, self._after_rollout))
        self._judge("the end", self.progress.steps)

    def _after_rollout(self, rollouts: int) -> bool:
        config = self._preset.reinforcement
        self.progress.rollouts = rollouts
        self.progress.steps = rollouts * config.rollout * config.num_envs
        late = self._late()
        self._tick(f"reinforcement: {self.progress.steps}/{config.steps} steps, level {self._curriculum.level + 1}")
        if rollouts % config.evaluate_every == 0:
            self._judge(f"steps {self.progress.steps}", self.progress.steps)
        else:
            self._save()
        return not late

    def _judge(self, after: str, step: int) -> None:
        """Evaluate, export the policy if it is the best so far, save."""
        arrays = arrays_of(self._model)
        result: Evaluation = evaluate(arrays, self._preset, self.config.workers, after)
        self.progress.evaluations.append(result.to_dict())
        self._log.record("evaluation/return", result.mean_return)
        self._log.record("evaluation/success", result.success)
        self._log.record("curriculum/level", self._curriculum.level)
        self._log.dump(step)
        self._tick(f"evaluation after {after}: return {result.mean_return:.1f}, tours done {result.success:.2f}")
        if result.mean_return > self.progress.best:
            self.progress.best = result.mean_return
            write_policy(self.folder / "policy", arrays, self._preset.pilot, self._card(result))
        self._save()

    def _save(self) -> None:
        self.progress.minutes = self._minutes()
        self.progress.curriculum = self._curriculum.state()
        save_checkpoint(self.folder, self._model, self.progress)
        write_json(self.folder / "evaluations.json", {"evaluations": self.progress.evaluations})

    def _card(self, result: Evaluation) -> dict[str, Any]:
        return {
            "algorithm": self._preset.algo,
            "preset": self.config.name,
            "seed": self.config.seed,
            "imitation_rounds": self.progress.rounds,
            "reinforcement_steps": self.progress.steps,
            "minutes": round(self._minutes(), 1),
            "evaluation": result.to_dict(),
        }

    def _minutes(self) -> float:
        return self._before + (time.monotonic() - self._began) / 60.0

    def _late(self) -> bool:
        return self.config.max_minutes is not None and self._minutes() >= self.config.max_minutes
