"""Starts SLAM without people in the map, and the follower: `ros2 launch turtlebot4.launch.py follower:=false`."""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration

HERE = Path(__file__).resolve().parent
NODES = {"slam": "true", "follower": "true", "people": "false", "filter": "false"}


def generate_launch_description():
    """Return a switch and a process for each node, and where the parameters are."""
    parameters = LaunchConfiguration("params_file")
    started = [
        ExecuteProcess(
            cmd=["tagalong", "ros", node, "--ros-args", "--params-file", parameters],
            condition=IfCondition(LaunchConfiguration(node)),
            output="screen",
        )
        for node in NODES
    ]
    switches = [DeclareLaunchArgument(node, default_value=default) for node, default in NODES.items()]
    where = DeclareLaunchArgument("params_file", default_value=str(HERE / "turtlebot4.yaml"))
    return LaunchDescription([where, *switches, *started])
