"""Cameras to train and to test on: any mount, several fields of view, the noise of several sensors."""

from dataclasses import replace

import numpy as np
from numpy.random import Generator
from scipy.ndimage import gaussian_filter

from ...envs.sensors.camera.config import RgbdConfig
from ...perception.rgbd.frame import RgbdFrame
from .rgbd_props import REACH_M

_VIEWS = ((70.0, 60.0, 128, 106), (58.0, 45.0, 160, 120), (58.0, 45.0, 128, 96), (80.0, 56.0, 128, 80))
"""Fields of view [deg] and pixels: Kinect V2, Kinect V1 and Xtion, active stereo."""
_NEAREST_M = 1.5  # room for somebody to stand before the camera
_PATCH = 2.5  # standard deviation of a patch [pixels]: block matching compares windows
_NOISES = (1.0, 2.0, 4.0)
"""Of the Kinect V2's: time of flight, and about structured light at 2 m and at 4 m."""


def draw_camera(rng: Generator) -> RgbdConfig:
    """Return a camera 0.3 to 1.8 m above the floor, 5 degrees up to 45 down, rolled by 3 degrees or so."""
    across, down, width, height = _VIEWS[rng.integers(len(_VIEWS))]
    return RgbdConfig(
        width=width,
        height=height,
        horizontal_fov=float(np.radians(across)),
        vertical_fov=float(np.radians(down)),
        camera_height=float(rng.uniform(0.3, 1.8)),
        pitch=float(np.radians(rng.uniform(-5.0, 45.0))),
        roll=float(np.radians(np.clip(rng.normal(0.0, 3.0), -12.0, 12.0))),
        noise=float(_NOISES[rng.integers(len(_NOISES))]),
        missing=float(rng.choice((0.002, 0.05))),
    )


def floor_in_sight(camera: RgbdConfig) -> float:
    """Return how far off the upper edge of the picture meets the floor [m], 1.5 m at least and at most `REACH_M`."""
    below = camera.pitch - camera.vertical_fov / 2.0
    return float(np.clip(camera.camera_height / max(np.tan(below), 1e-6), _NEAREST_M, REACH_M))


def shake_depth(frame: RgbdFrame, rng: Generator, quadratic: float) -> RgbdFrame:
    """Return the frame with the errors of stereo: they grow with depth squared, and neighbours share them.

    Args:
        frame: The frame.
        rng: Source of the errors.
        quadratic: Their standard deviation is this times depth squared [1/m].
    """
    small = rng.standard_normal(frame.depth.shape)
    patches = gaussian_filter(small, _PATCH)
    error = (patches / patches.std()).astype(np.float32) * np.float32(quadratic) * frame.depth**2
    return replace(frame, depth=np.maximum(frame.depth + error, np.float32(0.1)))


def tilted_camera(pitch_deg: float, height: float) -> RgbdConfig:
    """Return the usual camera at a `height` [m], its nose `pitch_deg` down [deg]."""
    return RgbdConfig(camera_height=height, pitch=float(np.radians(pitch_deg)))
