"""Many worlds in one compiled call, as a Gymnasium vector environment."""

import logging
import os
import threading
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from ...slam.errors import InputError, shown
from ...slam.first_use.compiling import compiled_together
from ...slam.processes.threads import MOST_THREADS, Workers
from ...slam.processes.turns import Turns, turns
from ..episode_setup import check_options, checked_seed, interface, observed
from ..limits.field_checks import finite_numbers
from ..task.observation import observation_space
from ..vector.arguments import chosen_by, each_seed
from .episodes import BEGIN, BEGIN_AGAIN, REST, STEP, judge_worlds, step_worlds, sweep_worlds
from .infos import infos, masked, observations
from .own_terms import OwnTerms
from .parts import read_sweep, sweep
from .pool import SHARING, EpisodePool
from .rules import compiled_config, make_rules
from .state import Flags, arrays_of, nothing_told, scratch, state_with_room
from .trackers import Trackers

MOST_ENVS = 65_536
_SLOW_S = 3.0  # a first call that takes longer is compiling
_log = logging.getLogger("tagalong")


class CompiledVectorEnv(VectorEnv[Any, Any, Any]):
    """`num_envs` worlds like those of `FollowEnv`, stepped by compiled code on arrays.

    `gymnasium.make_vec("tagalong/Office-v0", num_envs=1024, vectorization_mode="vector_entry_point",
    simulator="compiled")`. Buildings, people, rewards and endings are those of `FollowEnv`; robot, contacts and laser
    are done anew, equal to MuJoCo's within a millimetre (tested). People are known by the truth (`people="truth"`, the
    default here), with the errors of a tracker (`people="modelled"`), or by the real one (`people="tracker"`, a
    quarter of the speed), and nothing maps (`slam=None`, likewise). Functions of `reward.terms` are called world by
    world. There is no camera, no picture, no `leader=False`, and no `behaviours` or `observation.entries` of one's own.
    All else of `FollowConfig` and all options of `reset` are as there; what is not is refused.

    Episodes are chosen by each world's seed, s + i for world i of `reset(seed=s)`, from `episodes_ahead` that are drawn
    before: no world waits for a drawing. With `own_start`, or with options, `reset` draws for each world what
    `FollowEnv` begins with for its seed. Measurements have draws of their own: same seed, same bytes, for any number of
    workers, and for a world beside any others.

    Args:
        num_envs: How many worlds.
        workers: Threads that share them; None takes one a core.
        max_episode_steps: Steps after which an episode is truncated; None never.
        autoreset_mode: As of `FollowVectorEnv`.
        episodes_ahead: How many episodes (building, people, start) are drawn at the first reset; four each share a
            building. An office takes about 0.1 s, and an episode 0.3 MB.
        episodes_seed: Of their draws.
        kinds: Options of `reset` for the episodes drawn ahead, a building each in turn: `[{"scene": "office"},
            {"scene": "corridor", "people": 5, "heedless": 1.0}]` makes half of them corridors.
        own_start: Whether `reset(seed=...)` draws the buildings, people and starts of these seeds.
        fields: Keyword arguments of `FollowEnv`.

    Raises:
        InputError: If an argument is wrong, or asks for what is not supported.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        workers: int | None = None,
        max_episode_steps: int | None = None,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        episodes_ahead: int = 128,
        episodes_seed: int = 0,
        kinds: Sequence[Mapping[str, Any]] = ({},),
        own_start: bool = False,
        **fields: Any,
    ) -> None:
        if not 1 <= num_envs <= MOST_ENVS:
            raise InputError(f"`num_envs` must lie in 1 .. {MOST_ENVS}, got {num_envs}")
        threads = min(num_envs, os.cpu_count() or 1, MOST_THREADS) if workers is None else workers
        if not 1 <= threads <= min(num_envs, MOST_THREADS):
            rule = f"need 1 <= `workers` <= `num_envs`, and {MOST_THREADS} at most"
            raise InputError(f"{rule}, got {workers} and {num_envs}")
        if not 1 <= episodes_ahead <= MOST_ENVS:
            raise InputError(f"`episodes_ahead` must lie in 1 .. {MOST_ENVS}, got {episodes_ahead}")
        self.config = compiled_config(fields)
        self.interface = interface(self.config)
        self.num_envs, self.render_mode = num_envs, None
        self.metadata = {
            "render_modes": [],
            "render_fps": round(self.config.task.control_hz),
            "autoreset_mode": AutoresetMode(autoreset_mode),
        }
        self.single_observation_space = observation_space(observed(self.config))
        self.single_action_space = spaces.Box(-1.0, 1.0, (3 if self.interface.holonomic else 2,), np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._pool = EpisodePool(
            self.config, num_envs, episodes_ahead, episodes_seed, _checked_kinds(kinds, episodes_ahead)
        )
        self._rules = make_rules(self.config, max_episode_steps or 0, episodes_ahead)
        self._state = state_with_room(num_envs, 1, 0)
        beams, slots = self.config.sensors.lidar.beams, self.config.observation.people_slots
        speeds, tracked = 3 if self.interface.holonomic else 2, self._rules.tracked
        self._told = nothing_told(num_envs, beams, slots, speeds, read=tracked)
        self._trackers = Trackers(self.config, num_envs) if tracked else None
        self._own_terms = OwnTerms(self.config.reward, num_envs, 1.0 / self.config.task.control_hz)
        self._begun, self._closed, self._own_start = False, False, own_start
        self._workers = Workers(threads)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
        """Start episodes in all worlds, or in those of `options["reset_mask"]` (num_envs,).

        Args:
            seed: Of the first world, or one for each. Without one a world goes on to its next episode.
            options: As of `FollowEnv`.

        Raises:
            InputError: If a seed, the mask or an option is wrong, or not all begin at first.
        """
        self._require_open()
        seeds = [checked_seed(one) for one in each_seed(seed, self.num_envs)]
        wanted = dict(options or {})
        mask = chosen_by(wanted.pop("reset_mask", None), self.num_envs, begun=self._begun)
        check_options(wanted)
        what = np.full(self.num_envs, REST, dtype=np.int8)
        with compiled_together(*(() if self._trackers is None else (read_sweep, sweep))):
            for w in np.flatnonzero(mask).tolist():
                what[w] = self._draw(w, seeds[w], wanted)
            self._pool.draw_ahead()
            self._make_room()
            self._do(what, np.zeros((self.num_envs, *(self.single_action_space.shape or ()))))
        self._begun = True
        return self._observations(), self._infos(mask)

    def _draw(self, w: int, seed: int | None, options: dict[str, Any]) -> int:
        """Draw the next episode of world w where it must be drawn; return how to begin it."""
        state, drawn = self._state, bool(options) or (self._own_start and seed is not None)
        if seed is None and not self._begun:
            seed = int(self.np_random.integers(2**63))
        if seed is not None:
            state.seed[w], state.episode[w] = seed, -1
        if not drawn:
            return BEGIN_AGAIN
        state.episode[w] += 1
        if seed is None:
            self._pool.draw_another(w, int(state.seed[w]), int(state.episode[w]), options)
        else:
            self._pool.draw_own(w, seed, options)
        return BEGIN

    def step(self, actions: Any) -> tuple[dict[str, NDArray[Any]], NDArray[np.float64], Flags, Flags, dict[str, Any]]:
        """Drive all worlds for one control period; `actions` (num_envs, a).

        Raises:
            InputError: If an action is missing, too many, of another shape or not finite; then nobody has moved.
        """
        self._require_open()
        wanted = self._checked(actions)
        mode, ended = self.metadata["autoreset_mode"], self._state.ended.copy()
        if mode == AutoresetMode.DISABLED and ended.any():
            raise InputError(f"the episode of environment {int(np.flatnonzero(ended)[0])} has ended: reset it first")
        self._do(np.where(ended, BEGIN_AGAIN, STEP).astype(np.int8), wanted)
        told, all_of_them = self._told, np.ones(self.num_envs, bool)
        rewards, terminated, truncated = told.reward.copy(), told.terminated.copy(), told.truncated.copy()
        ended = self._state.ended.copy()
        if mode != AutoresetMode.SAME_STEP or not ended.any():
            return self._observations(), rewards, terminated, truncated, self._infos(all_of_them)
        final = {"final_obs": _last(observations(told), ended), "final_info": self._infos(ended)}
        self._do(np.where(ended, BEGIN_AGAIN, REST).astype(np.int8), wanted)
        told_of = self._infos(all_of_them)
        return self._observations(), rewards, terminated, truncated, {**told_of, **masked(final, ended)}

    @property
    def memory(self) -> int:
        """Memory of episodes, state and what is told [bytes]."""
        tracked = 0 if self._trackers is None else self._trackers.memory
        return self._pool.size + tracked + sum(array.nbytes for array in arrays_of((self._state, self._told)))

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Return what a method of the whole returns, or its attribute, once for each world."""
        value = getattr(self, name)
        return (value(*args, **kwargs) if callable(value) else value,) * self.num_envs

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Return an attribute of the whole, once for each world."""
        return (getattr(self, name),) * self.num_envs

    def set_attr(self, name: str, values: Any) -> None:
        """Refuse: worlds are rows of arrays, and have no attributes.

        Raises:
            InputError: Always.
        """
        raise InputError(f"compiled worlds have no attributes of their own: `{name}` cannot be set; make a new one")

    def close_extras(self, **kwargs: Any) -> None:
        """Take no more steps."""
        self._closed = True

    def _checked(self, actions: Any) -> NDArray[np.float64]:
        wanted = finite_numbers(actions)
        if wanted is not None and wanted.ndim > 0 and len(wanted) != self.num_envs:
            raise InputError(f"needs an action for each of the {self.num_envs} environments, got {len(wanted)}")
        if wanted is None or wanted.shape != self.action_space.shape:
            raise InputError(f"actions have shape {self.action_space.shape} and are finite, got {shown(actions)}")
        return np.ascontiguousarray(wanted)

    def _require_open(self) -> None:
        if self._closed:
            raise InputError("the environment is closed: make a new one")

    def _make_room(self) -> None:
        """Give people and doors of all episodes room in the state."""
        plans = self._pool.plans
        people, doors = plans.radius.shape[1], plans.leaves.shape[1]
        if people > self._state.bodies.position.shape[1] or doors > self._state.open.shape[1]:
            self._state = state_with_room(self.num_envs, people, doors, self._state)

    def _room(self) -> Any:
        return scratch(self._rules.ticks, len(self._rules.laser.cos_bearing), self._state.bodies.position.shape[1])

    def _do(self, what: NDArray[np.int8], actions: NDArray[np.float64]) -> None:
        """Do `what` (num_envs,) in all worlds, and judge it by functions of the user's own, too."""
        self._run(what, actions)
        self._own_terms.add(self._told, what == STEP, (what == BEGIN) | (what == BEGIN_AGAIN))

    def _infos(self, mask: Flags) -> dict[str, Any]:
        return infos(self._told, self._own_terms.values, mask)

    def _run(self, what: NDArray[np.int8], actions: NDArray[np.float64]) -> None:
        """Let the threads do `what` (num_envs,) in all worlds."""
        world = self._rules, self._pool.plans, self._state, self._told
        trackers, left = self._trackers, what
        step = step_worlds if trackers is None else sweep_worlds
        self._share(lambda turns: step(turns, what, actions, *world, self._room()))
        if trackers is None:
            return
        while (left != REST).any():
            self._share(lambda turns, left=left: trackers.read(turns, left, self._state, self._told))
            left = trackers.make_room(left)
        self._share(lambda turns: judge_worlds(turns, what, *world))

    def _share(self, work: Callable[[Turns], object]) -> None:
        """Let the threads take turns at the work on all worlds."""
        if self._begun:
            shared = turns(self.num_envs, self._workers.threads)
            self._workers.together(lambda: work(shared))
        else:  # the first call may compile
            telling(work, turns(self.num_envs))

    def _observations(self) -> dict[str, NDArray[Any]]:
        return {name: values.copy() for name, values in observations(self._told).items()}


def _checked_kinds(kinds: Any, ahead: int) -> list[Mapping[str, Any]]:
    """Return the kinds of episodes.

    Raises:
        InputError: If they are no list of options of `reset`, or more than there are buildings.
    """
    if isinstance(kinds, str | Mapping) or not isinstance(kinds, Sequence) or not kinds:
        raise InputError(f"`kinds` must be a list of reset options, got {shown(kinds)}")
    for kind in kinds:
        check_options(kind or {})
    if len(kinds) > -(-ahead // SHARING):
        need = f"{SHARING * len(kinds)} `episodes_ahead`, for {SHARING} share a building"
        raise InputError(f"{len(kinds)} `kinds` need at least {need}, got {ahead}")
    return [kind or {} for kind in kinds]


def _last(batch: dict[str, NDArray[Any]], ended: Flags) -> NDArray[Any]:
    """Return (w,) the observation of each world that has ended, as Gymnasium gives it; None of the others."""
    last = np.full(len(ended), None, dtype=object)
    for w in np.flatnonzero(ended).tolist():
        last[w] = {name: values[w].copy() for name, values in batch.items()}
    return last


def telling(call: Callable[..., object], *arguments: Any) -> None:
    """Call a kernel; say so if it takes long, which is when it is compiled."""
    text = 'compiling the worlds of simulator="compiled": once on this machine, one to two minutes'
    timer = threading.Timer(_SLOW_S, _log.warning, (text,))
    timer.start()
    try:
        call(*arguments)
    finally:
        timer.cancel()
