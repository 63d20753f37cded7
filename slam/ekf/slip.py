"""When what is seen contradicts where the filter believes to be: did the robot slip?

A prior that is wrong by more than its covariance makes every sighting fail its gate. Taken for new landmarks, they
would double the map for good. So a slip is tried first: a motion that lays the constellation of the sightings on
landmarks known for long. It is sought by distances between objects, which no pose enters: the filter's own gates are
linear, and half a metre is too far for that. What was added since those landmarks were last seen is given up then.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry import between, transform_points, wrap_angle
from ..quality.rigid import fit_rigid

Array = NDArray[np.float64]

FURTHEST, MOST_TURN = 1.5, 0.6
"""Slips are sought up to this way [m] and turn [rad]."""
_SMALL, _SMALL_TURN = 0.3, 0.15
"""Of slips that only two sightings agree on."""
_APART = 0.12  # a sighting may be so far off its landmark [m]
_MOST_GUESSES = 2000
"""In a crowd where more pairs of sightings lie on pairs of landmarks, constellations fit by chance: none says where."""
_MOST_PAIRS = 10_000_000  # of pairs that are compared; above, there is such a crowd
_VARIANCES = (0.1**2, 0.1**2, 0.05**2)


@dataclass(frozen=True, eq=False)
class Slip:
    """Where the robot must be instead.

    Attributes:
        pose: (3,) T_map_robot.
        variances: (3,) to be added to those of the pose.
    """

    pose: Array
    variances: Array


def find_slip(z: Array, landmarks: Array, pose: Array, least: int) -> Slip | None:
    """Return the slip that lays most sightings on landmarks, at least `least` and half of them.

    Args:
        z: (m, 2) range and bearing of the sightings.
        landmarks: (k, 2) where the landmarks are [m].
        pose: (3,) T_map_robot as the filter believes.
        least: So many sightings must agree; 2 are enough of a small slip only.

    Returns:
        The slip; None where there is none, or two as good.
    """
    seen = z[:, :1] * np.stack((np.cos(z[:, 1]), np.sin(z[:, 1])), axis=-1)
    needed = max(least, (len(z) + 1) // 2)
    best: tuple[int, float, Array] | None = None
    ambiguous = False
    for guess in _guesses(seen, landmarks, pose):
        apart = np.hypot(*(transform_points(guess, seen)[:, None] - landmarks).transpose(2, 0, 1))
        near = apart.argmin(axis=1)
        rows = np.flatnonzero(apart.min(axis=1) < _APART)
        if len(rows) < needed or len(np.unique(near[rows])) < len(rows):
            continue
        fitted = fit_rigid(seen[rows], landmarks[near[rows]])
        misfit = float(np.hypot(*(transform_points(fitted, seen[rows]) - landmarks[near[rows]]).T).max())
        if not _within(pose, fitted, len(rows)):
            continue
        other = best is not None and float(np.hypot(*(fitted - best[2])[:2])) > 2.0 * _APART
        if best is None or (len(rows), -misfit) > (best[0], -best[1]):
            ambiguous = other and best is not None and len(rows) == best[0]
            best = (len(rows), misfit, fitted)
        elif len(rows) == best[0] and other:
            ambiguous = True
    return None if best is None or ambiguous else Slip(best[2], np.array(_VARIANCES))


def _guesses(seen: Array, landmarks: Array, pose: Array) -> list[Array]:
    """Return the poses under which two sightings lie on two landmarks, none further away than slips are sought.

    There are none in a crowd.
    """
    if (len(seen) * len(landmarks)) ** 2 > 2 * _MOST_PAIRS:
        return []
    guesses = []
    between_landmarks = landmarks[None] - landmarks[:, None]
    long, course = (
        np.hypot(*between_landmarks.transpose(2, 0, 1)),
        np.arctan2(*between_landmarks.transpose(2, 0, 1)[::-1]),
    )
    for a in range(len(seen)):
        for b in range(a + 1, len(seen)):
            step = seen[b] - seen[a]
            turn = wrap_angle(course - np.arctan2(step[1], step[0]) - pose[2])
            alike = (np.abs(long - np.hypot(*step)) < _APART) & (np.abs(turn) < MOST_TURN) & (long > 0.0)
            if len(guesses) + np.count_nonzero(alike) > _MOST_GUESSES:
                return []
            guesses += [fit_rigid(seen[[a, b]], landmarks[[i, j]]) for i, j in np.argwhere(alike)]
    return guesses


def _within(pose: Array, other: Array, count: int) -> bool:
    moved = between(pose, other)
    furthest, turn = (_SMALL, _SMALL_TURN) if count == 2 else (FURTHEST, MOST_TURN)
    return bool(np.hypot(moved[0], moved[1]) < furthest and abs(moved[2]) < turn)
