"""A plane with round posts, a robot that goes round, wheels with systematic errors: known answers for landmark SLAM."""

import numpy as np
from tagalong.slam import LaserScan
from tagalong.slam.geometry import between, compose, inverse, transform_points

BEARINGS = np.linspace(-np.pi / 2, np.pi / 2, 181)
RADIUS = 0.1


def cast(pose, posts, rng, range_max=8.0, sigma=0.01, bearings=BEARINGS):
    """Return the scan (181 beams, 180 deg, or along `bearings`) of `posts` (k, 2) of 0.1 m radius from `pose` (3,)."""
    places = transform_points(inverse(pose), posts)
    along = np.cos(bearings)[:, None] * places[:, 0] + np.sin(bearings)[:, None] * places[:, 1]
    beside = (places**2).sum(axis=1) - along**2
    hit = (beside < RADIUS**2) & (along > 0.0)
    ranges = np.where(hit, along - np.sqrt(np.maximum(RADIUS**2 - beside, 0.0)), np.inf).min(axis=1, initial=np.inf)
    ranges = np.where(ranges <= range_max, ranges + sigma * rng.standard_normal(len(ranges)), np.inf)
    return LaserScan(ranges, bearings, 0.1, range_max)


def circle_path(radius=6.0, laps=1.8, step=0.1):
    """Return (n, 3) poses round a circle, heading along it."""
    angle = np.arange(0.0, laps * 2 * np.pi, step / radius)
    return np.stack((radius * np.cos(angle), radius * np.sin(angle), angle + np.pi / 2), axis=-1)


def draw_posts(rng, count, path, gap=None):
    """Return (count, 2) posts, 0.5 m or more off the path and 1.5 m apart; `gap` (2,) angles without any."""
    posts = np.zeros((0, 2))
    while len(posts) < count:
        place = rng.uniform(-11.0, 11.0, 2)
        angle = np.arctan2(place[1], place[0]) % (2 * np.pi)
        apart = np.hypot(*(posts - place).T).min(initial=np.inf)
        off = np.hypot(*(path[:, :2] - place).T).min()
        if apart > 1.5 and off > 0.5 and not (gap is not None and gap[0] < angle < gap[1]):
            posts = np.vstack((posts, place))
    return posts


def typical_wheels(path, rng):
    """Return (n, 3) odometry along `path` with 2 % scale, 2 % turn, 0.15 deg/m drift and noise; starts at zero."""
    scale, turn_scale, drift = rng.uniform(-1, 1, 3) * [0.02, 0.02, np.radians(0.15)]
    odometry = [np.zeros(3)]
    for u, v, turn in between(path[:-1], path[1:]):
        way = np.hypot(u, v)
        sigma_way = np.sqrt(0.01**2 * way + 0.004**2 * abs(turn))
        sigma_turn = np.sqrt(np.radians(0.8) ** 2 * abs(turn) + np.radians(0.3) ** 2 * way)
        n = rng.standard_normal(3)
        step = [
            (1 + scale) * u + sigma_way * n[0],
            (1 + scale) * v + 0.25 * sigma_way * n[1],
            (1 + turn_scale) * turn + drift * way + sigma_turn * n[2],
        ]
        odometry.append(compose(odometry[-1], step))
    return np.array(odometry)
