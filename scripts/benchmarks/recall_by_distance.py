"""How far the tracker sees people, at several resolutions of the laser, with `beta` fixed and by beam spacing.

A drive follows the true leader through an office among bystanders. A walking person counts as there when at least one
beam meets a leg; recall is the share of such moments in which a track is within 0.75 m; false tracks are counted where
nobody is within 1 m. Intervals are Student's over drives.

example:
  tagalong bench recall-by-distance --seeds 12

It gave, recall (false tracks), 12 drives of at most 40 s:

    distance [m]  360, beta 3  360, by spacing  1081, beta 3  1081, by spacing
    0 .. 2        0.93 (34)    0.94 (33)        0.94 (58)     0.94 (58)
    2 .. 3        0.66 (51)    0.72 (50)        0.81 (61)     0.81 (61)
    3 .. 4        0.49 (6)     0.58 (6)         0.90 (53)     0.90 (53)
    4 .. 5        0.09 (0)     0.27 (9)         0.77 (2)      0.77 (2)
    5 .. 6        0.01 (0)     0.08 (1)         0.79 (16)     0.79 (16)
    6 .. 8        0.00 (0)     0.00 (0)         0.76 (14)     0.76 (14)
    8 .. 10       0.00 (0)     0.00 (0)         0.56 (10)     0.60 (11)

By spacing, nobody is found less often. Beyond 4.6 m a leg gets fewer than 2 of 360 beams: no rule for `beta` helps.
"""

import argparse
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...envs.sensors.lidar import LidarConfig
from ...envs.world.config import WorldConfig
from ...envs.world.world import World
from ...perception.legs.detector import LegDetectorConfig
from ...perception.people_filter import PeopleFilter, PeopleFilterConfig
from ...slam.geometry import compose, inverse, transform_points
from ..console.arguments import at_least, positive
from ..console.tables import format_table
from ..lab.statistics import t_mean
from .people import follow_command
from .results import write_results

EDGES = (0.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
"""Borders of the distances that are counted apart [m]."""
BEAMS = (360, 1081)
FAR_WIDTHS = (0.0, 0.12)
"""`far_width` of the detector: 0 is beta = 3 everywhere [m]."""
SAME_M, NOBODY_M = 0.75, 1.0

Counts = NDArray[np.int64]


def drive_counts(seed: int, beams: int, far_width: float, seconds: float) -> Counts:
    """Return (3, bins): moments of people who are there, those found, and false tracks, over `EDGES`."""
    world = World(WorldConfig(scene="office", people=6, lidar=LidarConfig(beams=beams)), np.random.default_rng(seed))
    config = PeopleFilterConfig(forest="simulation", detector=LegDetectorConfig(far_width=far_width))
    people_filter = PeopleFilter(config)
    counts = np.zeros((3, len(EDGES) - 1), dtype=np.int64)
    while world.time_s < seconds and not world.truth.tour_done:
        world.step(follow_command(world.truth))
        update, truth = people_filter.update(world.scan(), world.odometry), world.truth
        T_world_odom = compose(truth.robot_pose, inverse(update.odometry))
        tracks = transform_points(T_world_odom, update.people.positions)
        people = truth.people.positions
        gap = np.hypot(*(tracks[:, None] - people[None]).transpose(2, 0, 1))
        there = truth.people.walking & (np.bincount(world.scan_labels() + 1, minlength=len(people) + 1)[1:] > 0)
        found = there & (gap.min(axis=0, initial=np.inf) <= SAME_M)
        ghosts = tracks[gap.min(axis=1, initial=np.inf) > NOBODY_M]
        for row, places in enumerate((people[there], people[found], ghosts)):
            counts[row] += np.histogram(np.hypot(*(places - truth.robot_pose[:2]).T), EDGES)[0]
    return counts


def measure(seeds: int, seconds: float) -> list[dict[str, Any]]:
    """Return a row of figures for each resolution, rule and distance."""
    rows = []
    for beams in BEAMS:
        for far_width in FAR_WIDTHS:
            drives = np.array([drive_counts(seed, beams, far_width, seconds) for seed in range(seeds)])
            for k, (near, far) in enumerate(pairwise(EDGES)):
                there, found, false = drives[:, :, k].T
                shares = (found[there > 0] / there[there > 0]).tolist()
                rows.append(
                    {
                        "beams": beams,
                        "far_width": far_width,
                        "from_m": near,
                        "to_m": far,
                        "there": int(there.sum()),
                        "recall": float(found.sum() / max(1, there.sum())),
                        "recall_of_drives": t_mean(shares, least=0.0, most=1.0).to_dict() if shares else None,
                        "false": int(false.sum()),
                    }
                )
    return rows


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--seeds", type=at_least(1), default=6)
    parser.add_argument("--seconds", type=positive, default=40.0, help="longest drive [s]")


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json."""
    rows = measure(options.seeds, options.seconds)
    columns = [(beams, width) for beams in BEAMS for width in FAR_WIDTHS]
    header = ["distance [m]", *(f"{b} beams, {'beta 3' if w == 0.0 else 'by spacing'}" for b, w in columns)]
    lines = []
    for near, far in pairwise(EDGES):
        cells = [
            next(r for r in rows if (r["beams"], r["far_width"], r["from_m"]) == (beams, width, near))
            for beams, width in columns
        ]
        lines.append(
            (f"{near:.0f} .. {far:.0f}", *(f"{c['recall']:.2f} (n {c['there']}, false {c['false']})" for c in cells))
        )
    print(format_table(header, lines))
    write_results(options, {"rows": rows})
    return 0
