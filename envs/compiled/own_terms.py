"""Terms of the reward that are a user's own functions, in many worlds."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..task.rewards import RewardConfig, StepFacts, further_terms
from .state import Array, Told


class OwnTerms:
    """What the functions of `reward.terms` make of each world's step: the same ones, on the same `StepFacts`, as in
    `FollowEnv`. They are called world by world, some microseconds each.

    Args:
        config: Of the reward.
        worlds: How many.
        step_s: Length of a step [s].
    """

    def __init__(self, config: RewardConfig, worlds: int, step_s: float) -> None:
        self._config, self._step_s = config, step_s
        self._values = {name: np.zeros(worlds) for name in config.terms}

    @property
    def values(self) -> Mapping[str, Array]:
        """(w,) what each term was worth in the last step, by name; 0 where an episode has begun."""
        return self._values

    def add(self, told: Told, stepped: NDArray[np.bool_], begun: NDArray[np.bool_]) -> None:
        """Judge the worlds that have `stepped` (w,), and add it to their reward; those that have `begun` have none.

        Raises:
            InputError: If a function returns no finite number.
        """
        if not self._values:
            return
        for values in self._values.values():
            values[begun] = 0.0
        rows, facts = np.flatnonzero(stepped), told.facts[stepped].tolist()
        flags = np.stack((told.following, told.touched, told.done), axis=1)[stepped].tolist()
        for w, (distance, bearing, space, change), (following, touched, done) in zip(rows, facts, flags, strict=True):
            step = StepFacts(
                distance=distance,
                bearing=bearing,
                bystander_space=space,
                action_change=change,
                following_leader=following,
                collided=touched,
                tour_done=done,
                step_s=self._step_s,
            )
            for name, value in further_terms(step, self._config).items():
                self._values[name][w] = value
                told.reward[w] += value
