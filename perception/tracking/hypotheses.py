"""All hypotheses of people as one array, and the kernels that move, weigh and correct them."""

from typing import Any

import numpy as np

from ...slam.view_kernel import kernel

PATH = 8
"""So many former places of a hypothesis are kept."""

HYPOTHESIS = np.dtype(
    [
        ("id", np.int64),  # number of the person; -1: not believed in yet
        ("x", np.float64, 4),  # state (x, y, vx, vy) of the centre between the legs, odometry frame
        ("p", np.float64, 3),  # covariance, see kalman.py
        ("looks", np.float64),  # how many looks from elsewhere its evidence comes from
        ("evidence", np.float64),  # mean log likelihood ratio of a look, person against thing
        ("born", np.float64, 2),  # where it began [m]
        ("moved", np.float64),  # how far it has moved of its own from there, as far as that is known [m]
        ("swing", np.float64),  # how far it has ever moved before the laser within that time [m]
        ("missing", np.float64),  # what being unseen says: log likelihood ratio, 0 while it is seen
        ("viewed", np.float64, 2),  # where it was, in the laser's frame, at the last look [m]
        ("stood", np.float64, 2),  # and in the odometry frame [m]
        ("legs", np.float64, (2, 2)),  # of both legs from the centre [m]
        ("leg_unseen_s", np.float64, 2),  # since each leg was seen [s]
        ("clusters", np.int64, 2),  # rows of the clusters that are these legs in this scan; -1: none
        ("path", np.float64, (PATH, 2)),  # former places [m]
        ("seen", np.float64, (PATH, 2)),  # of a leg then, in the laser's frame [m]
        ("marked_s", np.float64),  # age at which the last of them was written [s]
        ("stands_s", np.float64),  # for how long it has been seen without moving since it has a number [s]
        ("places", np.int64),  # how many were written
        ("age_s", np.float64),
        ("placed_s", np.float64),  # for how long its place has been known without a break [s]
        ("unseen_s", np.float64),
    ]
)


@kernel
def predict(rows: Any, dt: float, q: float) -> None:
    """Move hypotheses `rows` (n,) `dt` [s] ahead (eq. 4a, 4b) with process noise `q`."""
    x, p = rows["x"], rows["p"]
    for i in range(len(rows)):
        rows["leg_unseen_s"][i, 0] += dt
        rows["leg_unseen_s"][i, 1] += dt
        x[i, 0] += dt * x[i, 2]
        x[i, 1] += dt * x[i, 3]
        a, b, c = p[i, 0], p[i, 1], p[i, 2]
        p[i, 0], p[i, 1], p[i, 2] = a + 2.0 * dt * b + dt * dt * c + q, b + dt * c, c + q


@kernel
def leg_costs(
    rows: Any, z: Any, e: Any, thing: Any, r: float, pace: float, reach: float, clutter: float, cost: Any
) -> None:
    """Write into `cost` (2 n, m) how unlikely each cluster is each leg: negative log likelihood ratio.

    A leg is where it was last seen, moved on with its person, but for the variance `r` and what it may have swung since
    then; a leg that was never seen, or long ago, is anywhere beside the predicted centre.

    Args:
        rows: (n,) hypotheses, predicted; 2 i and 2 i + 1 are the legs of hypothesis i.
        z: (m, 2) clusters [m].
        e: (m,) evidence of what each cluster itself shows.
        thing: (m,) how much likelier each is a thing that has stood there than a leg that has come there.
        r: Variance with which the place of a leg is seen [m^2].
        pace: How fast a leg swings past its person [m/s].
        reach: Farthest that a leg is from the centre [m].
        clutter: Things that could be legs, a square metre.
        cost: Where to write.
    """
    for i in range(len(rows)):
        x, p = rows["x"][i], rows["p"][i, 0]
        for s in range(2):
            unseen_s = rows["leg_unseen_s"][i, s]
            leg_x, leg_y = x[0] + rows["legs"][i, s, 0], x[1] + rows["legs"][i, s, 1]
            was_x, was_y = leg_x - unseen_s * x[2], leg_y - unseen_s * x[3]
            variance = r + min((pace * unseen_s) ** 2, reach * reach + p)
            base = np.log(2.0 * np.pi * variance * clutter)
            for j in range(len(z)):
                if square_distance(z[j, 0], z[j, 1], x[0], x[1]) > reach * reach + 4.0 * p:
                    cost[2 * i + s, j] = np.inf
                    continue
                off = square_distance(z[j, 0], z[j, 1], leg_x, leg_y)
                come = square_distance(z[j, 0], z[j, 1], was_x, was_y) > r
                cost[2 * i + s, j] = 0.5 * off / variance + base - e[j] + (thing[j] if come else 0.0)


@kernel
def square_distance(x: float, y: float, other_x: float, other_y: float) -> float:
    """Return the squared distance of two places [m^2]."""
    return (x - other_x) ** 2 + (y - other_y) ** 2


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
        k, gain = p[i, 0] / (p[i, 0] + noise), p[i, 1] / (p[i, 0] + noise)
        dx, dy = 0.5 * (z[first, 0] + z[second, 0]) - x[i, 0], 0.5 * (z[first, 1] + z[second, 1]) - x[i, 1]
        x[i, 0] += k * dx
        x[i, 1] += k * dy
        x[i, 2] += gain * dx
        x[i, 3] += gain * dy
        p[i, 2] -= gain * p[i, 1]
        p[i, 0], p[i, 1] = (1.0 - k) * p[i, 0], (1.0 - k) * p[i, 1]
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


@kernel
def weigh(
    rows: Any,
    first: Any,
    second: Any,
    empty: Any,
    viewed: Any,
    known: float,
    dt: float,
    look: float,
    jitter: float,
    most: float,
    hidden: float,
    missing: float,
) -> None:
    """Take the evidence of one scan into the hypotheses.

    Args:
        rows: (n,) hypotheses.
        first: (m,) evidence of each cluster as the better leg.
        second: (m,) as the other one.
        empty: (n, 2) whether the laser sees that nothing is where each hypothesis is.
        viewed: (n, 2) where they are in the laser's frame [m].
        known: How far the odometry frame stands still: only then is motion in it a new look.
        dt: Since the last scan [s].
        look: Motion relative to the laser, or in the odometry frame, that counts as one look [m].
        jitter: Less than this is none [m].
        most: Looks that are remembered.
        hidden: Log odds lost a second while unseen [1/s].
        missing: The same where nothing hides it [1/s].
    """
    for i in range(len(rows)):
        a, b = rows["clusters"][i, 0], rows["clusters"][i, 1]
        if a < 0 and b < 0:
            rows["missing"][i] -= dt * (hidden + (missing - hidden) * empty[i, 0])
            continue
        rows["missing"][i] = 0.0
        dx, dy = viewed[i, 0] - rows["viewed"][i, 0], viewed[i, 1] - rows["viewed"][i, 1]
        way = np.sqrt(dx * dx + dy * dy)
        dx, dy = rows["x"][i, 0] - rows["stood"][i, 0], rows["x"][i, 1] - rows["stood"][i, 1]
        way = max(way, known * np.sqrt(dx * dx + dy * dy))
        if way < jitter or rows["swing"][i] < jitter:  # the second may be a part of the robot
            continue
        value = max(first[a], first[b]) + min(second[a], second[b]) if a >= 0 and b >= 0 else first[max(a, b)]
        weight = min(way / look, 1.0)
        looks = rows["looks"][i] + weight
        rows["evidence"][i] += weight / looks * (value - rows["evidence"][i])
        rows["looks"][i] = min(looks, most)
        rows["viewed"][i, 0], rows["viewed"][i, 1] = viewed[i, 0], viewed[i, 1]
        rows["stood"][i, 0], rows["stood"][i, 1] = rows["x"][i, 0], rows["x"][i, 1]


@kernel
def log_odds(rows: Any, prior: float, alike: float, moved: float, stride: float) -> Any:
    """Return (n,) the log odds that each is a person.

    Looks at one thing are `alike` (intraclass correlation); what has `moved` is likelier a person by as much.
    """
    out = np.empty(len(rows))
    for i in range(len(rows)):
        n = rows["looks"][i]
        out[i] = prior + n / (1.0 + alike * max(n - 1.0, 0.0)) * rows["evidence"][i]
        n = rows["moved"][i] / stride
        out[i] += n / (1.0 + alike * max(n - 1.0, 0.0)) * moved + rows["missing"][i]
    return out


@kernel
def fresh_clusters(rows: Any, z: Any, order: Any, able: Any, merge: float, own: float) -> Any:
    """Return (k, 2) clusters that begin new hypotheses, and the nearest that may be the other leg of each or -1.

    Args:
        rows: (n,) hypotheses, with their clusters.
        z: (m, 2) clusters [m].
        order: (m,) rows of the clusters, the surest leg first.
        able: (m,) whether each may begin a hypothesis; overwritten.
        merge: None begins so near to a hypothesis [m].
        own: Nor so near to a person; two legs of one person are no farther apart [m].
    """
    for i in range(len(rows)):
        limit = own if rows["id"][i] >= 0 else merge
        for j in range(len(z)):
            dx, dy = z[j, 0] - rows["x"][i, 0], z[j, 1] - rows["x"][i, 1]
            if dx * dx + dy * dy < limit * limit or j == rows["clusters"][i, 0] or j == rows["clusters"][i, 1]:
                able[j] = False
    found = np.empty((len(z), 2), np.int64)
    count = 0
    for j in order:
        if not able[j]:
            continue
        able[j] = False
        mate, nearest = -1, own
        for k in range(len(z)):
            apart = np.sqrt((z[k, 0] - z[j, 0]) ** 2 + (z[k, 1] - z[j, 1]) ** 2)
            if able[k] and apart < nearest:
                mate, nearest = k, apart
        if mate >= 0:
            able[mate] = False
        found[count, 0], found[count, 1] = j, mate
        count += 1
    return found[:count]


@kernel
def without_duplicates(rows: Any, odds: Any, merge: float, own: float) -> Any:
    """Return (n,) which hypotheses stay where two are nearer than `merge` [m], or one than `own` to a person.

    People stay before others, and likelier ones, by `odds` (n,), before others.
    """
    keep = np.ones(len(rows), np.bool_)
    for i in range(len(rows)):
        for j in range(len(rows)):
            known_i, known_j = rows["id"][i] >= 0, rows["id"][j] >= 0
            if i == j or (known_j and not known_i) or (known_i == known_j and (odds[j], i) > (odds[i], j)):
                continue
            limit = merge if known_i == known_j else own
            dx, dy = rows["x"][i, 0] - rows["x"][j, 0], rows["x"][i, 1] - rows["x"][j, 1]
            if keep[i] and dx * dx + dy * dy < limit * limit:
                keep[j] = False
    return keep
