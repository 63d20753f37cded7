"""A corridor of 40 m with cupboards, no two alike, and drives along it with a laser that sees five metres."""

import numpy as np
from tagalong.slam.geometry import between, compose
from walls import cast

REACH = 5.0  # [m] of the laser


def box(x, y, wide, tall):
    return [
        (x, y, x + wide, y),
        (x + wide, y, x + wide, y + tall),
        (x + wide, y + tall, x, y + tall),
        (x, y + tall, x, y),
    ]


def corridor():
    """Return (k, 4) walls of a corridor of 40 m in which cupboards stand on both sides, no two alike."""
    rng, lines = np.random.default_rng(3), box(0.0, -1.5, 40.0, 3.0)
    for x in np.arange(0.6, 39.0, 1.3):
        deep = rng.uniform(0.2, 0.8)
        lines += box(x + rng.uniform(0.0, 0.4), rng.choice([-1.5, 1.5 - deep]), rng.uniform(0.3, 0.8), deep)
    return np.array(lines)


LINES = corridor()


def along(first, last):
    """Return true poses, 0.1 m apart, from x = `first` to x = `last` [m], looking ahead."""
    x = np.linspace(first, last, round(abs(last - first) / 0.1) + 1)
    heading = 0.0 if last > first else np.pi
    return np.stack((x, 0.1 * np.sin(x), np.full(len(x), heading)), axis=-1)


def drive(engine, segments, slips):
    """Feed scans at the true poses of `segments`; the odometry errs by `slips` (3,) from one to the next.

    Returns updates, (n, 3) true poses and (n, 3) odometry.
    """
    rng, truth, odometry, updates = np.random.default_rng(0), np.concatenate(segments), [segments[0][0]], []
    starts = np.cumsum([len(segment) for segment in segments]).tolist()
    for k, pose in enumerate(truth):
        if k:
            motion = between(truth[k - 1], pose)
            odometry.append(compose(odometry[-1], compose(motion, slips) if k in starts else motion))
        updates.append(engine.update(odometry[-1], cast(LINES, pose, rng, REACH)))
    return updates, truth, np.array(odometry)
