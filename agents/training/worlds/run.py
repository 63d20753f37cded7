"""One run of reinforcement on compiled worlds, from nothing to an exported policy; killed, it goes on."""

from collections import Counter, deque
from collections.abc import Callable
from contextlib import closing
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import Logger
from torch import nn

from ....envs.task.interface import FollowInterface
from ....slam.errors import InputError
from ....slam.files.output import made_folder, write_json
from ...reinforced.policy import ReinforcedConfig
from ..checkpoint import INDEX, Progress, load_arrays, load_progress, save_checkpoint
from ..model_state import arrays_of_model, restore_model, shapes_of_model
from ..running import RunClock, RunLimits, TimeUp, settle
from .export import policy_arrays, write_policy
from .preset import WorldsPreset
from .vec_env import WorldsVecEnv

CHECKPOINT_EVERY = 10
"""Rollouts; half a minute of work."""
_RECENT = 400
"""Episodes of which the share of done tours is told."""
_LEAST_RATE = 0.1


@dataclass(frozen=True, kw_only=True)
class WorldsRunConfig(RunLimits):
    """A run; the policy is the same for any number of workers.

    Attributes:
        preset: What is trained.
    """

    preset: WorldsPreset


class WorldsRun:
    """Trains in a folder.

    Args:
        config: What and how long.
        folder: Of checkpoints, curve and policy.
        tick: Called with a line on the progress.

    Raises:
        InputError: If the folder holds a run of other settings, or what is no checkpoint of this one.
    """

    def __init__(self, config: WorldsRunConfig, folder: Path, tick: Callable[[str], None]) -> None:
        self.config, self.folder, self._tick = config, made_folder(folder), tick
        self._preset = config.preset
        settle(self.folder, asdict(self._preset), "worlds", config.seed)
        torch.set_num_threads(1)  # sums of several threads are not the same bytes
        self._env = WorldsVecEnv(self._preset, config.seed, config.workers)
        self._model = _model(self._preset, self._env, config.seed)
        self._model.set_logger(Logger(None, []))  # its own would leave an empty folder in /tmp
        self.progress = Progress()
        self._resume()
        self._recent: deque[tuple[str, float, int]] = deque(maxlen=_RECENT)
        self._clock = RunClock(self.progress.minutes, config.max_minutes)

    def train(self) -> Progress:
        """Train to the end or until the time is up; return how far it came. The policy is in the folder."""
        left = self._preset.steps - self.progress.steps
        with closing(self._env):
            if left > 0:
                self._tick("drawing buildings")
                try:
                    self._model.learn(left, callback=_Monitor(self), reset_num_timesteps=False)
                    self.count()
                except TimeUp:
                    self._save()
        return self.progress

    def count(self) -> None:
        """Take note of a rollout that was learned from."""
        self.progress.rollouts += 1
        self.progress.steps = self._model.num_timesteps
        if self.progress.rollouts % CHECKPOINT_EVERY == 0 or self.progress.steps >= self._preset.steps:
            self._save()
        self._clock.check()

    def begin_rollout(self) -> None:
        """Drive the next rollout as the preset wants it now."""
        self._env.begin_share(self._model.num_timesteps / self._preset.steps)

    def note(self, infos: list[dict[str, Any]]) -> None:
        """Take note of the episodes that have ended."""
        ended = (info for info in infos if "ending" in info)
        self._recent.extend((info["ending"], info["episode"]["r"], info["episode"]["l"]) for info in ended)

    def _save(self) -> None:
        """Write checkpoint, curve and policy."""
        progress = self.progress
        progress.minutes = self._clock.minutes
        if self._recent:
            progress.evaluations.append(self._figures())
        save_checkpoint(self.folder, arrays_of_model(self._model), progress)
        write_json(self.folder / "curve.json", {"training": progress.evaluations})
        interface = FollowInterface()
        config = ReinforcedConfig(
            pooled=self._preset.pooled,
            steering=self._preset.steering,
            max_speed=interface.max_speed,
            max_turn_rate=interface.max_turn_rate,
        )
        write_policy(self.folder / "policy", policy_arrays(self._model.policy), config, self._card())

    def _figures(self) -> dict[str, Any]:
        """Return how the last episodes went, as explored; tell it."""
        endings = Counter(ending for ending, _, _ in self._recent)
        n = len(self._recent)
        done = endings["tour_done"] / n
        contacts = (endings["collision_person"] + endings["collision_static"]) / n
        row = {
            "after": f"steps {self.progress.steps}",
            "mean_return": round(sum(r for _, r, _ in self._recent) / n, 4),
            "success": round(done, 4),
            "returns": [],
            "contacts": round(contacts, 4),
            "lost": round(endings["leader_lost"] / n, 4),
            "steps": self.progress.steps,
        }
        line = f"tours done {done:.2f}, contacts {contacts:.2f} of the last {n} episodes, explorations included"
        self._tick(f"{self.progress.steps}/{self._preset.steps} steps: {line}")
        return row

    def _card(self) -> dict[str, Any]:
        curve = self.progress.evaluations
        told = {"seed": self.config.seed, "steps": self.progress.steps, "training": curve[-1] if curve else None}
        return {
            "algorithm": "ppo",
            "preset": "worlds",
            "command": f"tagalong train follower --seed {self.config.seed} --steps {self._preset.steps}",
            **told,
            "made_with": {name: version(name) for name in ("numpy", "stable_baselines3", "torch")},
            "settings": asdict(self._preset),
        }

    def _resume(self) -> None:
        """Go on from the checkpoint in the folder, if there is one; the episodes that follow are other ones."""
        saved = load_progress(self.folder)
        if saved is None:
            return
        self.progress, file = saved
        arrays = load_arrays(file, shapes_of_model(self._model))
        try:
            restore_model(self._model, arrays)
        except ValueError as error:
            raise InputError(f"{self.folder / INDEX} and {file.name} are no checkpoint of this run: {error}") from error
        self._model.num_timesteps = self.progress.steps
        self._model.set_random_seed((self.config.seed + 7919 * self.progress.rollouts) % (1 << 32))
        self._env.begin_with(self.config.seed + self.progress.rollouts)


class _Monitor(BaseCallback):
    """Hands the run each end of an episode, and each rollout that was learned from."""

    def __init__(self, run: WorldsRun) -> None:
        super().__init__()
        self._run, self._learned = run, False

    def _on_rollout_start(self) -> None:
        if self._learned:
            self._run.count()
        self._learned = True
        self._run.begin_rollout()

    def _on_step(self) -> bool:
        self._run.note(self.locals["infos"])
        return True


def _model(preset: WorldsPreset, env: WorldsVecEnv, seed: int) -> PPO:
    """Return a new model: actor and critic of their own, the learning rate in a line to a tenth."""
    width = [preset.width] * 2
    policy = {
        "net_arch": {"pi": width, "vf": width},
        "activation_fn": nn.Tanh,
        "log_std_init": preset.log_deviation,
    }
    return PPO(
        "MlpPolicy", env, n_steps=preset.rollout, batch_size=preset.batch, n_epochs=preset.epochs, gamma=preset.gamma,
        gae_lambda=preset.gae_lambda, learning_rate=lambda left: preset.learning_rate * max(left, _LEAST_RATE),
        policy_kwargs=policy, device="cpu", seed=seed,
    )  # fmt: skip
