"""Imitation: the policy learns to wish what the teacher wishes, on the ways that the policy itself comes to."""

import warnings
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3.common.base_class import BaseAlgorithm

from ...slam.errors import InputError
from ...slam.files.output import read_arrays, replacing
from .curriculum import draw_episode
from .drives import DriveTask, drive_all
from .extractor import statistics_of
from .model_state import Arrays, arrays_of_adam, restore_adam
from .models import actor_parts, arrays_of, mean_output
from .presets import TrainingPreset

Table = dict[str, NDArray[np.floating]]
"""`labels` (n, 2) and the inputs of the network (n, ...), one row a step."""

PREFIX = "fit"
"""Of the names of the arrays that Adam remembers in a fit."""


@dataclass(frozen=True, eq=False)
class Fit:
    """How far the fit of a round is.

    Attributes:
        passes: Over all that was gathered.
        error: Mean squared error of the last one.
        moments: What Adam remembers after it, as `arrays_of_adam` names it, after `PREFIX`.
    """

    passes: int = 0
    error: float = 0.0
    moments: Arrays = field(default_factory=dict)


class Imitation:
    """DAgger, round by round: drive, let the teacher say what it would have done, fit to all that was said so far.

    The drives have no guard and a brisker steering: the policy comes to see, and learns to leave, what both prevent.

    Args:
        preset: What is driven and fitted.
        seed: Of all draws.
        workers: Processes that drive.
        folder: Where the rounds' tables are kept, `round_K.npz`; a round that is there already is not driven again. Of
            a round that is not yet complete it holds the drives, `round_K_drive_I.npz`.
    """

    def __init__(self, preset: TrainingPreset, seed: int, workers: int, folder: Path) -> None:
        self._preset, self._seed, self._workers, self._folder = preset, seed, workers, folder

    def round(
        self,
        number: int,
        model: BaseAlgorithm,
        tick: Callable[[str], None],
        begun: Fit | None = None,
        keep: Callable[[Fit], None] = lambda _: None,
    ) -> float:
        """Do round `number`, which counts from 0, with `model`; return the mean squared error of the last pass.

        What is done is kept drive by drive and pass by pass: a round that was killed goes on to the same end.

        Args:
            number: Rounds before it must have been done.
            model: Its policy drives and learns.
            tick: Called with a line on the progress, when what it tells of is kept; what it raises ends the round.
            begun: How far its fit is already; then `model` must be what it was there.
            keep: Called after each pass.

        Raises:
            InputError: If a table in the folder is none of such a run.
        """
        if not self._table_file(number).is_file():
            self._drive(number, model, tick)
        tables = [self._read(k) for k in range(number + 1)]
        joined = {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}
        if number == 0:
            actor_parts(model)[0].set_statistics(statistics_of(joined))
        return self._fit(number, model, joined, begun or Fit(), keep, tick)

    def adam(self, model: BaseAlgorithm) -> torch.optim.Adam:
        """Return a new optimiser of the fit, over what drives in `model`."""
        parameters = [p for part in actor_parts(model) for p in part.parameters()]
        return torch.optim.Adam(parameters, lr=self._preset.imitation.learning_rate)

    def passes(self, number: int) -> int:
        """Return over how many passes the fit of a round goes."""
        config = self._preset.imitation
        return config.last_epochs if number + 1 == config.rounds else config.epochs

    def _drive(self, number: int, model: BaseAlgorithm, tick: Callable[[str], None]) -> None:
        config, tasks = self._preset.imitation, self._tasks(number, model)
        parts = [self._folder / f"round_{number}_drive_{k}.npz" for k in range(len(tasks))]
        missing = [k for k, part in enumerate(parts) if not part.is_file()]
        with closing(drive_all([tasks[k] for k in missing], self._workers)) as coming:
            for done, (k, one) in enumerate(zip(missing, coming, strict=True), len(tasks) - len(missing) + 1):
                _write(parts[k], {**one.inputs, "labels": one.labels})
                told = one.ending or "cut"
                tick(f"imitation round {number + 1}/{config.rounds}: drive {done}/{len(tasks)}, {told}")
        tables = [_checked_table(part, self._preset) for part in parts]
        _write(self._table_file(number), {name: np.concatenate([t[name] for t in tables]) for name in tables[0]})
        for part in parts:
            part.unlink()

    def _tasks(self, number: int, model: BaseAlgorithm) -> list[DriveTask]:
        config, preset = self._preset.imitation, self._preset
        rng = np.random.default_rng((self._seed, 1, number))
        most = preset.curriculum.bystanders
        return [
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

    def _fit(
        self,
        number: int,
        model: BaseAlgorithm,
        table: Table,
        begun: Fit,
        keep: Callable[[Fit], None],
        tick: Callable[[str], None],
    ) -> float:
        config, epochs = self._preset.imitation, self.passes(number)
        optimizer = self.adam(model)
        batches = -(-len(table["labels"]) // config.batch)
        schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, epochs * batches, 0.1 * config.learning_rate)
        restore_adam(PREFIX, optimizer, begun.moments)
        rng, error = np.random.default_rng((self._seed, 2, number)), begun.error
        _pass_over(begun.passes, len(table["labels"]), batches, rng, schedule)
        seen = self._preset.pilot.features.vector_names.index("leader seen")
        for epoch in range(begun.passes, epochs):
            order, total = rng.permutation(len(table["labels"])), 0.0
            for k in range(batches):
                rows = np.sort(order[k * config.batch : (k + 1) * config.batch])
                total += _fit_batch(model, table, rows, seen, config.lost_weight, optimizer) * len(rows)
                schedule.step()
            error = total / len(order)
            keep(Fit(epoch + 1, error, arrays_of_adam(PREFIX, optimizer)))
            tick(f"imitation round {number + 1}/{config.rounds}: pass {epoch + 1}/{epochs}, error {error:.4f}")
        return error

    def _table_file(self, number: int) -> Path:
        return self._folder / f"round_{number}.npz"

    def _read(self, number: int) -> Table:
        return _checked_table(self._table_file(number), self._preset)


def _pass_over(
    passes: int,
    rows: int,
    batches: int,
    rng: np.random.Generator,
    schedule: torch.optim.lr_scheduler.LRScheduler,
) -> None:
    """Bring draws and learning rate to where they were after so many passes: the rate by the same sums, to the bit."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # torch misses the steps of the optimiser, which were taken before
        for _ in range(passes):
            rng.permutation(rows)
            for _ in range(batches):
                schedule.step()


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


def _write(file: Path, table: Table) -> None:
    with replacing(file) as temporary:
        np.savez_compressed(temporary, allow_pickle=False, **table)


def _checked_table(file: Path, preset: TrainingPreset) -> Table:
    """Return a table, or raise InputError if it is none of such a run."""
    table = read_arrays(file)
    most = preset.imitation.drives * preset.imitation.most_steps
    shapes = {**preset.pilot.features.shapes, "labels": (2,)}
    if set(table) != set(shapes):
        raise InputError(f"{file}: needs the arrays {', '.join(sorted(shapes))}; got {', '.join(sorted(table))[:200]}")
    rows = len(table["labels"]) if table["labels"].ndim else 0
    if not 0 < rows <= most:
        raise InputError(f"{file}: needs 1 to {most} rows, as many as steps are driven in a round; got {rows}")
    for name, shape in shapes.items():
        array = table[name]
        if array.shape != (rows, *shape) or array.dtype not in (np.float16, np.float32):
            raise InputError(f"{file}: {name} must be floats {(rows, *shape)}, got {array.dtype} {array.shape}")
        if not np.isfinite(array).all():
            raise InputError(f"{file}: {name} has values that are not finite numbers")
    return table
