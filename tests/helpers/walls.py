"""Rooms of straight walls, and what a laser sees of them: known answers for matching, SLAM and localization."""

import numpy as np
from tagalong.slam import LaserScan

BEARINGS = np.deg2rad(np.arange(-135.0, 135.0, 1.0))


def cast(lines, pose, rng, reach=20.0, noise=0.01, bearings=BEARINGS):
    """Return the scan of a laser at `pose` (3,) among `lines` (k, 4) x, y, x, y of their ends; beyond `reach`: inf."""
    angles = bearings + pose[2]
    d = np.stack((np.cos(angles), np.sin(angles)), axis=-1)[:, None]
    a, e = lines[None, :, :2] - pose[:2], (lines[:, 2:] - lines[:, :2])[None]
    cross = d[..., 0] * e[..., 1] - d[..., 1] * e[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (a[..., 0] * e[..., 1] - a[..., 1] * e[..., 0]) / cross
        u = (a[..., 0] * d[..., 1] - a[..., 1] * d[..., 0]) / cross
    ranges = np.where((t > 0.0) & (u >= 0.0) & (u <= 1.0), t, np.inf).min(axis=1)
    ranges = ranges + rng.normal(0.0, noise, len(ranges))
    return LaserScan(np.where(ranges > reach, np.inf, ranges), bearings, 0.05, reach)
