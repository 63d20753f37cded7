"""Imitation: the policy learns to wish what the teacher wishes, on the ways that the policy itself comes to."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3.common.base_class import BaseAlgorithm

from ...slam.files import replacing
from .curriculum import draw_episode
from .drives import Drive, DriveTask, drive_all
from .extractor import statistics_of
from .models import actor_parts, arrays_of, mean_output
from .presets import TrainingPreset

Table = dict[str, NDArray[np.floating]]
"""`labels` (n, 2) and the inputs of the network (n, ...), one row a step."""


class Imitation:
    """DAgger, round by round: drive, let the teacher say what it would have done, fit to all that was said so far.

    The drives have no guard and a brisker steering: the policy comes to see, and learns to leave, what both prevent.

    Args:
        preset: What is driven and fitted.
        seed: Of all draws.
        workers: Processes that drive.
        folder: Where the rounds' tables are kept, `round_K.npz`; a round that is there already is not driven again.
    """

    def __init__(self, preset: TrainingPreset, seed: int, workers: int, folder: Path) -> None:
        self._preset, self._seed, self._workers, self._folder = preset, seed, workers, folder

    def round(self, number: int, model: BaseAlgorithm, tick: Callable[[str], None]) -> float:
        """Do round `number`, which counts from 0, with `model`; return the mean squared error of the last pass.

        Args:
            number: Rounds before it must have been done.
            model: Its policy drives and learns.
            tick: Called with a line on the progress.
        """
        table_file = self._folder / f"round_{number}.npz"
        if not table_file.is_file():
            self._drive(number, model, table_file, tick)
        tables = [_read(self._folder / f"round_{k}.npz") for k in range(number + 1)]
        joined = {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}
        if number == 0:
            actor_parts(model)[0].set_statistics(statistics_of(joined))
        return self._fit(number, model, joined, tick)

    def _drive(self, number: int, model: BaseAlgorithm, target: Path, tick: Callable[[str], None]) -> None:
        config, preset = self._preset.imitation, self._preset
        rng = np.random.default_rng((self._seed, 1, number))
        most = preset.curriculum.bystanders
        tasks = [
            DriveTask(
                drawn=draw_episode(rng, preset.curriculum, most[-1] if number else most[0]),
                env={**preset.env, **preset.fine} if k % 2 else preset.env,
                pilot=replace(preset.pilot, guard=None, steering=config.steering),
                policy=arrays_of(model) if number else None,
                teacher_share=config.teacher_share * 0.5**number,
                noise=config.noise,
                most_steps=config.most_steps,
            )
            for k in range(config.drives)
        ]
        drives: list[Drive] = []
        for one in drive_all(tasks, self._workers):
            drives.append(one)
            done = sum(drive.done for drive in drives)
            tick(f"imitation round {number + 1}/{config.rounds}: drive {len(drives)}/{len(tasks)}, tours done {done}")
        table: Table = {name: np.concatenate([drive.inputs[name] for drive in drives]) for name in drives[0].inputs}
        table["labels"] = np.concatenate([drive.labels for drive in drives])
        with replacing(target) as temporary:
            np.savez_compressed(temporary, allow_pickle=False, **table)

    def _fit(self, number: int, model: BaseAlgorithm, table: Table, tick: Callable[[str], None]) -> float:
        config = self._preset.imitation
        last = number + 1 == config.rounds
        epochs = config.last_epochs if last else config.epochs
        parameters = [p for part in actor_parts(model) for p in part.parameters()]
        optimizer = torch.optim.Adam(parameters, lr=config.learning_rate)
        batches = -(-len(table["labels"]) // config.batch)
        schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, epochs * batches, 0.1 * config.learning_rate)
        rng, error = np.random.default_rng((self._seed, 2, number)), 0.0
        seen = self._preset.pilot.features.vector_names.index("leader seen")
        for epoch in range(epochs):
            order, total = rng.permutation(len(table["labels"])), 0.0
            for k in range(batches):
                rows = np.sort(order[k * config.batch : (k + 1) * config.batch])
                total += _fit_batch(model, table, rows, seen, config.lost_weight, optimizer) * len(rows)
                schedule.step()
            error = total / len(order)
            tick(f"imitation round {number + 1}/{config.rounds}: pass {epoch + 1}/{epochs}, error {error:.4f}")
        return error


def _fit_batch(
    model: BaseAlgorithm,
    table: Table,
    rows: NDArray[np.intp],
    seen: int,
    lost_weight: float,
    optimizer: torch.optim.Optimizer,
) -> float:
    """Take one step; return the mean squared error of the batch."""
    inputs = {
        name: torch.as_tensor(array[rows].astype(np.float32)) for name, array in table.items() if name != "labels"
    }
    wished = torch.as_tensor(np.clip(table["labels"][rows], -0.99, 0.99).astype(np.float32))
    weight = torch.where(inputs["vector"][:, seen] > 0.5, 1.0, lost_weight)
    loss = (weight[:, None] * (mean_output(model, inputs) - wished) ** 2).mean()
    optimizer.zero_grad()
    loss.backward()
    optimizer.step()
    return float(loss.detach())


def _read(file: Path) -> Table:
    with np.load(file, allow_pickle=False) as arrays:
        return {name: arrays[name] for name in arrays.files}
