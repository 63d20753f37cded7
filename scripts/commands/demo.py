"""`tagalong demo`: the main job in one command."""

import argparse
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ...agents.tour import SCENES, TourConfig
from ...envs.follow_config import make_config
from ...envs.topview.rendering import has_display
from ...envs.viewing.live import require_viewer
from ...slam.engine import ENGINES, make_slam
from ...slam.errors import InputError
from ..console.arguments import at_least, random_seed
from ..console.record_option import add_record, check_record
from ..console.setting_words import add_settings, read_settings
from ..console.tables import format_table
from ..lab.map_comparison import MapComparisonConfig

EPILOG = """\
One drive behind a leader; the same scans go to two SLAM engines, raw and with the people removed; a slow drive of the
same building without people is the reference. Exit status 1 if a bound of the table is missed.

writes into DIR:
  summary.png            the drive and both maps in one picture
  drive.gif              the drive, five times as fast
  overlay.png            both maps (blue) on the reference (red), as Fig. 4 of the paper
  scan.png               one scan, raw and filtered, as Fig. 1
  trajectory.png         the robot's way in its own map
  map_*.pgm .yaml .png   the maps: reference, raw, filtered
  drives/                both drives as CARMEN logs with true poses and legs: run your own SLAM on them
  metrics.json           every figure; equal for equal seeds
  timing.json            seconds by stage

example:
  tagalong demo --scene meeting_room --people 2 --standing 1 --seed 3 --out out/meeting
"""

ADNN_BOUND_M = {"corridor": 0.025, "meeting_room": 0.020}
"""The filtered map's highest ADNN, by scene [m]; the paper reached 0.0590 and 0.1030."""
DISTANCE_RMS_BOUND_M = 0.25
"""Highest root mean square of the following distance error [m]."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.epilog = EPILOG
    parser.add_argument("--scene", choices=tuple(SCENES), default="corridor", help="building (default: %(default)s)")
    parser.add_argument(
        "--people", type=at_least(1), default=2, help="walking people, leader included (default: %(default)s)"
    )
    parser.add_argument(
        "--standing", type=at_least(0), default=0, help="people who stop and stand (default: %(default)s)"
    )
    parser.add_argument(
        "--method", default="gmapping", help=f"SLAM engine: {', '.join(ENGINES)} (default: %(default)s)"
    )
    parser.add_argument("--seed", type=random_seed, default=0, help="seed of everything (default: %(default)s)")
    add_settings(parser, "an argument of the environment, e.g. robot=pioneer or lidar.height=0.3")
    add_record(parser)
    parser.add_argument("--live", action="store_true", help="show it in rerun's viewer meanwhile (extra `rerun`)")
    parser.add_argument("--out", type=Path, default=Path("out/demo"), metavar="DIR", help="(default: %(default)s)")


_OF_THE_DEMO = {"scene": "--scene", "people_count": "--people", "slam": "--method", "render_mode": "no option"}
"""What the demo sets itself, and the option for it."""


def _own_settings(options: argparse.Namespace) -> dict[str, Any]:
    """Return what `--set` asks for, checked before the drive."""
    settings = read_settings(options.settings)
    for name in settings:
        end = name.rpartition(".")[2]
        if end in _OF_THE_DEMO or name.startswith("slam."):
            instead = _OF_THE_DEMO.get(end, "--method")
            raise InputError(f"--set: the demo sets `{name}` itself, by {instead}")
    make_config({"scene": options.scene, **settings})
    return settings


def run(options: argparse.Namespace) -> int:
    """Run the demo, write everything, print the table."""
    from ..runs import demo_run

    check_record(options.record)
    if options.live:
        require_viewer(display=has_display())
    make_slam(options.method)  # what is unknown is told before the drive
    settings = _own_settings(options)
    tour = TourConfig(
        scene=options.scene, people=options.people, standing=options.standing, seed=options.seed, slam="gmapping"
    )
    mapping = MapComparisonConfig(method=options.method, seed=options.seed)
    print(f"tagalong demo: {tour.name}, {mapping.method}")
    watch = demo_run.Stopwatch()
    result = demo_run.run_demo(tour, mapping, watch, settings, options.record, options.live)
    rows = _bounds(result.metrics, options.scene)
    with watch.stage("pictures, maps and logs"):
        demo_run.write_demo(options.out, result)
    content = {
        "tour": asdict(tour),
        "mapping": asdict(mapping),
        **({"settings": settings} if settings else {}),
        **result.metrics,
        "bounds": [dict(zip(("quantity", "value", "bound", "met"), row, strict=True)) for row in rows],
    }
    demo_run.write_metrics(options.out, content, watch)
    print("\n" + _comparison(result.metrics) + "\n\n" + _verdicts(rows))
    print(
        f"\n{sum(watch.stages.values()):.0f} s; look at {options.out / 'summary.png'} and {options.out / 'drive.gif'}"
    )
    return 0 if all(met for *_, met in rows) else 1


def _bounds(metrics: dict[str, Any], scene: str) -> list[tuple[str, float | str, float | str, bool]]:
    """Return (quantity, value, bound, met) of everything that the demo promises."""
    episode, adnn = metrics["episode"], metrics["filtered"]["adnn"]["mean_m"]
    error = episode["distance_error_rms_m"]
    return [
        ("tour", metrics["ending"], "tour_done", metrics["ending"] == "tour_done"),
        ("following distance error, RMS [m]", error, DISTANCE_RMS_BOUND_M, error <= DISTANCE_RMS_BOUND_M),
        ("ADNN of the filtered map [m]", adnn, ADNN_BOUND_M[scene], adnn <= ADNN_BOUND_M[scene]),
    ]


def _comparison(metrics: dict[str, Any]) -> str:
    entries = (
        ("ADNN, eq. 7", "cm", lambda m: f"{100 * m['adnn']['mean_m']:.2f}"),
        ("ADNN, estimate to reference", "cm", lambda m: f"{100 * m['ghosts']['mean_m']:.2f}"),
        ("pose error (ATE rmse)", "cm", lambda m: f"{100 * m['ate_rmse_m']:.2f}"),
        ("occupied cells: precision", "%", lambda m: f"{100 * m['cells']['precision']:.1f}"),
        ("occupied cells: recall", "%", lambda m: f"{100 * m['cells']['recall']:.1f}"),
        ("free space covered", "%", lambda m: f"{100 * m['cells']['free_coverage']:.1f}"),
        ("cells left by people", "cells", lambda m: str(m["dynamic_residue"]["cells"])),
    )
    rows = [(name, show(metrics["raw"]), show(metrics["filtered"]), unit) for name, unit, show in entries]
    return format_table(("map", "raw", "filtered", "unit"), rows)


def _verdicts(rows: list[tuple[str, float | str, float | str, bool]]) -> str:
    def shown(value: float | str) -> str:
        return value if isinstance(value, str) else f"{value:.4f}"

    lines = [(name, shown(value), shown(bound), "yes" if met else "NO") for name, value, bound, met in rows]
    return format_table(("promise", "value", "bound", "met"), lines)
