"""`tagalong ros`: nodes of ROS 2."""

import argparse

EPILOG = """\
Needs ROS 2 with Python 3.11 or newer (Jazzy has 3.12): rclpy comes with it. All nodes listen to `scan`, `odom` and
/tf_static, and send:
  filter    scan_filtered, and scan_filtered/people, /tracks, /legs in the scans' frame
  people    people, people/tracks, people/markers
  follower  cmd_vel (nothing once scans or odometry are older than 0.5 s), people/markers
  slam      map (nav_msgs/OccupancyGrid), on /tf map -> odom, and pose with its covariance while it is sure of it

examples:
  tagalong ros filter
  tagalong ros slam --ros-args -p method:=gmapping -r scan:=/front/scan
  tagalong ros follower --ros-args --params-file turtlebot4.yaml
"""
NODES = ("filter", "people", "follower", "slam")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.epilog = EPILOG
    parser.add_argument("node", choices=NODES, metavar="NODE", help=f"which: {', '.join(NODES)}")
    parser.add_argument("arguments", nargs=argparse.REMAINDER, metavar="...", help="of ROS: --ros-args ...")


def run(options: argparse.Namespace) -> int:
    """Run the node until it is interrupted."""
    from ..ros.node import run_node

    run_node(options.node, options.arguments)
    return 0
