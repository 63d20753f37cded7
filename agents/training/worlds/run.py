"""One run of reinforcement on compiled worlds, from nothing to an exported policy; killed, it goes on."""

from collections import deque
from collections.abc import Callable
from contextlib import closing
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from shlex import quote
from typing import Any

import numpy as np
import torch
from torch import Tensor

from ....envs.task.endings import REASONS
from ....envs.task.interface import FollowInterface
from ....slam.errors import InputError
from ....slam.files.output import made_folder, write_json
from ...reinforced.policy import ReinforcedConfig
from ..checkpoint import INDEX, Progress, load_arrays, load_progress, save_checkpoint
from ..model_state import Arrays, Shapes, arrays_of_adam, restore_adam, shapes_of_adam
from ..running import RunClock, RunLimits, TimeUp, settle
from .export import policy_arrays, write_policy
from .ppo import Learner, Rollout
from .preset import WorldsPreset, preset_for
from .tensor_worlds import Outcome, TensorWorlds

CHECKPOINT_EVERY = 10
"""Rollouts; half a minute of work."""
_RECENT = 400
"""At least so many episodes, where there were so many, are those of which the share of done tours is told."""
DEVICES = "cpu", "cuda"


@dataclass(frozen=True, kw_only=True)
class WorldsRunConfig(RunLimits):
    """A run; the policy is the same for any number of workers.

    Attributes:
        preset: What is trained.
        device: "cpu", or "cuda" for worlds and networks on a GPU.
    """

    preset: WorldsPreset
    device: str = "cpu"


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
        self._worlds = TensorWorlds(self._preset, config.seed, config.workers, config.device)
        self._learner = Learner(self._preset, config.seed, config.device)
        self.progress, self._figures_of_rollout = Progress(), {}
        self._resume()
        self._recent: deque[EndedEpisodes] = deque()
        self._clock = RunClock(self.progress.minutes, config.max_minutes)

    def train(self) -> Progress:
        """Train to the end or until the time is up; return how far it came. The policy is in the folder."""
        with closing(self._worlds):
            if self.progress.steps < self._preset.steps:
                self._tick("drawing buildings")
                try:
                    self._learn()
                except TimeUp:
                    self._save()
        return self.progress

    def _learn(self) -> None:
        """Drive and learn by turns."""
        told, truth = self._worlds.reset(self.config.seed + 7919 * self.progress.rollouts)
        returns = torch.zeros(len(told), device=told.device)
        while self.progress.steps < self._preset.steps:
            share = self.progress.steps / self._preset.steps
            self._worlds.begin_share(share)
            rollout, tally = self._rollout(told, truth, share), EndedEpisodes.of(told.device)
            for t in range(self._preset.rollout):
                outcome = self._worlds.step(self._learner.explore(rollout, t))
                rollout.put(t, outcome)
                returns = tally.count(outcome, returns)
            told, truth = rollout.told[-1], rollout.truth[-1]
            self._figures_of_rollout = self._learner.learn(rollout, share)
            self._note(tally)
            self.progress.rollouts += 1
            self.progress.steps += self._preset.rollout * self._preset.worlds
            if self.progress.rollouts % CHECKPOINT_EVERY == 0 or self.progress.steps >= self._preset.steps:
                self._save()
            self._clock.check()

    def _rollout(self, told: Tensor, truth: Tensor, share: float) -> Rollout:
        return Rollout.of(self._preset.rollout, told, truth, self._preset.deviation_at(share))

    def _note(self, tally: "EndedEpisodes") -> None:
        """Take note of the episodes of a rollout, and forget those that are long past."""
        self._recent.append(tally)
        while sum(one.episodes for one in self._recent) - self._recent[0].episodes >= _RECENT:
            self._recent.popleft()

    def _save(self) -> None:
        """Write checkpoint, curve and policy."""
        progress = self.progress
        progress.minutes = self._clock.minutes
        if sum(one.episodes for one in self._recent):
            progress.evaluations.append(self._figures())
        save_checkpoint(self.folder, self._arrays(), progress)
        write_json(self.folder / "curve.json", {"training": progress.evaluations})
        interface = FollowInterface()
        config = ReinforcedConfig(
            pooled=self._preset.pooled,
            steering=self._preset.steering,
            guard=self._preset.guard,
            max_speed=interface.max_speed,
            max_turn_rate=interface.max_turn_rate,
        )
        write_policy(self.folder / "policy", policy_arrays(self._learner.model.actor), config, self._card())

    def _figures(self) -> dict[str, Any]:
        """Return how the last episodes went, as explored; tell it."""
        endings = [sum(int(one.endings[code]) for one in self._recent) for code in range(len(REASONS))]
        n = sum(endings)
        share = {reason: endings[code] / n for code, reason in enumerate(REASONS)}
        done, contacts = share["tour_done"], share["collision_person"] + share["collision_static"]
        row = {
            "after": f"steps {self.progress.steps}",
            "mean_return": round(sum(float(one.returns) for one in self._recent) / n / self._preset.reward_scale, 4),
            "success": round(done, 4),
            "returns": [],
            "contacts": round(contacts, 4),
            "lost": round(share["leader_lost"], 4),
            "steps": self.progress.steps,
            **{name: round(value, 6) for name, value in self._figures_of_rollout.items()},
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
            "command": self._command(),
            **told,
            "made_with": {name: version(name) for name in ("numpy", "numba", "torch")},
            "settings": asdict(self._preset),
        }

    def _command(self) -> str:
        """Return the command that makes the same again."""
        usual, ours = preset_for(self.config.device).env, self._preset.env
        changed = [f"--set {quote(f'{name}={value}')}" for name, value in ours.items() if usual.get(name) != value]
        first = f"tagalong train follower --device {self.config.device} --seed {self.config.seed}"
        return " ".join((first, f"--steps {self._preset.steps}", *changed))

    def _resume(self) -> None:
        """Go on from the checkpoint in the folder, if there is one; the episodes that follow are other ones."""
        saved = load_progress(self.folder)
        if saved is None:
            return
        self.progress, file = saved
        arrays = load_arrays(file, self._shapes())
        try:
            for name, tensor in self._learner.model.state_dict().items():
                if f"model/{name}" not in arrays:
                    raise ValueError(f"array model/{name} is missing")
                tensor.copy_(torch.from_numpy(arrays[f"model/{name}"]))
            restore_adam("adam", self._learner.optimizer, arrays)
        except ValueError as error:
            raise InputError(f"{self.folder / INDEX} and {file.name} are no checkpoint of this run: {error}") from error
        self._learner.begin_draws((self.config.seed + 7919 * self.progress.rollouts) % (1 << 32))

    def _arrays(self) -> Arrays:
        model = self._learner.model.state_dict()
        arrays = {f"model/{name}": np.array(tensor.cpu().numpy(), order="C") for name, tensor in model.items()}
        return arrays | arrays_of_adam("adam", self._learner.optimizer)

    def _shapes(self) -> Shapes:
        model = self._learner.model.state_dict()
        shapes = {f"model/{name}": tuple(tensor.shape) for name, tensor in model.items()}
        return shapes | shapes_of_adam("adam", self._learner.optimizer)


@dataclass
class EndedEpisodes:
    """Episodes that ended in a rollout.

    Attributes:
        endings: (REASONS,) how many by each reason, the first for those that were cut.
        returns: Sum of their returns.
    """

    endings: Tensor
    returns: Tensor

    @staticmethod
    def of(device: torch.device) -> "EndedEpisodes":
        """Return one of nothing."""
        return EndedEpisodes(torch.zeros(len(REASONS), dtype=torch.long, device=device), torch.zeros((), device=device))

    @property
    def episodes(self) -> int:
        """How many."""
        return int(self.endings.sum())

    def count(self, outcome: Outcome, returns: Tensor) -> Tensor:
        """Count the episodes that ended in a step; return (n,) the returns so far of those that go on."""
        returns = returns + outcome.reward
        self.endings += torch.bincount(outcome.ending[outcome.over], minlength=len(REASONS))
        self.returns += returns[outcome.over].sum()
        return torch.where(outcome.over, 0.0, returns)
