"""Tracks as a tracker that errs would have them: made of the truth and of what the laser can see, scan by scan."""

import math

import numpy as np
from numpy.typing import NDArray

from ...slam.draws import Words, normal, uniform
from ...slam.view_kernel import inner_view_kernel, view_kernel
from .errors import BORN, DOUBT, FOUND, LOST, MISSED, PLACE, SECOND, TrackerErrors

Array = NDArray[np.float64]

PHASE, UNSEEN_S, TRUST, X, Y, VX, VY, ERROR_X, ERROR_Y, ERROR_VX, ERROR_VY = range(11)
LAGGED_X, LAGGED_Y, BODY, STANDS, WAY_X, WAY_Y, SEEN_S = range(11, 18)
"""Columns of a track: `UNKNOWN`, `SEEN` or `UNSEEN`; time since it was seen [s]; confidence; place [m] and motion
[m/s] in the world; errors of both, over their standard deviations; the person's velocity as a slow filter has it
[m/s]; row of the person whose track it is; whether a false one stays where it is; how far the person has come in
sight [m]; for how long it has been seen without a break [s]."""
COLUMNS = 18
UNKNOWN, SEEN, UNSEEN = 0.0, 1.0, 2.0
"""Phases of a track."""
SWAP_M = 1.0
"""People are taken for each other within this distance [m]."""
LEG_M = 0.12
"""Width of a leg, for which beams are counted [m]."""
BODY_HALF_M = 0.2
"""Half of the width that both legs take [m]."""
NEARER_M = 0.4
"""What is nearer to the laser than somebody by this hides them [m]."""
ENOUGH_LOG2 = 2.0
"""Beams on a leg beyond which more of them tell little, as a logarithm to base 2."""
WALKING_MPS = 0.5
"""Speed beyond which people move as much between scans as a tracker asks for [m/s]."""
LONG_LOG2 = 5.0
"""Half a minute of being seen: more of it tells nothing."""
WAY_M = 0.5
"""A way beyond which more of it tells nothing: a stride is motion of its own (`EvidenceConfig.least_way`) [m]."""
OUT_OF_SIGHT = 0.9
"""Who is hidden by more than this share is out of sight."""
FARTHEST_M = 10.0
"""Nobody becomes known beyond this [m]."""
THING_M = 4.0
"""Things are taken for people within this distance [m]."""

_TAU = 2.0 * np.pi


@view_kernel
def rows_for(people: int) -> int:
    """Return how many tracks there are for `people`: theirs, a second one of each, and a thing."""
    return 2 * people + 1


@view_kernel
def forget(tracks: Array) -> None:
    """Begin anew: nobody is known."""
    tracks[:] = 0.0
    for i in range(len(tracks)):
        tracks[i, BODY] = i


@view_kernel
def hidden_share(distance: float, bearing: float, ranges: Array, first: float, spacing: float) -> float:
    """Return the share of the beams towards somebody that do not come there.

    Args:
        distance: From the laser [m].
        bearing: In the laser's axes [rad].
        ranges: (n,) of the sweep [m].
        first: Bearing of the first beam [rad].
        spacing: Between two beams [rad].
    """
    half = BODY_HALF_M / max(distance, 0.3)
    begin = ((bearing - half - first) % _TAU) / spacing
    low, high = np.int64(math.ceil(begin)), np.int64(math.floor(begin + 2.0 * half / spacing))
    round_ = np.int64(math.floor(_TAU / spacing + 0.5))
    free = 0
    for j in range(low, high + 1):
        k = j if j < len(ranges) else j - round_
        if 0 <= k < len(ranges) and not ranges[k] < distance - NEARER_M:
            free += 1
    return 1.0 - min(free / max(high - low + 1, 1), 1.0)


@view_kernel
def seen(
    place: Array, speed: float, pose: Array, ranges: Array, laser: tuple[float, float, float, float]
) -> tuple[float, float, float, float, float, float]:
    """Return how somebody is seen: the columns `SIGHT` but for the first and the last.

    Distance [m]; logarithm to base 2 of the beams that a leg gets there, at most `ENOUGH_LOG2`; share of the beams
    towards them that do not come there; whether they are out of sight, 0 or 1; how far from straight ahead [rad];
    their speed, at most `WALKING_MPS`.

    Args:
        place: (2,) in the world [m].
        speed: [m/s].
        pose: (3,) T_world_robot.
        ranges: (n,) of the sweep [m].
        laser: Its place in the robot's axes [m], bearing of its first beam there, and spacing [rad].
    """
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    x, y = place[0] - pose[0], place[1] - pose[1]
    ahead, aside = cos * x + sin * y - laser[0], cos * y - sin * x - laser[1]
    distance, bearing = math.sqrt(ahead * ahead + aside * aside), math.atan2(aside, ahead)
    hidden = hidden_share(distance, bearing, ranges, laser[2], laser[3])
    beams = min(np.log2(LEG_M / (max(distance, 0.3) * laser[3])), ENOUGH_LOG2)
    out_of_sight = 1.0 if hidden > OUT_OF_SIGHT else 0.0
    return distance, beams, hidden, out_of_sight, abs(bearing), min(speed, WALKING_MPS)


@view_kernel
def come_on(way: Array, motion: Array, sight: tuple[float, float, float, float, float, float], dt: float) -> None:
    """Bring how far somebody has come in sight (2,) [m] to the present scan, at most `WAY_M`.

    The farther legs have come that a tracker follows, the sooner it knows a person: the way is what remains of the
    past. It counts as far as the person is not hidden.

    Args:
        way: Updated.
        motion: (2,) velocity [m/s].
        sight: How the person is seen, see `seen`.
        dt: Since the last scan [s].
    """
    gain = 0.0 if sight[3] > 0.0 else dt * (1.0 - sight[2])
    x, y = way[0] + gain * motion[0], way[1] + gain * motion[1]
    longer = max(math.sqrt(x * x + y * y) / WAY_M, 1.0)
    way[0], way[1] = x / longer, y / longer


@view_kernel
def quantity(
    row: int,
    errors: TrackerErrors,
    sight: tuple[float, float, float, float, float, float],
    off: float,
    seen_log2: float,
    way: float = 0.0,
) -> float:
    """Return the quantity `row` for somebody who is seen so; the last three columns of `SIGHT` stand by themselves."""
    w = errors.weights[row]
    return math.exp(
        w[0] + w[1] * sight[0] + w[2] * sight[1] + w[3] * sight[2] + w[4] * sight[3] + w[5] * sight[4]
        + w[6] * sight[5] + w[7] * off + w[8] * seen_log2 + w[9] * way
    )  # fmt: skip


@view_kernel
def seen_for(seen_s: float) -> float:
    """Return for how long somebody has been seen without a break as a logarithm, 0 for a moment, at most `LONG_LOG2`.

    Who has been seen for long goes on being seen, at the same place in the same light: there is more to it than a
    scan's `seen` tells.
    """
    return min(np.log2(1.0 + seen_s), LONG_LOG2)


@inner_view_kernel
def _happens(rate: float, dt: float, random: Words) -> bool:
    expected = rate * dt
    if expected <= 0.0:
        return False
    lot = uniform(random)
    return lot < expected and lot < 1.0 - math.exp(-expected)  # the first is quick, and mostly enough


@view_kernel
def track_people(
    dt: float,
    pose: Array,
    position: Array,
    velocity: Array,
    ranges: Array,
    laser: tuple[float, float, float, float],
    errors: TrackerErrors,
    random: Words,
    tracks: Array,
) -> None:
    """Bring the tracks to the present scan.

    Args:
        dt: Since the last one [s]; 0 for the first.
        pose: (3,) T_world_robot.
        position: (n, 2) true people in the world [m].
        velocity: (n, 2) [m/s].
        ranges: (beams,) of the sweep [m].
        laser: As in `seen`.
        errors: What the tracker gets wrong.
        random: (1,) state of the random numbers.
        tracks: (2 n + 1, COLUMNS) of the people, of their second tracks, and of a thing; updated.
    """
    n = len(position)
    keeps = math.exp(-dt / errors.place_s), math.exp(-dt / errors.motion_s), math.exp(-dt / errors.motion_lag_s)
    _swap(dt, position, errors, random, tracks[:n])
    for i in range(n):
        track, body = tracks[i], int(tracks[i, BODY])
        place, motion = position[body], velocity[body]
        x, y = place[0] - pose[0], place[1] - pose[1]
        if track[PHASE] == UNKNOWN and x * x + y * y > FARTHEST_M * FARTHEST_M:
            track[WAY_X], track[WAY_Y] = 0.0, 0.0
            continue
        speed = math.sqrt(motion[0] * motion[0] + motion[1] * motion[1])
        sight = seen(place, speed, pose, ranges, laser)
        come_on(track[WAY_X : WAY_Y + 1], motion, sight, dt)
        _track_person(dt, place, motion, sight, errors, keeps, random, track)
        alone = track[PHASE] == SEEN and tracks[n + i, PHASE] == UNKNOWN
        if alone and _happens(quantity(SECOND, errors, sight, 0.0, 0.0), dt, random):
            _begin_second(track, errors, random, tracks[n + i])
    _move_seconds(dt, n, position, errors, random, tracks)
    _thing(dt, pose, ranges, laser, errors, random, tracks[2 * n])


@inner_view_kernel
def _track_person(
    dt: float,
    place: Array,
    motion: Array,
    sight: tuple[float, float, float, float, float, float],
    errors: TrackerErrors,
    keeps: tuple[float, float, float],
    random: Words,
    track: Array,
) -> None:
    """Bring a person's track to the present scan; of errors of place and motion, and of the lag, `keeps` is kept."""
    before = track[PHASE]
    off = math.sqrt((track[X] - place[0] + dt * motion[0]) ** 2 + (track[Y] - place[1] + dt * motion[1]) ** 2)
    track[PHASE] = _next_phase(track, dt, errors, sight, off, random)
    if track[PHASE] == UNKNOWN:
        return
    track[SEEN_S] = track[SEEN_S] + dt if track[PHASE] == before else 0.0
    if before == UNKNOWN:
        _begin(place, motion, random, track)
    else:
        _drift(track, keeps[0], keeps[1], random)
        track[LAGGED_X] += (1.0 - keeps[2]) * (motion[0] - track[LAGGED_X])
        track[LAGGED_Y] += (1.0 - keeps[2]) * (motion[1] - track[LAGGED_Y])
    if track[PHASE] == SEEN:
        _believe(place, motion, errors, sight, track)
        return
    if before == SEEN:
        track[VX] += errors.unseen_mps * normal(random)
        track[VY] += errors.unseen_mps * normal(random)
    track[X] += dt * track[VX]
    track[Y] += dt * track[VY]
    track[UNSEEN_S] += dt


@inner_view_kernel
def _next_phase(
    track: Array,
    dt: float,
    errors: TrackerErrors,
    sight: tuple[float, float, float, float, float, float],
    off: float,
    random: Words,
) -> float:
    """Return the phase of a track after `dt` [s] in which its person is seen so and was so far `off` it [m]."""
    if track[PHASE] == UNKNOWN:
        way = math.sqrt(track[WAY_X] * track[WAY_X] + track[WAY_Y] * track[WAY_Y])
        return SEEN if _happens(quantity(BORN, errors, sight, 0.0, 0.0, way), dt, random) else UNKNOWN
    if track[PHASE] == SEEN:
        return UNSEEN if _happens(quantity(MISSED, errors, sight, off, seen_for(track[SEEN_S])), dt, random) else SEEN
    found, lost = quantity(FOUND, errors, sight, off, 0.0), quantity(LOST, errors, sight, off, 0.0)
    if not _happens(found + lost, dt, random):
        return UNSEEN if track[UNSEEN_S] + 0.5 * dt < errors.longest_unseen_s else UNKNOWN
    return SEEN if uniform(random) * (found + lost) < found else UNKNOWN


@inner_view_kernel
def _begin(place: Array, motion: Array, random: Words, track: Array) -> None:
    track[X], track[Y] = place[0], place[1]
    for k in range(ERROR_X, ERROR_VY + 1):
        track[k] = normal(random)
    track[LAGGED_X], track[LAGGED_Y] = motion[0], motion[1]


@inner_view_kernel
def _drift(track: Array, keep_place: float, keep_motion: float, random: Words) -> None:
    """Let the errors go on; they keep so much of what they were."""
    for k in range(ERROR_X, ERROR_VY + 1):
        keep = keep_place if k < ERROR_VX else keep_motion
        track[k] = keep * track[k] + math.sqrt(1.0 - keep * keep) * normal(random)


@inner_view_kernel
def _believe(
    place: Array,
    motion: Array,
    errors: TrackerErrors,
    sight: tuple[float, float, float, float, float, float],
    track: Array,
) -> None:
    """Write what is believed of a person who is seen."""
    sigma = quantity(PLACE, errors, sight, 0.0, 0.0)
    track[X] = place[0] - errors.delay_s * motion[0] + sigma * track[ERROR_X]
    track[Y] = place[1] - errors.delay_s * motion[1] + sigma * track[ERROR_Y]
    track[VX] = track[LAGGED_X] + errors.motion_mps * track[ERROR_VX]
    track[VY] = track[LAGGED_Y] + errors.motion_mps * track[ERROR_VY]
    track[TRUST], track[UNSEEN_S] = max(1.0 - quantity(DOUBT, errors, sight, 0.0, 0.0), 0.0), 0.0


@inner_view_kernel
def _swap(dt: float, position: Array, errors: TrackerErrors, random: Words, tracks: Array) -> None:
    """Take people for each other who are near each other, and each for who they are again after a while."""
    for i in range(len(tracks)):
        a = int(tracks[i, BODY])
        for j in range(i):
            b = int(tracks[j, BODY])
            if a != i and b == i:
                rate = 1.0 / errors.swapped_s
            elif tracks[i, PHASE] == SEEN and tracks[j, PHASE] == SEEN:
                near = math.hypot(position[a, 0] - position[b, 0], position[a, 1] - position[b, 1]) < SWAP_M
                rate = errors.swap_per_s if near else 0.0
            else:
                rate = 0.0
            if _happens(rate, dt, random):
                tracks[i, BODY], tracks[j, BODY] = b, a
                a = b


@inner_view_kernel
def _begin_second(own: Array, errors: TrackerErrors, random: Words, track: Array) -> None:
    """Begin a second track of the person with the track `own`; its offset is kept in `ERROR_X`, `ERROR_Y` [m]."""
    track[PHASE], track[TRUST], track[BODY] = SEEN, errors.false_confidence, own[BODY]
    track[STANDS] = 1.0 if uniform(random) < errors.second_stands else 0.0
    track[ERROR_X], track[ERROR_Y] = errors.second_m * normal(random), errors.second_m * normal(random)
    track[X], track[Y], track[VX], track[VY] = own[X] + track[ERROR_X], own[Y] + track[ERROR_Y], 0.0, 0.0


@inner_view_kernel
def _move_seconds(dt: float, n: int, position: Array, errors: TrackerErrors, random: Words, tracks: Array) -> None:
    """End second tracks, and let those that do not stand go with their people."""
    for i in range(n):
        track, own = tracks[n + i], tracks[i]
        if track[PHASE] == UNKNOWN:
            continue
        if _happens(1.0 / errors.second_life_s, dt, random):
            track[PHASE] = UNKNOWN
        elif track[STANDS] == 0.0:
            body = int(track[BODY])
            track[X], track[Y] = position[body, 0] + track[ERROR_X], position[body, 1] + track[ERROR_Y]
            track[VX], track[VY] = own[VX], own[VY]


@inner_view_kernel
def _thing(
    dt: float,
    pose: Array,
    ranges: Array,
    laser: tuple[float, float, float, float],
    errors: TrackerErrors,
    random: Words,
    track: Array,
) -> None:
    """Begin and end the track of a thing that is taken for a person: where some beam ends."""
    if track[PHASE] == SEEN:
        if _happens(1.0 / errors.thing_life_s, dt, random):
            track[PHASE] = UNKNOWN
    elif _happens(errors.thing_per_s, dt, random):
        j = int((1.0 - uniform(random)) * len(ranges))
        if ranges[j] < THING_M:
            turn = pose[2] + laser[2] + j * laser[3]
            cos, sin = math.cos(pose[2]), math.sin(pose[2])
            track[PHASE], track[TRUST] = SEEN, errors.false_confidence
            track[X] = pose[0] + cos * laser[0] - sin * laser[1] + ranges[j] * math.cos(turn)
            track[Y] = pose[1] + sin * laser[0] + cos * laser[1] + ranges[j] * math.sin(turn)
            track[VX] = track[VY] = 0.0
