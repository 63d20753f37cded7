"""Many environments at once, on several processes.

The processes are what makes it fast: tracker and people are Python, which one process runs on one core only. MuJoCo's
own batch (`mujoco.batch.Batch`) was tried for physics and rays and is not used: on one core, in an office with 6
people, `Batch.step` took 5.7 us a step where `mj_step` takes 5.5, and `Batch.ray` 257 us for 360 beams where
`mj_multiRay` takes 194; physics is 3 % of an environment's step; and it asks for the same number of geoms in every
building. The calling process, which would only wait, steps a share itself: on two cores that gives 1.15 times the steps
of two processes beside it. A process steps its environments in stages (`slam.processes.stages`), which takes about two
thirds of the time of one after the other.
"""

import multiprocessing as mp
import os
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from ...slam.errors import InputError, WorkerError, shown
from ...slam.processes.crew import require_workers
from ...slam.processes.inside import answered
from ...slam.processes.supervised import SILENT_S, Worker, end_all
from ..episode_setup import interface
from ..follow_config import FollowConfig
from ..follow_env import FollowEnv
from ..limits.field_checks import finite_numbers
from .arguments import chosen_by, each_seed
from .worker import Rows, WorkerShare, asked, joined, split, stacked, worker_share

Flags = NDArray[np.bool_]
MOST_ENVS = 4096
"""At 20 MB and more each they fill the memory of a large machine."""


class FollowVectorEnv(VectorEnv[Any, Any, Any]):
    """`num_envs` environments like `FollowEnv`, equal to single ones step by step.

    `gymnasium.make_vec("tagalong/Office-v0", num_envs=8, vectorization_mode="vector_entry_point", workers=2, ...)`.
    Environment i of `reset(seed=s)` has the seed s + i, as in Gymnasium's own vector environments.

    Args:
        num_envs: How many environments.
        workers: Processes that share them, the calling one included; None takes one a core, at most `num_envs`.
        max_episode_steps: Steps after which an episode is truncated; None never. `make_vec` takes that of the id.
        autoreset_mode: When an ended episode is followed by the next: "NextStep" (the step after returns the first
            observation of the next, its action is ignored), "SameStep" (`final_obs` and `final_info` in `info` hold
            the end), "Disabled".
        context: How processes start: "fork", "forkserver", "spawn"; None takes the platform's way. Functions among the
            arguments reach forks whatever they are; the other ways need functions of a module that can be imported.
        silent_s: Time without a sign of life after which a process counts as lost [s]; they give one every second,
            but not while they start, for which each has a minute at least.
        fields: Keyword arguments of `FollowEnv`.

    Raises:
        InputError: If a number is not positive or an argument of `FollowEnv` is wrong.
        WorkerError: Later, by any method: if a process is gone, or gives no sign of life. The others are ended then.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        workers: int | None = None,
        max_episode_steps: int | None = None,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        context: str | None = None,
        silent_s: float = SILENT_S,
        **fields: Any,
    ) -> None:
        workers = min(num_envs, os.cpu_count() or 1) if workers is None else workers
        if num_envs < 1 or not 1 <= workers <= num_envs:
            raise InputError(f"need 1 <= `workers` <= `num_envs`, got {workers} and {num_envs}")
        require_workers(workers, "`workers`")
        if num_envs > MOST_ENVS:
            raise InputError(f"`num_envs` must not exceed {MOST_ENVS}, which take over 80 GB already, got {num_envs}")
        if not 2.0 <= silent_s <= 86_400.0:
            raise InputError(f"`silent_s` must lie in [2, 86400] s: signs of life come every second; got {silent_s}")
        single = FollowEnv(**fields)
        if workers > 1:
            _require_passing(single.config, context)
        self.config = single.config
        self.interface = interface(single.config)
        self.num_envs = num_envs
        self.render_mode = single.render_mode
        self.metadata = {**single.metadata, "autoreset_mode": AutoresetMode(autoreset_mode)}
        self.single_observation_space, self.single_action_space = single.observation_space, single.action_space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._last: dict[str, NDArray[Any]] | None = None
        self._shares = [part.tolist() for part in np.array_split(np.arange(num_envs), workers)]
        rest = self.metadata["autoreset_mode"], max_episode_steps, fields
        self._workers = []  # the last share is no larger than the others: this process has to batch, too
        for k, share in enumerate(self._shares[:-1]):
            name, arguments = f"worker {k + 1} of {workers - 1}", (len(share), *rest)
            self._workers.append(Worker(name, worker_share, arguments, context=context, silent_s=silent_s))
        self._own = WorkerShare(len(self._shares[-1]), *rest)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start episodes in all environments, or in those of `options["reset_mask"]` (num_envs,).

        Args:
            seed: Of the first environment, or one for each.
            options: As of `FollowEnv`.

        Raises:
            InputError: If a seed for each, the mask or an option is wrong, or not all begin at first.
        """
        seeds = each_seed(seed, self.num_envs)
        wanted = dict(options or {})
        mask = chosen_by(wanted.pop("reset_mask", None), self.num_envs, begun=self._last is not None)
        tasks = [([seeds[i] for i in part], wanted, [bool(mask[i]) for i in part]) for part in self._shares]
        results = [result for results in self._ask("reset", tasks) for result in results]
        infos: dict[str, Any] = {}
        for i, result in enumerate(results):
            if result is not None:
                infos = self._add_info(infos, result[1], i)
        fresh = stacked([result[0] for result in results if result is not None])
        if self._last is not None and not mask.all():
            fresh = {key: self._place(self._last[key], fresh[key], mask) for key in fresh}
        self._last = fresh
        return {key: values.copy() for key, values in fresh.items()}, infos

    def step(self, actions: Any) -> tuple[Any, NDArray[np.float64], Flags, Flags, dict[str, Any]]:
        """Drive all environments for one control period; `actions` (num_envs, a).

        Raises:
            InputError: If an action is missing, too many, of another shape or not finite; then nobody has moved.
        """
        wanted = finite_numbers(actions)
        if wanted is not None and wanted.ndim > 0 and len(wanted) != self.num_envs:
            raise InputError(f"needs an action for each of the {self.num_envs} environments, got {len(wanted)}")
        if wanted is None or wanted.shape != self.action_space.shape:
            raise InputError(f"actions have shape {self.action_space.shape} and are finite, got {shown(actions)}")
        shares: list[Rows] = self._ask("step", [(wanted[part],) for part in self._shares])
        self._last = {
            key: np.concatenate([share.observations[key] for share in shares]) for key in shares[0].observations
        }
        rewards, terminated, truncated = (
            np.concatenate([getattr(share, name) for share in shares])
            for name in ("rewards", "terminated", "truncated")
        )
        observations = {key: values.copy() for key, values in self._last.items()}
        return observations, rewards, terminated, truncated, self._infos(shares)

    def _infos(self, shares: list[Rows]) -> dict[str, Any]:
        """Return the infos of all environments as Gymnasium batches them."""
        tables = [share.columns for share in shares if share.columns is not None]
        infos = joined(tables, self.num_envs) if len(tables) == len(shares) else None
        if infos is not None:
            return infos
        infos, i = {}, 0
        for share in shares:
            alike = split(share.columns or {}, len(share.rewards))
            for info, last, last_info in share.infos or [(row, None, None) for row in alike]:
                if last_info is not None:
                    infos = self._add_info(infos, {"final_obs": last, "final_info": last_info}, i)
                infos = self._add_info(infos, info, i)
                i += 1
        return infos

    def render(self) -> tuple[Any, ...]:
        """Return a picture of each environment; None of each without a render mode."""
        return tuple(image for images in self._ask("render", [()] * len(self._shares)) for image in images)

    def close_extras(self, **kwargs: Any) -> None:
        """End the processes, within a few seconds whatever they do."""
        end_all(self._workers)

    def _ask(self, name: str, tasks: list[tuple[Any, ...]]) -> list[Any]:
        """Let every process do its part at the same time, this one too; return results in the order of the shares."""
        try:
            for worker, task in zip(self._workers, tasks[:-1], strict=True):
                worker.ask((name, task))
            own = answered(partial(asked, self._own), (name, tasks[-1]))
            answers = [*(worker.answer() for worker in self._workers), own]
        except WorkerError:
            end_all(self._workers, at_once=True)
            raise
        for _, error in answers:
            if error is not None:
                raise error
        return [result for result, _ in answers]

    @staticmethod
    def _place(old: NDArray[Any], fresh: NDArray[Any], mask: Flags) -> NDArray[Any]:
        """Return `old` (num_envs, ...) with the rows of `mask` replaced by `fresh`."""
        placed = old.copy()
        placed[mask] = fresh
        return placed


def _require_passing(config: FollowConfig, context: str | None) -> None:
    """Raise InputError unless the functions of a configuration reach processes that start in the way `context`.

    What a fork needs is there already. The other ways send a function by its name, which a lambda and a function within
    a function have not.
    """
    method = mp.get_context(context).get_start_method()
    functions = {f"`reward.terms[{name!r}]`": function for name, function in config.reward.terms.items()}
    functions |= {f"`observation.entries[{name!r}]`": entry[1] for name, entry in config.observation.entries.items()}
    for name, function in {"`slam`": config.slam, **functions}.items():
        if method != "fork" and "<" in getattr(function, "__qualname__", ""):
            rule = f'must be a function of a module to reach processes that start by "{method}"'
            raise InputError(f"{name} {rule}, got {shown(function)}")
