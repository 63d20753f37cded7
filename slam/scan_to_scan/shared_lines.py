"""The last millimetres: where the points of both scans, taken together, make the straightest lines.

Both scans' points, in order of bearing, are one chain, and a cut of the chain makes straight pieces of it. The
likelihood of a pose is the sum over all cuts (a forward recursion over the points), so no cut is decided for, and a
structure of which each scan has two points counts as well as a wall does. The pose is the mean by that likelihood along
the direction that the pieces say least about; point-to-line matching has settled the others.
"""

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ..bounds import Endless, Within, check_numbers
from ..errors import InputError
from ..view_kernel import kernel

_FAR = 1e9  # nats that no cut costs
_NEGLIGIBLE = 12.0  # nats by which what costs more is left out


@dataclass(frozen=True, kw_only=True)
class SharedLinesConfig:
    """How straight surfaces are, and where to look.

    Attributes:
        noise: Standard deviation of a point from the straight piece it is of [m].
        line: What a piece of three points or more costs, in nats.
        pair: What a piece of two points costs, which any two make.
        single: What a piece of one point costs.
        gap: Points side by side may be of one piece up to this distance [m] plus `obliquity` beam widths.
        obliquity: Beam widths (range times angle between the beams) between such points.
        longest: Most points of a piece.
        span: How far poses are looked at to both sides [m].
        step: How far apart they are [m].
        prior: Standard deviation of the pose that is given, along the direction looked along [m].
        doubt: Where the pieces leave less than this standard deviation [m], the pose stays.
    """

    noise: float = 0.0075
    line: float = 4.0
    pair: float = 3.2
    single: float = 2.0
    gap: float = 0.2
    obliquity: float = 8.0
    longest: Annotated[int, Within(1, 1000)] = 12
    span: float = 0.012
    step: float = 0.006
    prior: float = 0.015
    doubt: Endless = 0.0025

    def coarser(self, factor: float) -> "SharedLinesConfig":
        """Return the same for `factor` times the noise."""
        lengths = {name: factor * getattr(self, name) for name in ("noise", "gap", "span", "step", "prior", "doubt")}
        return replace(self, **lengths)

    def __post_init__(self) -> None:
        check_numbers(self)
        if not min(self.noise, self.gap, self.obliquity, self.span, self.step, self.prior) > 0.0:
            raise InputError(f"need positive lengths, got {self}")
        if not (min(self.line, self.pair, self.single, self.doubt) >= 0.0 and self.longest >= 3):
            raise InputError(f"need costs, `doubt` >= 0 and `longest` >= 3, got {self}")


def refine_by_shared_lines(
    reference: NDArray[np.float64], new: NDArray[np.float64], pose: NDArray[np.float64], config: SharedLinesConfig
) -> NDArray[np.float64]:
    """Return the pose (3,) near `pose` at which both scans lie on the same straight pieces.

    Args:
        reference: (M, 2) points of the reference [m].
        new: (N, 2) of the new scan, in its frame [m].
        pose: (3,) of the new scan, within a few centimetres.
        config: How straight surfaces are, and where to look.
    """
    costs = config.single, config.pair, config.line
    points, moves, apart = merge(reference, new, pose, config.gap, config.obliquity)
    _, before = log_evidence(points, apart, config.noise, costs, config.longest)
    direction, sigma = least_sure(information(points, moves, before) / config.noise**2)
    if sigma < config.doubt:
        return pose
    steps = np.arange(-config.span, config.span + 0.5 * config.step, config.step)
    logs = evidences(points, moves @ direction, steps, apart, config.noise, costs, config.longest)
    weights = np.exp(logs - logs.max() - 0.5 * (steps / config.prior) ** 2)
    return pose + float(weights @ steps / weights.sum()) * direction


def least_sure(
    information: NDArray[np.float64], widest: tuple[float, float] = (0.1, 0.03)
) -> tuple[NDArray[np.float64], float]:
    """Return (3,) how the pose changes per metre along its least sure direction, and the standard deviation there [m].

    `widest` (m, rad) is what the pose is known to be within anyway.
    """
    covariance = np.linalg.inv(information + np.diag([widest[0] ** -2, widest[0] ** -2, widest[1] ** -2]))
    values, vectors = np.linalg.eigh(covariance[:2, :2])
    return covariance[:, :2] @ vectors[:, 1] / values[1], float(np.sqrt(values[1]))


@kernel
def merge(reference, new, pose, gap, obliquity):  # pragma: no cover
    """Return the chain of both scans' points in order of bearing.

    Returns:
        points (K, 2) in the reference's frame, moves (K, 2, 3) of each by the pose (zero for the reference's own), and
        apart (K,), whether a point and the next are of different surfaces.
    """
    count, first = len(reference) + len(new), len(reference)
    at, bearings = np.empty((count, 2)), np.empty(count)
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    for k in range(count):
        if k < first:
            at[k] = reference[k]
        else:
            x, y = new[k - first, 0], new[k - first, 1]
            at[k, 0], at[k, 1] = cos * x - sin * y + pose[0], sin * x + cos * y + pose[1]
        bearings[k] = np.arctan2(at[k, 1], at[k, 0])
    order = np.argsort(bearings, kind="mergesort")
    points, moves, apart = at[order], np.zeros((count, 2, 3)), np.ones(count, dtype=np.bool_)
    for k in range(count):
        x, y = points[k, 0], points[k, 1]
        if order[k] >= first:
            moves[k, 0, 0], moves[k, 0, 2] = 1.0, pose[1] - y
            moves[k, 1, 1], moves[k, 1, 2] = 1.0, x - pose[0]
        if k + 1 < count:
            angle = bearings[order[k + 1]] - bearings[order[k]]
            nearer = np.sqrt(min(x * x + y * y, points[k + 1, 0] ** 2 + points[k + 1, 1] ** 2))
            # The beams of the two scans may coincide: a hundredth of a radian is between them at least.
            limit = gap + obliquity * nearer * max(angle, 0.01)
            apart[k] = angle > 0.18 or (points[k + 1, 0] - x) ** 2 + (points[k + 1, 1] - y) ** 2 > limit * limit
    return points, moves, apart


@kernel
def log_evidence(points, apart, noise, costs, longest):  # pragma: no cover
    """Return the log of the sum over all cuts of the chain of exp(-cost), and the best cut.

    Args:
        points: (K, 2) in order.
        apart: (K,) whether a cut must be after each.
        noise: Standard deviation of a point from its piece [m].
        costs: Of a piece of one point, two, and more; to the last comes half the sum of squares from the best line.
        longest: Most points of a piece.

    Returns:
        The log, and before (K + 1,): where the last piece of the best cut of the first k points starts.
    """
    count, scale = len(points), 0.5 / (noise * noise)
    # total[k] = highest[k] + log(above[k]): of the first k points; best[k]: of their best cut.
    highest, above, best = np.full(count + 1, -_FAR), np.zeros(count + 1), np.full(count + 1, -_FAR)
    before, share = np.zeros(count + 1, dtype=np.int64), 1.0 / np.maximum(np.arange(longest + 1), 1)
    highest[0] = best[0] = 0.0
    for start in range(count):
        total = highest[start] + (np.log(above[start]) if start > 0 else 0.0)
        sx, sy, sxx, sxy, syy = 0.0, 0.0, 0.0, 0.0, 0.0
        for end in range(start, min(count, start + longest)):
            if end > start and apart[end - 1]:
                break
            x, y = points[end, 0] - points[start, 0], points[end, 1] - points[start, 1]
            size = end - start + 1
            sx, sy, sxx, sxy, syy = sx + x, sy + y, sxx + x * x, sxy + x * y, syy + y * y
            cost = costs[min(size, 3) - 1]
            if size > 2:
                mx, my = sx * share[size], sy * share[size]
                xx, xy, yy = sxx - sx * mx, sxy - sx * my, syy - sy * my
                bend = scale * max(0.5 * (xx + yy) - np.sqrt(0.25 * (xx - yy) ** 2 + xy * xy), 0.0)
                cost += bend
                # Longer pieces from here are no straighter, and single points cost far less.
                if bend > size * costs[0] + _NEGLIGIBLE:
                    break
            if best[start] - cost > best[end + 1]:
                best[end + 1], before[end + 1] = best[start] - cost, start
            value = total - cost
            if value > highest[end + 1]:
                above[end + 1] = above[end + 1] * np.exp(highest[end + 1] - value) + 1.0
                highest[end + 1] = value
            elif value > highest[end + 1] - _NEGLIGIBLE:
                above[end + 1] += np.exp(value - highest[end + 1])
    return highest[count] + np.log(above[count]), before


@kernel
def evidences(points, velocities, steps, apart, noise, costs, longest):  # pragma: no cover
    """Return (S,) the log evidence of the chain with each point moved by each of `steps` (S,) times its velocity."""
    logs, moved = np.empty(len(steps)), np.empty_like(points)
    for s in range(len(steps)):
        for k in range(len(points)):
            moved[k, 0] = points[k, 0] + steps[s] * velocities[k, 0]
            moved[k, 1] = points[k, 1] + steps[s] * velocities[k, 1]
        logs[s] = log_evidence(moved, apart, noise, costs, longest)[0]
    return logs


@kernel
def information(points, moves, before):  # pragma: no cover
    """Return (3, 3) what the pieces of a cut say about the pose, for a noise of 1 m, their lines being unknown.

    Args:
        points: (K, 2) the chain.
        moves: (K, 2, 3) of each point by the pose.
        before: (K + 1,) the cut, as `log_evidence` has it.
    """
    found, end = np.zeros((3, 3)), len(points)
    rows = np.empty((len(points), 3))
    while end > 0:
        start = before[end]
        size = end - start
        if size > 2:
            mx, my = points[start:end, 0].mean(), points[start:end, 1].mean()
            xx, xy, yy = 0.0, 0.0, 0.0
            for k in range(start, end):
                dx, dy = points[k, 0] - mx, points[k, 1] - my
                xx, xy, yy = xx + dx * dx, xy + dx * dy, yy + dy * dy
            angle = 0.5 * np.arctan2(2.0 * xy, xx - yy)
            tx, ty = np.cos(angle), np.sin(angle)
            mean, tilt, spread = np.zeros(3), np.zeros(3), 1e-12
            for k in range(start, end):
                along = tx * (points[k, 0] - mx) + ty * (points[k, 1] - my)
                spread += along * along
                for a in range(3):
                    rows[k, a] = -ty * moves[k, 0, a] + tx * moves[k, 1, a]
                    mean[a] += rows[k, a] / size
                    tilt[a] += along * rows[k, a]
            # What a shift or a turn of the line would do as well says nothing.
            for a in range(3):
                for b in range(3):
                    for k in range(start, end):
                        found[a, b] += rows[k, a] * rows[k, b]
                    found[a, b] -= size * mean[a] * mean[b] + tilt[a] * tilt[b] / spread
        end = start
    return found
