"""Frames of upright cut-outs before a wall, on a floor."""

import numpy as np
from tagalong.perception.rgbd.frame import Pinhole, RgbdFrame
from tagalong.perception.rgbd.heads import HeadConfig, find_candidates
from tagalong.perception.rgbd.planes import PlaneFinder

CAMERA = Pinhole(width=128, height=106, horizontal_fov=np.radians(70.0), vertical_fov=np.radians(60.0))


def standing(*figures, wall=6.0):
    """A frame of upright cut-outs (distance, left edge, right edge, bottom, top) [m] before a wall, on a floor."""
    rays = CAMERA.rays
    depth = np.full(rays.shape[:2], wall)
    floor = rays[..., 2] < -1.0 / wall
    depth[floor] = -1.0 / rays[..., 2][floor]
    colour = np.full((*depth.shape, 3), 150, dtype=np.uint8)
    for number, (away, right, left, bottom, top) in enumerate(figures):
        y, z = rays[..., 1] * away, rays[..., 2] * away + 1.0
        inside = (y > right) & (y < left) & (z > bottom) & (z < top) & (depth > away)
        depth[inside], colour[inside] = away, 40 * number
    return RgbdFrame(depth.astype(np.float32), colour, CAMERA, 0.0)


def candidates(frame, **config):
    return find_candidates(PlaneFinder().find(frame), HeadConfig(**config))


def person(away, y, top=1.75):
    """Head and body of a cut-out."""
    return (away, y - 0.09, y + 0.09, 1.4, top), (away, y - 0.22, y + 0.22, 0.1, 1.45)
