"""The immobile-area grid map of Zhang et al. 2019: cells hold the odds that they belong to what never moves.

Legend: I the event that a cell is immobile area, O that something is observed there, lambda the coefficient of what was
recognised, beta = lambda P(O) (eq. 5) by which an observation multiplies the odds P(I) / P(not I) (eq. 4).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import Reach, check_numbers
from ..errors import InputError
from ..geometry import compose
from ..grid import GridConfig

Array = NDArray[np.float64]

UNKNOWN = 2.0
"""Lambda of what was not recognised: at P(O) = 0.5 it changes nothing."""
STILL_GAIN, MOVING_GAIN = 8.0, 1.5


def still_lambda(likelihood: ArrayLike) -> Array:
    """Return lambda of still things, 2 to 10, from the `likelihood` (...,) in [0, 1] of their recognition.

    The ends are the paper's; it says that lambda moves away from 2 as the likelihood grows, we let it do so linearly.
    """
    return UNKNOWN + STILL_GAIN * _checked(likelihood)


def moving_lambda(likelihood: ArrayLike) -> Array:
    """Return lambda of people and what else moves, 2 to 0.5, from the `likelihood` (...,) in [0, 1]."""
    return UNKNOWN - MOVING_GAIN * _checked(likelihood)


def _checked(likelihood: ArrayLike) -> Array:
    value = np.asarray(likelihood, dtype=np.float64)
    if not np.all((value >= 0.0) & (value <= 1.0)):
        raise InputError(f"a likelihood is in [0, 1], got {likelihood!r}")
    return value


@dataclass(frozen=True, kw_only=True)
class ImmobileConfig(GridConfig):
    """Parameters of a grid of immobile area; those of `GridConfig` and these. `hit` and `miss` are P(O).

    Attributes:
        miss: P(O) of a cell through which a ray passed.
        max_range: Rays longer than this are cut there, without a hit [m].
        firm: Log-odds from which a cell counts as having been immobile area.
        gone: Log-odds below which such a cell counts as left: it held something movable, such as a door.
    """

    miss: float = 0.35
    max_range: Reach = 10.0
    firm: float = 2.0
    gone: float = -1.0

    def __post_init__(self) -> None:
        check_numbers(self)
        super().__post_init__()
        if not self.gone < 0.0 < self.firm <= self.limit:
            raise InputError(f"need `gone` < 0 < `firm` <= `limit`, got {self.gone}, {self.firm} and {self.limit}")


class PoseHistory:
    """The robot's recent poses, so that late results are placed where the robot was at the exposure.

    Args:
        longest_s: How long a pose is kept [s].
    """

    def __init__(self, longest_s: float = 5.0) -> None:
        if not longest_s > 0.0:
            raise InputError(f"`longest_s` must be positive [s], got {longest_s}")
        self._longest_s = longest_s
        self._times: list[float] = []
        self._poses: list[Array] = []

    def add(self, time_s: float, T_map_robot: ArrayLike) -> None:
        """Add the pose (3,) at `time_s`.

        Raises:
            InputError: If it is not later than the last one.
        """
        if self._times and not time_s > self._times[-1]:
            raise InputError(f"poses come in the order of time: {time_s} s follows {self._times[-1]} s")
        self._times.append(float(time_s))
        self._poses.append(np.array(T_map_robot, dtype=np.float64))
        while self._times[-1] - self._times[0] > self._longest_s:
            self._times.pop(0)
            self._poses.pop(0)

    @property
    def newest(self) -> Array:
        """(3,) the last pose that was added."""
        return self._poses[-1]

    def replace(self, times_s: Array, poses: Array) -> None:
        """Believe from now on that the robot was at `poses` (n, 3) at the rising `times_s` (n,) [s]."""
        recent = times_s >= times_s[-1] - self._longest_s
        self._times, self._poses = times_s[recent].tolist(), list(poses[recent])

    def at(self, time_s: float) -> Array:
        """Return the pose (3,) at `time_s`, between the two poses around it.

        Raises:
            InputError: If no pose that old is kept, or none that new was added.
        """
        if not self._times or not self._times[0] - 1e-9 <= time_s <= self._times[-1] + 1e-9:
            kept = f"{self._times[0]} s to {self._times[-1]} s" if self._times else "none"
            raise InputError(f"no pose is known at {time_s} s; kept: {kept}")
        poses = np.array(self._poses)
        turns = np.unwrap(poses[:, 2])
        x, y, theta = (np.interp(time_s, self._times, column) for column in (poses[:, 0], poses[:, 1], turns))
        return compose(np.array([x, y, theta]), np.zeros(3))
