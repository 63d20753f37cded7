"""Recorded legs put before other recorded backgrounds, so that a forest does not learn the one room they walked in."""

from collections.abc import Sequence

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from ...perception.legs.clusters import cluster_scan
from ...slam.scan import LaserScan
from .leg_recordings import LegRecording
from .leg_samples import LABEL_DISTANCE, Samples, samples_of
from .leg_scans import LabelledScan


def pasted_samples(
    rng: Generator, recordings: Sequence[LegRecording], backgrounds: Sequence[LaserScan], copies: int
) -> Samples:
    """Return the legs of `recordings`, each scan's `copies` times, before people-free `backgrounds`."""
    parts = [Samples.none()]
    for _ in range(copies):
        for recording in recordings:
            for scan, legs in zip(recording.scans, recording.legs, strict=True):
                background = backgrounds[int(rng.integers(len(backgrounds)))]
                if len(legs) and len(background) == len(scan):
                    pasted = paste_legs(rng, scan, legs, background)
                    samples = samples_of(pasted.scan, pasted.is_leg)
                    parts.append(Samples(samples.features[samples.is_leg], samples.is_leg[samples.is_leg]))
    return Samples.joined(parts)


def paste_legs(rng: Generator, scan: LaserScan, legs: NDArray[np.float64], background: LaserScan) -> LabelledScan:
    """Take the returns on `legs` (n, 2) out of `scan`, turn and perhaps mirror them, and put them before `background`.

    Ranges and the angles between beams stay as they were recorded. A leg hides what is behind it and is hidden by
    what is before it. Both scans need the same number of beams.
    """
    clusters = cluster_scan(scan)
    away = np.hypot(*(clusters.centres[:, None] - legs[None]).transpose(2, 0, 1)).min(axis=1, initial=np.inf)
    leg_ranges = np.full(len(scan), np.inf)
    for cluster in np.flatnonzero(away < LABEL_DISTANCE):
        beams = clusters.beams[clusters.start[cluster] : clusters.end[cluster]]
        leg_ranges[beams] = scan.ranges[beams]
    if rng.random() < 0.5:
        leg_ranges = leg_ranges[::-1]
    used = np.flatnonzero(np.isfinite(leg_ranges))
    if len(used):
        leg_ranges = np.roll(leg_ranges, int(rng.integers(-used[0], len(scan) - used[-1])))
    behind = np.where(background.is_return, background.ranges, np.inf)
    is_leg = leg_ranges < behind
    ranges = np.where(is_leg, leg_ranges, background.ranges)
    return LabelledScan(LaserScan(ranges, background.bearings, background.range_min, background.range_max), is_leg)
