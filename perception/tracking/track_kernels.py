"""Numba kernels of the tracks; `tests/reference/tracking_reference.py` says the same in numpy.

One scan touches a dozen tracks: what costs is not the sums but the calls, and the code that they drag through the
caches. Arrays are written in place; columns of `x` and `p` are those of kalman.py.
"""

import numpy as np

from ...slam.view_kernel import inner_kernel, kernel


@kernel
def length(x, y):
    """Return the length of the vector (x, y)."""
    return np.sqrt(x**2 + y**2)


@kernel
def distance(x, y, u, v):
    """Return the distance between (x, y) and (u, v)."""
    return np.sqrt((x - u) * (x - u) + (y - v) * (y - v))


@kernel
def predict(x, p, age_s, unseen_s, dt, q):
    """Move states `x` (n, 4) and covariances `p` (n, 3) `dt` seconds ahead, and both clocks (n,)."""
    for i in range(len(x)):
        x[i, 0] += dt * x[i, 2]
        x[i, 1] += dt * x[i, 3]
        a, b, c = p[i, 0], p[i, 1], p[i, 2]
        p[i, 0] = a + 2.0 * dt * b + dt * dt * c + q
        p[i, 1] = b + dt * c
        p[i, 2] = c + q
        age_s[i] += dt
        unseen_s[i] += dt


@inner_kernel
def _correct_one(x, p, i, u, v, r):
    a, b, c = p[i, 0], p[i, 1], p[i, 2]
    k_position, k_velocity = a / (a + r), b / (a + r)
    du, dv = u - x[i, 0], v - x[i, 1]
    x[i, 0] += k_position * du
    x[i, 1] += k_position * dv
    x[i, 2] += k_velocity * du
    x[i, 3] += k_velocity * dv
    p[i, 0] = (1.0 - k_position) * a
    p[i, 1] = (1.0 - k_position) * b
    p[i, 2] = c - k_velocity * b


@kernel
def correct_legs(legs, match, z, d, r, gain):
    """Correct leg tracks (n,) of `LEG` with detections `z` (m, 2), `d` (m,); `match` (n,) is a detection or -1."""
    x, p = legs["x"], legs["p"]
    confidence, unseen_s = legs["confidence"], legs["unseen_s"]
    seen, low, high = legs["seen"], legs["low"], legs["high"]
    for i in range(len(legs)):
        confidence[i] *= 1.0 - gain
        j = match[i]
        if j < 0:
            continue
        confidence[i] += gain * d[j]
        _correct_one(x, p, i, z[j, 0], z[j, 1], r)
        unseen_s[i] = 0.0
        for k in range(2):
            seen[i, k] = z[j, k]
            low[i, k] = min(low[i, k], z[j, k])
            high[i, k] = max(high[i, k], z[j, k])


@kernel
def correct_people(people, seen, centre, confidence, variance, gain):
    """Correct `people` (n,) of `PERSON` where `seen`, at `centre` (n, 2) with `variance` (n,); eq. 6 for all."""
    x, p = people["x"], people["p"]
    believed, unseen_s = people["confidence"], people["unseen_s"]
    for i in range(len(people)):
        believed[i] += gain * (confidence[i] - believed[i])
        if seen[i]:
            _correct_one(x, p, i, centre[i, 0], centre[i, 1], variance[i])
            unseen_s[i] = 0.0


@kernel
def measure_people(offset, match, z, d, seen, one_leg, centre, confidence):
    """Write what `match` (n, 2) says of each person into the last four (n,), (n,), (n, 2), (n,); keep `offset`."""
    for i in range(len(match)):
        first, second = match[i, 0], match[i, 1]
        seen[i] = first >= 0 or second >= 0
        one_leg[i] = (first >= 0) != (second >= 0)
        if not seen[i]:
            continue
        if one_leg[i]:
            alone, side = (first, 1.0) if first >= 0 else (second, -1.0)
            for k in range(2):
                centre[i, k] = z[alone, k] - side * offset[i, k]
            confidence[i] = d[alone]
        else:
            for k in range(2):
                offset[i, k] = (z[first, k] - z[second, k]) / 2.0
                centre[i, k] = (z[first, k] + z[second, k]) / 2.0
            confidence[i] = (d[first] + d[second]) / 2.0


@kernel
def leg_costs(legs, centres, z, reach, anchor_s, gates, cost):
    """Write into `cost` (n, m) how far detections `z` (m, 2) are from the leg tracks; inf beyond `gates` (n,).

    A track that was seen within `anchor_s` may be met where it was last seen, too. The first 2 k tracks are the legs of
    people at `centres` (k, 2), who reach no farther than `reach`.
    """
    x, seen, unseen_s = legs["x"], legs["seen"], legs["unseen_s"]
    for i in range(len(legs)):
        for j in range(len(z)):
            away = distance(x[i, 0], x[i, 1], z[j, 0], z[j, 1])
            if unseen_s[i] <= anchor_s:
                away = min(away, distance(seen[i, 0], seen[i, 1], z[j, 0], z[j, 1]))
            owner = i // 2
            beyond = away >= gates[i]
            if not beyond and owner < len(centres):
                beyond = distance(centres[owner, 0], centres[owner, 1], z[j, 0], z[j, 1]) > reach
            cost[i, j] = np.inf if beyond else away


@kernel
def distances(here, there):
    """Return (n, m) Euclidean distances between positions (n, 2) and (m, 2)."""
    away = np.empty((len(here), len(there)))
    for i in range(len(here)):
        for j in range(len(there)):
            away[i, j] = distance(here[i, 0], here[i, 1], there[j, 0], there[j, 1])
    return away


@kernel
def average_apart(x, age_s, apart, dt, stride_s):
    """Take the present vectors between tracks at `x` (n, 4) into their running means `apart` (n, n, 2)."""
    for i in range(len(x)):
        for j in range(len(x)):
            together_s = min(age_s[i], age_s[j])
            weight = min(max(dt / stride_s, dt / max(together_s, dt)), 1.0)
            for k in range(2):
                apart[i, j, k] += weight * ((x[i, k] - x[j, k]) - apart[i, j, k])


@kernel
def any_wide(apart, pairs, limit):
    """Return whether the mean vector between the tracks of any of `pairs` (n, 2) is longer than `limit`."""
    for i in range(len(pairs)):
        a, b = pairs[i, 0], pairs[i, 1]
        if np.sqrt(apart[a, b, 0] ** 2 + apart[a, b, 1] ** 2) > limit:
            return True
    return False


@inner_kernel
def _humans_near(points, first, end, humans, zeta, near):
    """Write into `near` which of `humans` (h, 2) are no farther than `zeta` from the box of the points; how many."""
    low_x, low_y, high_x, high_y = np.inf, np.inf, -np.inf, -np.inf
    for i in range(first, end):
        low_x, high_x = min(low_x, points[i, 0]), max(high_x, points[i, 0])
        low_y, high_y = min(low_y, points[i, 1]), max(high_y, points[i, 1])
    reach, count = 1.01 * zeta, 0  # whatever the last bits of a distance
    for h in range(len(humans)):
        x, y = humans[h, 0], humans[h, 1]
        if low_x - reach <= x <= high_x + reach and low_y - reach <= y <= high_y + reach:
            near[count] = h
            count += 1
    return count


@kernel
def points_of_things(points, start, end, thing, humans, zeta):
    """Return (j, 2) those of `points` (k, 2) in the clusters `thing` (m,), farther than `zeta` from `humans` (h, 2)."""
    kept, near = np.empty_like(points), np.empty(len(humans), np.int64)
    count = 0
    for c in range(len(start)):
        if not thing[c]:
            continue
        close = _humans_near(points, start[c], end[c], humans, zeta, near)
        for i in range(start[c], end[c]):
            clear = True
            for h in near[:close]:
                if distance(points[i, 0], points[i, 1], humans[h, 0], humans[h, 1]) <= zeta:
                    clear = False
                    break
            if clear:
                kept[count, 0] = points[i, 0]
                kept[count, 1] = points[i, 1]
                count += 1
    return kept[:count]


@inner_kernel
def put(values, where, out):
    """Write `values` (k,) into `out` (n,) `where` (n,) says so: `out[where] = values`, which takes long to compile."""
    count = 0
    for i in range(len(where)):
        if where[i]:
            out[i] = values[count]
            count += 1


@kernel
def any_moved(legs, first, least, c_min, unseen_s):
    """Return whether any of `legs` from row `first` on, believed in and seen within `unseen_s`, moved `least` [m]."""
    low, high, confidence, unseen = legs["low"], legs["high"], legs["confidence"], legs["unseen_s"]
    for i in range(first, len(legs)):
        if confidence[i] > c_min and unseen[i] <= unseen_s:
            width, height = high[i, 0] - low[i, 0], high[i, 1] - low[i, 1]
            if np.sqrt(width**2 + height**2) >= least:
                return True
    return False


@kernel
def any_sure_walker(legs, first, least, sure, age_s):
    """Return whether any of `legs` from row `first` on, seen now and for `age_s`, is `sure` and moved `least` [m]."""
    low, high, confidence = legs["low"], legs["high"], legs["confidence"]
    unseen, age = legs["unseen_s"], legs["age_s"]
    for i in range(first, len(legs)):
        if unseen[i] == 0.0 and age[i] >= age_s and confidence[i] >= sure:
            width, height = high[i, 0] - low[i, 0], high[i, 1] - low[i, 1]
            if np.sqrt(width**2 + height**2) >= least:
                return True
    return False


@kernel
def surviving(tracks, epsilon, c_min):
    """Return (n,) which of `tracks` are certain enough of their place and believed in."""
    p, confidence = tracks["p"], tracks["confidence"]
    lives = np.empty(len(tracks), np.bool_)
    for i in range(len(tracks)):
        lives[i] = p[i, 0] <= epsilon and confidence[i] >= c_min
    return lives


@kernel
def spread_among(apart, x, rows, farthest):
    """Return (k, k) lengths of the mean vectors `apart` (n, n, 2) between the tracks `rows` (k,) of states `x` (n, 4).

    Infinite on the diagonal and between tracks that are now farther apart than `farthest`.
    """
    spread = np.empty((len(rows), len(rows)))
    for i in range(len(rows)):
        for j in range(len(rows)):
            a, b = rows[i], rows[j]
            if i == j or distance(x[a, 0], x[a, 1], x[b, 0], x[b, 1]) > farthest:
                spread[i, j] = np.inf
            else:
                spread[i, j] = np.sqrt(apart[a, b, 0] ** 2 + apart[a, b, 1] ** 2)
    return spread
