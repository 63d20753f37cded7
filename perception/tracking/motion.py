"""How hypotheses move: prediction and correction (Ye 2021, eq. 4), and the way that they have gone."""

from typing import Any

import numpy as np

from ...slam.view_kernel import kernel
from .geometry_kernels import square_distance
from .kalman import correct_state, predict_state
from .tracks import PATH


@kernel
def predict(rows: Any, dt: float, q: float) -> None:
    """Move hypotheses `rows` (n,) `dt` [s] ahead (eq. 4a, 4b) with process noise `q`."""
    x, p = rows["x"], rows["p"]
    for i in range(len(rows)):
        rows["leg_unseen_s"][i, 0] += dt
        rows["leg_unseen_s"][i, 1] += dt
        predict_state(x[i], p[i], dt, q)


@kernel
def widen(rows: Any, before: Any, now: Any, unjudged: float) -> None:
    """Let hypotheses `rows` (n,) be less sure where they are, as far as nobody knows that the frame stands still.

    Then one may as well have kept its place before the laser, which has gone from `before` (3,) to `now` (3,) by
    odometry: the variance grows by the square of what lies between the two places, times how far it is `unjudged`.
    With odometry made of scans of a lawn the number of a person who was followed outdoors for twelve minutes changed
    twice so, and eight times without; where walls are in sight nothing changes.
    """
    cos, sin = np.cos(now[2] - before[2]), np.sin(now[2] - before[2])
    for i in range(len(rows)):
        x, y = rows["x"][i, 0] - before[0], rows["x"][i, 1] - before[1]
        dx = now[0] + cos * x - sin * y - rows["x"][i, 0]
        dy = now[1] + sin * x + cos * y - rows["x"][i, 1]
        rows["p"][i, 0] += (unjudged * dx) ** 2 + (unjudged * dy) ** 2


@kernel
def correct(rows: Any, z: Any, r: float, r_one: float, dt: float, fade: float) -> None:
    """Correct hypotheses by the clusters `z` (m, 2) that are their legs (eq. 4c to 4e), and age all of them.

    Two legs measure the centre with variance `r`, one with `r_one`. `fade` is the share of what is known of an unseen
    leg's place that is kept.
    """
    x, p = rows["x"], rows["p"]
    for i in range(len(rows)):
        rows["age_s"][i] += dt
        a, b = rows["clusters"][i, 0], rows["clusters"][i, 1]
        if a < 0 and b < 0:
            rows["unseen_s"][i] += dt
            continue
        rows["unseen_s"][i] = 0.0
        first, second = a if a >= 0 else b, b if b >= 0 else a
        noise = r if a >= 0 and b >= 0 else r_one
        middle_x, middle_y = 0.5 * (z[first, 0] + z[second, 0]), 0.5 * (z[first, 1] + z[second, 1])
        correct_state(x[i], p[i], middle_x, middle_y, noise)
        place_legs(rows, i, z, fade)


@kernel
def place_legs(rows: Any, i: int, z: Any, fade: float) -> None:
    """Write where the legs of hypothesis i are; an unseen one is near the centre after a while, see `correct`."""
    x, legs = rows["x"][i], rows["legs"][i]
    for s in range(2):
        c = rows["clusters"][i, s]
        if c >= 0:
            legs[s, 0], legs[s, 1] = z[c, 0] - x[0], z[c, 1] - x[1]
            rows["leg_unseen_s"][i, s] = 0.0
        else:
            legs[s, 0], legs[s, 1] = fade * legs[s, 0], fade * legs[s, 1]


@kernel
def note_path(
    rows: Any,
    seen: Any,
    free: Any,
    known: float,
    dt: float,
    spacing_s: float,
    least: float,
    pace: float,
    jitter: float,
) -> None:
    """Note which hypotheses have moved, and, each `spacing_s` [s], where they are.

    One has moved if it is `least` away from where it was within the time that its path reaches back, and still moves
    at `pace`: who is taken for one thing and then for another hops, and stands again.

    Args:
        rows: (n,) hypotheses, corrected.
        seen: (m, 2) clusters in the laser's frame [m].
        free: (n,) whether nothing has stood still where each hypothesis is.
        known: How far the odometry frame stands still: only then is motion in it motion.
        dt: Since the last scan [s].
        spacing_s: Between two noted places [s].
        least: [m].
        pace: [m/s].
        jitter: What has never moved as far before the laser may be a part of the robot [m].
    """
    for i in range(len(rows)):
        c = max(rows["clusters"][i, 0], rows["clusters"][i, 1])
        if c < 0:
            continue
        x, way, swing = rows["x"][i], 0.0, 0.0
        for k in range(min(rows["places"][i], PATH)):
            path, view = rows["path"][i, k], rows["seen"][i, k]
            way = max(way, square_distance(x[0], x[1], path[0], path[1]))
            swing = max(swing, square_distance(seen[c, 0], seen[c, 1], view[0], view[1]))
        rows["swing"][i] = max(rows["swing"][i], np.sqrt(swing))
        goes = way >= least * least and x[2] * x[2] + x[3] * x[3] >= pace * pace
        rows["stands_s"][i] += dt if rows["id"][i] >= 0 else 0.0
        if goes and free[i] and rows["swing"][i] >= jitter:
            rows["stands_s"][i] = 0.0
            born = rows["born"][i]
            away = np.sqrt(square_distance(x[0], x[1], born[0], born[1]))
            rows["moved"][i] = max(rows["moved"][i], known * away)
        if rows["age_s"][i] - rows["marked_s"][i] >= spacing_s - 1e-9:
            note_place(rows, i, x, seen[c])


@kernel
def note_place(rows: Any, i: int, place: Any, seen: Any) -> None:
    """Note that hypothesis i is at `place` [m], `seen` in the laser's frame."""
    slot = rows["places"][i] % PATH
    rows["path"][i, slot, 0], rows["path"][i, slot, 1] = place[0], place[1]
    rows["seen"][i, slot, 0], rows["seen"][i, slot, 1] = seen[0], seen[1]
    rows["places"][i] += 1
    rows["marked_s"][i] = rows["age_s"][i]
