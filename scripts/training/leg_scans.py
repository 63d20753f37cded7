"""Our own simulator of scans at shin height: where legs are known, and scanners, rooms and people vary widely."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from ...envs.simulation2d.furnished_buildings import draw_building, draw_decoys, draw_screens
from ...envs.simulation2d.outlines import LEG, STATIC, Outlines, cast
from ...slam.scan import LaserScan
from .pedestrians import draw_people

SCREENED = 0.35  # share of scans with things close before the laser
FARTHEST_PERSON = 10.0  # people are looked for as far as three beams meet a leg [m]
FAR = 1e3  # stands for nothing met [m]


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
        smoothing: How often neighbouring ranges are averaged.
        grazing: Tangent of the angle of incidence from which beams are lost.
        dark: Share of surfaces that are seen from near only.
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
    smoothing: int
    grazing: float
    dark: float
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
        noise=float(rng.choice([0.002, 0.005, 0.01, 0.02], p=[0.35, 0.35, 0.22, 0.08])) * rng.uniform(0.7, 1.3),
        quantum=float(rng.choice([0.001, 0.01], p=[0.85, 0.15])),
        mixed=rng.uniform(0.0, 1.0),
        divergence=np.radians(rng.choice([0.1, 0.5, 1.0, 2.0]) * max(spacing, 0.3)),
        lost=float(rng.choice([0.0, 0.003, 0.02], p=[0.6, 0.3, 0.1])),
        smoothing=int(rng.choice([0, 1, 3, 6], p=[0.3, 0.2, 0.3, 0.2])),
        grazing=np.tan(np.radians(rng.uniform(60.0, 88.0))),
        dark=float(rng.choice([0.0, 0.2, 0.5])),
        nothing=float(rng.choice([np.inf, 0.0])),
    )


def draw_scan(rng: Generator, people: bool = True) -> LabelledScan:
    """Draw a building, people (unless told not to) and a scanner, and take one scan from the origin."""
    scanner = draw_scanner(rng)
    building = draw_building(rng, rng.uniform(2.5, 10.0))
    heading = rng.uniform(-np.pi, np.pi)
    if rng.random() < SCREENED:
        building = building.add(draw_screens(rng, heading + rng.uniform(-1.5, 1.5)))
    reach = min(scanner.range_max, FARTHEST_PERSON)
    building = building.add(draw_decoys(rng, building, reach, heading))
    if people:
        building = building.add(draw_people(rng, building, reach, heading))
    return take_scan(rng, scanner, building, heading, speed=rng.uniform(0.0, 1.0) * (rng.random() < 0.5))


def take_scan(rng: Generator, scanner: Scanner, outlines: Outlines, heading: float, speed: float = 0.0) -> LabelledScan:
    """Take one scan of `outlines` from the origin, turned to `heading`, moving that way at `speed` [m/s]."""
    angles = heading + scanner.bearings
    sweep = np.linspace(0.0, 0.03, len(angles))  # seconds into the sweep
    origins = sweep[:, None] * speed * np.array([np.cos(heading), np.sin(heading)])
    ellipses, segments = outlines.arrays()
    ellipses, segments = _clear_of_scanner(ellipses, segments, 0.12)
    limit = scanner.range_max + 1.0
    middle, met = cast(origins, angles, limit, ellipses, segments)
    right = cast(origins, angles - 0.5 * scanner.divergence, limit, ellipses, segments)[0]
    left = cast(origins, angles + 0.5 * scanner.divergence, limit, ellipses, segments)[0]
    middle, right, left = (np.minimum(ranges, FAR) for ranges in (middle, right, left))
    ranges, blurred = _mix(rng, middle, right, left, scanner.mixed)
    kinds, lost, reach = _surfaces(rng, ellipses, segments, scanner)
    is_leg = (kinds[met] == LEG) & ~blurred
    ranges = _smooth(ranges, scanner.smoothing)
    ranges = ranges + rng.normal(0.0, scanner.noise, len(ranges)) * np.where(is_leg, rng.uniform(1.0, 1.5), 1.0)
    ranges = np.round(ranges / scanner.quantum) * scanner.quantum
    slope = np.abs(left - right) / (scanner.divergence * middle)
    grazing = (np.abs(left - right) < 0.3) & (slope > scanner.grazing * rng.lognormal(0.0, 0.3, len(ranges)))
    nothing = ~(ranges <= np.minimum(scanner.range_max, reach[met])) | grazing
    nothing |= rng.random(len(ranges)) < np.maximum(lost[met], scanner.lost)
    ranges[nothing] = scanner.nothing
    scan = LaserScan(ranges, scanner.bearings, scanner.range_min, scanner.range_max)
    return LabelledScan(scan, is_leg & scan.is_return)


def _surfaces(
    rng: Generator, ellipses: NDArray[np.float64], segments: NDArray[np.float64], scanner: Scanner
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the kind of each piece, its share of beams lost, and up to which range it is seen; nothing comes last."""
    kinds = np.concatenate((ellipses[:, 5], segments[:, 4], [STATIC])).astype(np.int64)
    lost = np.concatenate((ellipses[:, 6], segments[:, 5], [0.0]))
    dark = (rng.random(len(kinds)) < scanner.dark) & (kinds == STATIC)
    return kinds, lost, np.where(dark, rng.uniform(0.5, 8.0, len(kinds)), np.inf)


def _smooth(ranges: NDArray[np.float64], passes: int) -> NDArray[np.float64]:
    """Average neighbours on the same surface: wide overlapping beams flatten what is round."""
    out = np.where(ranges < FAR, ranges, np.nan)
    for _ in range(passes):
        padded = np.pad(out, 1, constant_values=np.nan)
        beside = np.stack((padded[:-2], out, padded[2:]))
        beside[~(np.abs(beside - out) < 0.1)] = np.nan
        counts = np.maximum(np.sum(~np.isnan(beside), axis=0), 1)
        out = np.where(np.isnan(out), np.nan, np.nansum(beside, axis=0) / counts)
    return np.where(np.isnan(out), ranges, out)


def _mix(
    rng: Generator, middle: NDArray[np.float64], right: NDArray[np.float64], left: NDArray[np.float64], chance: float
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return the ranges with mixed pixels where the outer rays differ, and where a range is far from its surface."""
    near, far = np.minimum(left, right), np.maximum(left, right)
    mixed = (far > near + 0.03) & (far < FAR) & (rng.random(len(middle)) < chance)
    closed = (middle > far + 0.03) & (far < near + 0.4) & (rng.random(len(middle)) < chance)  # a gap too narrow to see
    ranges = np.where(mixed | closed, near + rng.random(len(middle)) * (far - near), middle)
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
