"""One training run, from nothing to an exported policy; killed at any time, it goes on from its last checkpoint."""

from collections.abc import Callable
from contextlib import closing
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.logger import Logger, configure

from ...slam.errors import InputError
from ...slam.files.output import made_folder, write_json
from .checkpoint import INDEX, Progress, load_arrays, load_progress, save_checkpoint
from .curriculum import Curriculum
from .evaluation import Evaluation, evaluate
from .export import write_policy
from .imitation import PREFIX, Fit, Imitation
from .model_state import arrays_of_model, restore_adam, restore_model, shapes_of_adam, shapes_of_model
from .models import arrays_of, make_model
from .presets import TrainingPreset
from .reinforcement import TrainingMonitor
from .running import RunClock, RunLimits, TimeUp, settle
from .vec_env import FollowerVecEnv


@dataclass(frozen=True, kw_only=True)
class RunConfig(RunLimits):
    """A run; when its time is up, the best policy so far has been exported.

    Attributes:
        preset: What is trained.
        name: Of the preset, for the card.
    """

    preset: TrainingPreset
    name: str


class TrainingRun:
    """Trains in a folder.

    Args:
        config: What and how long.
        folder: Of checkpoints, demonstrations, TensorBoard, evaluations and the policy.
        tick: Called with a line on the progress.

    Raises:
        InputError: If the folder holds a run of other settings, or what is no checkpoint of this one.
    """

    def __init__(self, config: RunConfig, folder: Path, tick: Callable[[str], None]) -> None:
        self.config, self.folder, self._tick = config, made_folder(folder), tick
        self._preset = config.preset
        settle(self.folder, asdict(self._preset), config.name, config.seed)
        torch.set_num_threads(1)
        self._curriculum = Curriculum(self._preset.curriculum, config.seed)
        self._env = FollowerVecEnv(
            self._preset.reinforcement.num_envs, min(config.workers, self._preset.reinforcement.num_envs),
            self._preset.env, self._preset.pilot, self._preset.rewards, self._curriculum, self._preset.most_steps,
        )  # fmt: skip
        self._model: BaseAlgorithm = make_model(self._preset, self._env, config.seed, None)
        demonstrations = made_folder(self.folder / "demonstrations")
        self._imitation = Imitation(self._preset, config.seed, config.workers, demonstrations)
        self.progress, self._fit = Progress(), Fit()
        self._resume()
        self._log: Logger = configure(str(self.folder / "tensorboard"), ["tensorboard"])
        self._model.set_logger(self._log)
        self._clock = RunClock(self.progress.minutes, config.max_minutes)

    def train(self) -> Progress:
        """Train to the end or until the time is up; return how far it came. The best policy is in the folder."""
        with closing(self._env):
            try:
                self._judge()
                self._imitate()
                self._reinforce()
            except TimeUp:
                self._export_unjudged()
        return self.progress

    def _resume(self) -> None:
        """Go on from the checkpoint in the folder, if there is one."""
        saved = load_progress(self.folder)
        if saved is None:
            return
        self.progress, file = saved
        fit = self._imitation.adam(self._model)
        arrays = load_arrays(file, shapes_of_model(self._model) | shapes_of_adam(PREFIX, fit))
        try:
            self._check_progress()
            restore_model(self._model, arrays)
            restore_adam(PREFIX, fit, arrays)  # checks it; it is set when the round goes on
            self._curriculum.restore(self.progress.curriculum)
        except ValueError as error:
            raise InputError(f"{self.folder / INDEX} and {file.name} are no checkpoint of this run: {error}") from error
        moments = {name: array for name, array in arrays.items() if name.startswith(f"{PREFIX}/")}
        self._fit = Fit(self.progress.passes, self.progress.error, moments)
        if bool(moments) != bool(self._fit.passes):
            raise InputError(f"{file}: needs {PREFIX}/... if, and only if, `passes` of {INDEX} is not 0")

    def _check_progress(self) -> None:
        progress, rounds = self.progress, self._preset.imitation.rounds
        if progress.rounds > rounds:
            raise ValueError(f"`rounds` can be {rounds} at most, got {progress.rounds}")
        most = self._imitation.passes(progress.rounds) if progress.rounds < rounds else 0
        if progress.passes > most:
            raise ValueError(f"`passes` can be {most} at most, got {progress.passes}")

    def _imitate(self) -> None:
        self._clock.check()
        while self.progress.rounds < self._preset.imitation.rounds:
            error = self._imitation.round(self.progress.rounds, self._model, self._told, self._fit, self._keep)
            self.progress.rounds += 1
            self._fit = Fit()
            self._log.record("imitation/error", error)
            self._save(f"imitation {self.progress.rounds}")
            self._judge()

    def _keep(self, fit: Fit) -> None:
        self._fit = fit
        self._save()

    def _reinforce(self) -> None:
        config = self._preset.reinforcement
        left = config.steps - self.progress.steps
        if left <= 0:
            return
        self._clock.check()
        self._model.learn(left, callback=TrainingMonitor(config, self.progress.rollouts, self._after_rollout))
        self._count(self.progress.rollouts + 1)
        self.progress.steps = max(self.progress.steps, config.steps)
        self._save("the end")
        self._judge()

    def _after_rollout(self, rollouts: int) -> None:
        config = self._preset.reinforcement
        self._count(rollouts)
        self._save(f"steps {self.progress.steps}" if rollouts % config.evaluate_every == 0 else "")
        self._told(f"reinforcement: {self.progress.steps}/{config.steps} steps, level {self._curriculum.level + 1}")
        self._judge()

    def _count(self, rollouts: int) -> None:
        config = self._preset.reinforcement
        self.progress.rollouts, self.progress.steps = rollouts, rollouts * config.rollout * config.num_envs

    def _judge(self) -> None:
        """Evaluate if that is due, export the policy if it is the best so far, save."""
        after = self.progress.due
        if not after:
            return
        self._clock.check()
        arrays = arrays_of(self._model)
        result: Evaluation = evaluate(arrays, self._preset, self.config.workers, after, self._told)
        self.progress.evaluations.append(result.to_dict())
        self._log.record("evaluation/return", result.mean_return)
        self._log.record("evaluation/success", result.success)
        self._log.record("curriculum/level", self._curriculum.level)
        try:
            self._log.dump(self.progress.steps or self.progress.rounds)
        except OSError as error:
            raise InputError(f"{self.folder / 'tensorboard'}: cannot be written ({error.strerror})") from error
        if result.mean_return > self.progress.best:
            self.progress.best = result.mean_return
            write_policy(self.folder / "policy", arrays, self._preset.pilot, self._card(result))
        self._save()
        self._told(f"evaluation after {after}: return {result.mean_return:.1f}, tours done {result.success:.2f}")

    def _export_unjudged(self) -> None:
        """Write what there is, if the time is up before a first evaluation told how good it is."""
        learned = self.progress.rounds + self.progress.passes + self.progress.rollouts
        if learned and not self.progress.evaluations:
            write_policy(self.folder / "policy", arrays_of(self._model), self._preset.pilot, self._card(None))

    def _save(self, due: str = "") -> None:
        """Write the checkpoint; `due` says after what an evaluation is to follow, if one is."""
        progress, fit = self.progress, self._fit
        progress.due, progress.passes, progress.error = due, fit.passes, fit.error
        progress.minutes = self._clock.minutes
        progress.curriculum = self._curriculum.state()
        save_checkpoint(self.folder, {**arrays_of_model(self._model), **fit.moments}, progress)
        write_json(self.folder / "evaluations.json", {"evaluations": progress.evaluations})

    def _told(self, line: str) -> None:
        """Tell of the progress, then stop if the time is up; what is told of must be kept already."""
        self._tick(line)
        self._clock.check()

    def _card(self, result: Evaluation | None) -> dict[str, Any]:
        return {
            "algorithm": self._preset.algo,
            "preset": self.config.name,
            "seed": self.config.seed,
            "imitation_rounds": self.progress.rounds,
            "reinforcement_steps": self.progress.steps,
            "minutes": round(self._clock.minutes, 1),
            "evaluation": None if result is None else result.to_dict(),
        }
