"""Our own simulator of scans at shin height: where legs are known, and scanners, rooms and people vary widely."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from ...slam.scan import LaserScan
from .buildings import draw_building
from .outlines import LEG, STATIC, Outlines, cast
from .pedestrians import draw_people


@dataclass(frozen=True, eq=False)
class LabelledScan:
    """A scan of which it is known what each beam met.

    Attributes:
        scan: The sweep.
        is_leg: (N,) whether the beam's return came from a leg.
    """

    scan: LaserScan
    is_leg: NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class Scanner:
    """A planar laser scanner and its faults.

    Attributes:
        bearings: (N,) beam directions [rad].
        range_min: Shortest range [m].
        range_max: Longest range [m].
        noise: Standard deviation of a range [m].
        quantum: Ranges are multiples of it [m].
        mixed: Chance that a beam over an edge reports a range between both surfaces.
        divergence: Angle between the outer rays of a beam [rad].
        lost: Chance that any beam gives nothing.
        nothing: What a beam without a return reports: inf, or 0 for "no measurement".
    """

    bearings: NDArray[np.float64]
    range_min: float
    range_max: float
    noise: float
    quantum: float
    mixed: float
    divergence: float
    lost: float
    nothing: float


def draw_scanner(rng: Generator) -> Scanner:
    """Draw a scanner between a small indoor one (4 m, 1 degree) and an outdoor one (30 m, 0.25 degrees)."""
    spacing, view, reach = [
        (0.25, 270.0, 30.0),
        (0.3516, 269.6, 11.0),
        (0.3516, 200.0, 5.6),
        (0.5, 180.0, 20.0),
        (1.0, 330.0, 12.0),
        (0.75, 270.0, 30.0),
    ][rng.choice(6, p=[0.3, 0.35, 0.1, 0.1, 0.05, 0.1])]
    view *= rng.uniform(0.6, 1.0) if rng.random() < 0.3 else 1.0
    beams = round(view / spacing) + 1
    half = np.radians(spacing) * (beams - 1) / 2
    return Scanner(
        bearings=np.linspace(-half, half, beams),
        range_min=0.03,
        range_max=reach,
        noise=float(rng.choice([0.004, 0.008, 0.015, 0.025], p=[0.3, 0.4, 0.2, 0.1])) * rng.uniform(0.7, 1.3),
        quantum=float(rng.choice([0.001, 0.01], p=[0.85, 0.15])),
        mixed=rng.uniform(0.0, 0.8),
        divergence=np.radians(rng.uniform(0.05, 0.8) * max(spacing, 0.3)),
        lost=float(rng.choice([0.0, 0.005, 0.03])),
        nothing=float(rng.choice([np.inf, 0.0])),
    )


def draw_scan(rng: Generator) -> LabelledScan:
    """Draw a building, people and a scanner, and take one scan from the origin."""
    scanner = draw_scanner(rng)
    building = draw_building(rng, rng.uniform(2.0, 9.0))
    heading = rng.uniform(-np.pi, np.pi)
    people = draw_people(rng, building, min(scanner.range_max, 8.0), heading)
    return take_scan(rng, scanner, building.add(people), heading)


def take_scan(rng: Generator, scanner: Scanner, outlines: Outlines, heading: float) -> LabelledScan:
    """Take one scan of `outlines` from the origin, the scanner turned to `heading` and perhaps moving."""
    angles = heading + scanner.bearings
    speed = rng.uniform(0.0, 1.0) * (rng.random() < 0.5)
    sweep = np.linspace(0.0, 0.03, len(angles))  # seconds into the sweep
    origins = sweep[:, None] * speed * np.array([np.cos(heading), np.sin(heading)])
    ellipses, segments = outlines.arrays()
    ellipses, segments = _clear_of_scanner(ellipses, segments, 0.12)
    limit = scanner.range_max + 1.0
    middle, kinds, lost = cast(origins, angles, limit, ellipses, segments)
    right = cast(origins, angles - 0.5 * scanner.divergence, limit, ellipses, segments)[0]
    left = cast(origins, angles + 0.5 * scanner.divergence, limit, ellipses, segments)[0]
    ranges, blurred = _mix(rng, np.minimum(middle, 1e3), np.minimum(right, 1e3), np.minimum(left, 1e3), scanner.mixed)
    kinds = np.where(blurred, STATIC, kinds)
    ranges = ranges + rng.normal(0.0, scanner.noise, len(ranges)) * np.where(kinds == LEG, rng.uniform(1.0, 1.6), 1.0)
    ranges = np.round(ranges / scanner.quantum) * scanner.quantum
    nothing = ~(ranges <= scanner.range_max) | (rng.random(len(ranges)) < np.maximum(lost, scanner.lost))
    ranges[nothing] = scanner.nothing
    scan = LaserScan(ranges, scanner.bearings, scanner.range_min, scanner.range_max)
    return LabelledScan(scan, (kinds == LEG) & scan.is_return)


def _mix(
    rng: Generator, middle: NDArray[np.float64], right: NDArray[np.float64], left: NDArray[np.float64], chance: float
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return the ranges with mixed pixels where the outer rays differ, and where a range is far from its surface."""
    near, far = np.minimum(left, right), np.maximum(left, right)
    mixed = (far > near + 0.03) & (far < 999.0) & (rng.random(len(middle)) < chance)
    ranges = np.where(mixed, near + rng.random(len(middle)) * (far - near), middle)
    return ranges, np.abs(ranges - middle) > 0.06


def _clear_of_scanner(
    ellipses: NDArray[np.float64], segments: NDArray[np.float64], room: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Leave out what the scanner would stand in."""
    reach = np.maximum(ellipses[:, 2], ellipses[:, 3])
    keep = np.hypot(ellipses[:, 0], ellipses[:, 1]) > reach + room
    way = segments[:, 2:4] - segments[:, :2]
    along = -np.sum(segments[:, :2] * way, axis=1) / np.maximum(np.sum(way**2, axis=1), 1e-12)
    nearest = segments[:, :2] + np.clip(along, 0.0, 1.0)[:, None] * way
    return ellipses[keep], segments[np.hypot(nearest[:, 0], nearest[:, 1]) > room]
