"""`tagalong score`: judges a result by a reference."""

import argparse
from pathlib import Path

from ...slam.errors import InputError
from ...slam.files.output import write_json
from ...slam.logs.ros_map import read_ros_map
from ..console.arguments import MOST_S, within
from ..console.tables import format_table
from ..figures.canvas import save_png
from ..figures.maps import overlay_picture
from ..runs.scoring import ScoringOptions, judge

EPILOG = """\
What the files are is told by what is in them; plain or gzipped:
  a TUM trajectory (t x y z qx qy qz qw) by
    another TUM trajectory, poses paired by time: errors after the best rigid alignment
    a CARMEN log with corrected poses, paired by order
    relations (t1 t2 x y z roll pitch yaw, or i1 i2 x y yaw): Kuemmerle et al. 2009
  a map (map.yaml of ROS map_server) by another map: registered, then ADNN, ghosts, cells;
    --people counts what people left in it: feet are placed by NAME.gt.tum beside the npz and
    trajectory.tum beside EST, or else taken to be in the frame of REF

examples:
  tagalong score out/trajectory.tum corridor.gt.tum
  tagalong score out/trajectory.tum relations_by_reading.txt.gz --readings readings_odometry.txt.gz
  tagalong score out/map.yaml static/map.yaml --people corridor.people.npz --overlay overlay.png
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.epilog = EPILOG
    parser.add_argument("estimate", type=Path, metavar="EST", help="what to judge: TUM trajectory or map.yaml")
    parser.add_argument("reference", type=Path, metavar="REF", help="what to judge it by")
    parser.add_argument("--readings", type=Path, metavar="FILE", help="odometry of all readings (for relations)")
    parser.add_argument("--people", type=Path, metavar="NPZ", help="true feet, NAME.people.npz (for the residue)")
    parser.add_argument(
        "--max-gap",
        type=within(0.0, MOST_S),
        default=0.02,
        metavar="S",
        help="pair poses at most this far apart [s] (%(default)s)",
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the scores there, too")
    parser.add_argument("--overlay", type=Path, metavar="PNG", help="draw both maps on each other")


def run(options: argparse.Namespace) -> int:
    """Judge, print a table, write what was asked for."""
    extras = ScoringOptions(readings=options.readings, people=options.people, max_gap_s=options.max_gap)
    judgement = judge(options.estimate, options.reference, extras)
    if options.overlay is not None and judgement.metrics["kind"] != "map":
        raise InputError("--overlay draws two maps; these are none")
    print(format_table(("quantity", "value", "unit"), judgement.rows))
    if options.json is not None:
        files = {"estimate": options.estimate.name, "reference": options.reference.name}
        write_json(options.json, {**files, **judgement.metrics})
    if options.overlay is not None:
        adnn = 100 * judgement.metrics["adnn"]["mean_m"]
        picture = overlay_picture(
            read_ros_map(options.estimate),
            read_ros_map(options.reference),
            f"{'/'.join(options.estimate.parts[-2:])}: ADNN {adnn:.2f} cm",
            judgement.metrics["registration"]["T_ref_est"],
        )
        save_png(options.overlay, picture)
    return 0
