"""A recorded drive localized as a whole: the trajectory that explains all scans best, also before it was sure."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..geometry import between, compose, wrap_angle
from ..runner import Drive
from .hypotheses import near
from .localizer import Localizer, WeighedScan

Array = NDArray[np.float64]

_PLAY = (1.0, 0.175)  # [m, rad]
_ENDS = 10  # so many of the hypotheses at the end of a pass are followed back


@dataclass(frozen=True, eq=False)
class SmoothedDrive:
    """The best trajectory of a whole drive.

    Attributes:
        trajectory: (n, 3) T_map_robot at each scan; NaN where the robot was rather off the map.
        probability: Of this trajectory and those that mostly agree with it, beside the others that were tried; 0 where
            no place on the map was ever found.
    """

    trajectory: Array
    probability: float


def smooth_drive(localizer: Localizer, drive: Drive) -> SmoothedDrive:
    """Return the best trajectory of a drive, by all scans at once.

    The hypotheses at the end of the drive are followed back to where they were found, and on from there to its
    beginning. So are those at the end of a second pass, from the last scan to the first. The trajectory that explains
    all the scans best wins.

    Args:
        localizer: It has localized this drive and nothing else, and kept its history.
        drive: The drive.

    Raises:
        InputError: If the localizer has kept no history.
    """
    if localizer.history is None:
        raise InputError("to smooth a drive the localizer must keep its history (`keep_history`)")
    odometry, history = localizer.odometry(), localizer.history
    again = Localizer(localizer.place, replace(localizer.config, local=None), keep_history=True)
    for pose, scan in zip(odometry[::-1], drive.scans[::-1], strict=True):
        again.update(pose, scan)
    assert again.history is not None
    paths = [_between_scans(path, history, odometry) for path in _paths(localizer, history)]
    paths += [_between_scans(path, again.history, odometry[::-1])[::-1] for path in _paths(again, again.history)]
    if not paths:
        return SmoothedDrive(np.full((len(odometry), 3), np.nan), 0.0)
    chosen = _choose(paths, np.array([_log_likelihood(localizer, path) for path in paths]))
    chosen.trajectory[~_on_map_between(localizer, chosen.trajectory)] = np.nan
    return chosen


def _choose(paths: list[Array], weights: Array) -> SmoothedDrive:
    """Return the first of the trajectories that agree with the best one, and how likely these are together.

    The first is that of the first pass, if it is among them: where only the odometry knows, along a corridor, it is the
    one that was told.
    """
    best = int(np.argmax(weights))
    agree = np.array([_agree(path, paths[best]) for path in paths])
    distinct = [best]
    for k in np.argsort(-weights, kind="stable").tolist():
        if not any(_agree(paths[k], paths[other]) for other in distinct):
            distinct.append(k)
    rest = float(np.logaddexp.reduce(weights[distinct] - weights[best]))
    return SmoothedDrive(paths[int(np.flatnonzero(agree)[0])], float(np.exp(-rest)))


def _paths(localizer: Localizer, history: list[WeighedScan]) -> list[Array]:
    """Return trajectories (m, 3) over all scans that were weighed, of the likeliest hypotheses at the end."""
    if not history:
        return []
    return [_path(localizer, history, k) for k in range(min(len(history[-1].poses), _ENDS))]


def _path(localizer: Localizer, history: list[WeighedScan], end: int) -> Array:
    """Return the trajectory (m, 3) of hypothesis `end` of the last scan: its own, or on from where it was found.

    Where it was found after others had been there, the robot may have been carried: then the best one before goes on.
    """
    path, k, born = np.empty((len(history), 3)), end, len(history) - 1
    for born in range(len(history) - 1, -1, -1):
        path[born] = history[born].poses[k]
        k = int(history[born].parents[k])
        if k < 0:
            break
    if born == 0:
        return path
    _follow_back(localizer, history, path, born)
    if len(history[born - 1].poses):
        before = _path(localizer, history[:born], 0)
        carried = _loss(localizer, history[:born], before) - localizer.hypotheses.least
        if carried < _loss(localizer, history[:born], path[:born]):
            path[:born] = before
    return path


def _follow_back(localizer: Localizer, history: list[WeighedScan], path: Array, born: int) -> None:
    """Write into `path` (m, 3) before `born` where the robot came from, if it was not carried."""
    for now in range(born - 1, -1, -1):
        motion = between(history[now + 1].sight.odometry, history[now].sight.odometry)
        sigma = localizer.config.extrapolator.sigma(motion)
        path[now] = localizer.fit.follow(history[now].sight, path[now + 1][None], motion, sigma)[0][0]


def _loss(localizer: Localizer, history: list[WeighedScan], path: Array) -> float:
    """Return the negative log-likelihood of a trajectory (m, 3) at the scans that were weighed."""
    total, _ = _on_map(localizer, history, path)
    odometry = np.array([s.sight.odometry for s in history])
    motions = between(odometry[:-1], odometry[1:]).reshape(-1, 3)
    off = between(motions, between(path[:-1], path[1:]).reshape(-1, 3)).reshape(-1, 3)
    sigmas = np.array([localizer.config.extrapolator.sigma(motion) for motion in motions]).reshape(-1, 2)
    squares = (off[:, 0] ** 2 + off[:, 1] ** 2) / sigmas[:, 0] ** 2 + off[:, 2] ** 2 / sigmas[:, 1] ** 2
    # A step that the odometry cannot have made is a jump to another place; it costs no more than that.
    steps = localizer.config.hypotheses.odometry * 0.5 * squares
    return total + float(np.minimum(steps, -localizer.hypotheses.least).sum())


def _on_map(localizer: Localizer, history: list[WeighedScan], path: Array) -> tuple[float, NDArray[np.bool_]]:
    """Return what the scans of a trajectory (m, 3) lose in log-likelihood, and (m,) where the robot was on the map.

    It may leave the map and come back, each at the log-likelihood of a jump; off the map it misfits as in the unknown.
    """
    fresh, jump = np.array([s.fresh for s in history]), -localizer.config.hypotheses.jump
    misfits = np.array([localizer.fit.judge(s.sight, pose[None])[0][0] for s, pose in zip(history, path, strict=True)])
    off_and_on = np.stack((np.full(len(misfits), localizer.fit.unseen), misfits))
    costs = localizer.hypotheses.costs(off_and_on, fresh)
    least, changed = np.zeros(2), np.empty((len(history), 2), np.bool_)  # Viterbi's algorithm, over off and on
    for i in range(len(history)):
        changed[i] = least[::-1] + jump < least
        least = np.minimum(least, least[::-1] + jump) + costs[:, i]
    on, state = np.empty(len(history), np.bool_), int(least[1] <= least[0])
    for i in range(len(history) - 1, -1, -1):
        on[i] = state
        state ^= int(changed[i, state])
    return float(least.min()), on


def _on_map_between(localizer: Localizer, trajectory: Array) -> NDArray[np.bool_]:
    """Return (n,) where a robot on a trajectory (n, 3) was on the map, between weighed scans as at the one before."""
    history = localizer.history
    assert history is not None
    numbers = np.array([scan.number for scan in history])
    _, on = _on_map(localizer, history, trajectory[numbers])
    return on[np.maximum(np.searchsorted(numbers, np.arange(len(trajectory)), side="right") - 1, 0)]


def _log_likelihood(localizer: Localizer, trajectory: Array) -> float:
    """Return the log-likelihood of a trajectory (n, 3) at all scans, by those that the first pass has weighed."""
    assert localizer.history is not None
    path = trajectory[[scan.number for scan in localizer.history]]
    start, loss = localizer.start, _loss(localizer, localizer.history, path)
    elsewhere = start is not None and not near(path[:1], start, (0.5, np.pi / 12))[0]
    return -loss + (localizer.hypotheses.least if elsewhere else 0.0)


def _between_scans(path: Array, history: list[WeighedScan], odometry: Array) -> Array:
    """Return (n, 3) the pose at every scan: by odometry from the last one that was weighed, as it leads to the next."""
    numbers, result = [scan.number for scan in history], np.empty((len(odometry), 3))
    result[: numbers[0]] = compose(path[0], between(odometry[numbers[0]], odometry[: numbers[0]]))
    for pose, first, then, last in zip(path, numbers, [*path[1:], None], [*numbers[1:], len(odometry)], strict=True):
        expected = compose(pose, between(odometry[first], odometry[first:last]))
        if then is not None:
            off = between(compose(pose, between(odometry[first], odometry[last])), then)
            expected = compose(expected, off * (np.arange(last - first) / (last - first))[:, None])
        result[first:last] = expected
    return result


def _agree(one: Array, other: Array) -> bool:
    """Return whether two trajectories (n, 3) go the same way: a corridor leaves them some play along itself."""
    off = one - other
    agree = (np.hypot(off[:, 0], off[:, 1]) <= _PLAY[0]) & (np.abs(wrap_angle(off[:, 2])) <= _PLAY[1])
    return bool(agree.mean() > 0.9)
