"""Drives in a small room with a laser that measures one beam after the other."""

import numpy as np
from tagalong.slam import LaserScan, RecordedDrive
from tagalong.slam.geometry import compose, inverse, part_of, transform_points

CORNERS = np.array(
    [[-3.0, -2.0], [1.0, -2.0], [1.0, -3.0], [4.0, -3.0], [4.0, 2.5], [0.5, 2.5], [0.5, 3.5], [-3.0, 3.5]]
)
"""Of a room, in order [m]."""
MOUNT = (0.1, 0.0, 0.2)


def seen_from(lasers, bearings):
    """Return (n,) ranges in the room from `lasers` (n, 3) along `bearings` (n,) [m]."""
    angles = lasers[:, 2] + bearings
    directions, edges = np.stack((np.cos(angles), np.sin(angles)), axis=-1), np.roll(CORNERS, -1, axis=0) - CORNERS
    across = directions[:, None, 0] * edges[:, 1] - directions[:, None, 1] * edges[:, 0]
    offset = CORNERS - lasers[:, None, :2]
    with np.errstate(divide="ignore", invalid="ignore"):
        away = (offset[..., 0] * edges[:, 1] - offset[..., 1] * edges[:, 0]) / across
        along = (offset[..., 0] * directions[:, None, 1] - offset[..., 1] * directions[:, None, 0]) / across
    return np.where((away > 0.0) & (along >= 0.0) & (along <= 1.0), away, np.inf).min(axis=1)


def drive_with(time, beams=120, scans=80, swing=0.7):
    """Return a drive that turns to and fro, with a phase of `swing` [rad] a scan, beams measured as `time` says."""
    rng = np.random.default_rng(3)
    bearings = np.linspace(-np.pi, np.pi, beams, endpoint=False)
    poses, taken = np.zeros((scans + 1, 3)), []
    shares, before = np.zeros(beams), (0.0, 0.0, 0.0)
    if time:
        shares = time.of(LaserScan(np.ones(beams), bearings, 0.05, 20.0, 0.0, MOUNT))
    for k in range(scans):
        step = (0.03, 0.0, 0.3 * np.sin(swing * k) + 0.05)
        poses[k + 1] = compose(poses[k], step)
        way = inverse(before) if time and time.ended else step
        lasers = np.array([compose(compose(poses[k], part_of(way, share)), MOUNT) for share in shares])
        before = step
        ranges = seen_from(lasers, bearings) + rng.normal(0.0, 0.005, beams)
        taken.append(LaserScan(ranges, bearings, 0.05, 20.0, 0.2 * k, MOUNT))
    return RecordedDrive(poses[:-1], taken, None, "room")


def off_walls(drive):
    """Return how far, in the 90th percentile, the points of a drive lie from the walls of the room [m]."""
    points = np.concatenate(
        [transform_points(compose(T, MOUNT), scan.points) for T, scan in zip(drive.odometry, drive.scans, strict=True)]
    )
    edges = np.roll(CORNERS, -1, axis=0) - CORNERS
    offset = points[:, None] - CORNERS
    along = np.clip((offset * edges).sum(axis=-1) / (edges * edges).sum(axis=-1), 0.0, 1.0)
    return np.percentile(np.linalg.norm(offset - along[..., None] * edges, axis=-1).min(axis=1), 90)
