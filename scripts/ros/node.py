"""A node of ROS 2 around the logic of one: subscriptions, publishers, parameters, clock. Only here is rclpy imported.

Quality of service: scans and odometry as sensors send them (best effort, the newest five); frames and the map for who
comes late, too (transient local); all else reliable, the newest ten.
"""

from array import array
from collections.abc import Callable, Sequence
from dataclasses import fields
from importlib import import_module
from typing import Any

import numpy as np

from ...slam.errors import InputError, unknown_name
from .filter_logic import FilterLogic, FilterNodeConfig, PeopleLogic
from .follower_logic import FollowerLogic, FollowerNodeConfig
from .live_scans import InputConfig
from .outputs import FRAMES, ODOMETRY, SCAN, Logic, Output
from .slam_logic import SlamLogic, SlamNodeConfig

NODES: dict[str, tuple[Callable[..., Logic], type[InputConfig]]] = {
    "filter": (FilterLogic, FilterNodeConfig),
    "people": (PeopleLogic, FilterNodeConfig),
    "follower": (FollowerLogic, FollowerNodeConfig),
    "slam": (SlamLogic, SlamNodeConfig),
}
"""Name -> what it does, and its parameters."""
INPUTS = {SCAN: "sensor_msgs/msg/LaserScan", ODOMETRY: "nav_msgs/msg/Odometry", FRAMES: "tf2_msgs/msg/TFMessage"}
"""Topic -> type of what every node listens to."""
TICK_S = 0.1
_LATE_COMERS_TOO = (FRAMES, "map")
_REPEAT_S = 5.0  # a complaint is not repeated within this time


class RclpyMessages:
    """Makes messages of the types that are installed with ROS."""

    def make(self, kind: str, **content: Any) -> Any:
        """Return a message of a type, such as "std_msgs/msg/Float64"; fields that older ROS lacks are left out."""
        made = message_type(kind)
        known = made.get_fields_and_field_types()
        return made(**{name: _as_ros_takes_it(value) for name, value in content.items() if name in known})


def message_type(kind: str) -> Any:
    """Return the class of a type such as "std_msgs/msg/Float64"."""
    package, _, name = kind.partition("/msg/")
    return getattr(import_module(f"{package}.msg"), name)


def _as_ros_takes_it(value: Any) -> Any:
    """Return numbers of numpy as Python's own: the messages of ROS check that."""
    if isinstance(value, np.ndarray):
        return array(value.dtype.char, np.ascontiguousarray(value).tobytes())
    return value.item() if isinstance(value, np.generic) else value


def run_node(name: str, arguments: Sequence[str] = ()) -> None:
    """Run a node until it is interrupted; a robot that it drives is told to stand still then.

    Args:
        name: Of `NODES`.
        arguments: Of ROS: `--ros-args --params-file FILE -r OLD:=NEW`.

    Raises:
        InputError: If there is no such node, ROS is not there, or a parameter is out of its range.
    """
    if name not in NODES:
        raise unknown_name("node", name, tuple(NODES))
    rclpy = _rclpy()
    # without handlers of its own an interrupt leaves the time to send the halt
    rclpy.init(args=["tagalong", *arguments], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    try:
        node = rclpy.create_node(f"tagalong_{name}")
        running = _Running(rclpy, node, name)
        try:
            rclpy.spin(node)
        except KeyboardInterrupt:
            node.get_logger().info("interrupted")
        finally:
            running.halt()
            node.destroy_node()
    finally:
        rclpy.try_shutdown()


def _rclpy() -> Any:
    try:
        import rclpy  # pyright: ignore[reportMissingImports]
        import rclpy.qos  # pyright: ignore[reportMissingImports]
        import rclpy.signals  # pyright: ignore[reportMissingImports]
    except ImportError:
        how = "which comes with ROS 2 and not from PyPI: source /opt/ros/DISTRO/setup.bash, and use ROS's own Python"
        raise InputError(f"a node needs rclpy, {how}") from None
    return rclpy


class _Running:
    """A node with its logic."""

    def __init__(self, rclpy: Any, node: Any, name: str) -> None:
        self._rclpy, self._node = rclpy, node
        logic, config = NODES[name]
        self._logic = logic(RclpyMessages(), parameters(node, config))
        self._publishers = {
            topic: node.create_publisher(message_type(kind), topic, self._quality(topic))
            for topic, kind in self._logic.outputs.items()
        }
        for source, kind in INPUTS.items():
            node.create_subscription(message_type(kind), source, self._taker(source), self._quality(source))
        node.create_timer(TICK_S, self._tick)

    def halt(self) -> None:
        """Send what stops a robot, if this drives one."""
        if isinstance(self._logic, FollowerLogic):
            self._send(self._logic.halt(self._now_s()))

    def _taker(self, source: str) -> Callable[[Any], None]:
        def take(message: Any) -> None:
            try:
                self._send(self._logic.take(source, message, self._now_s()))
            except InputError as error:  # the next message may be better
                self._node.get_logger().warning(str(error), throttle_duration_sec=_REPEAT_S)

        return take

    def _tick(self) -> None:
        self._send(self._logic.tick(self._now_s()))

    def _now_s(self) -> float:
        return 1e-9 * self._node.get_clock().now().nanoseconds

    def _send(self, outputs: Sequence[Output]) -> None:
        for topic, message in outputs:
            self._publishers[topic].publish(message)
        for note in self._logic.notes():
            self._node.get_logger().info(note)

    def _quality(self, topic: str) -> Any:
        qos = self._rclpy.qos
        late, sensor = topic in _LATE_COMERS_TOO, topic in (SCAN, ODOMETRY)
        return qos.QoSProfile(
            history=qos.HistoryPolicy.KEEP_LAST,
            depth=5 if sensor else 1 if topic == "map" else 100 if topic in (FRAMES, "/tf") else 10,
            reliability=qos.ReliabilityPolicy.BEST_EFFORT if sensor else qos.ReliabilityPolicy.RELIABLE,
            durability=qos.DurabilityPolicy.TRANSIENT_LOCAL if late else qos.DurabilityPolicy.VOLATILE,
        )


def parameters(node: Any, config: type[InputConfig]) -> InputConfig:
    """Return the parameters of a node as ROS has them: those of a file or of the command line, else the defaults.

    Raises:
        InputError: If one is out of its range.
    """
    descriptor = message_type("rcl_interfaces/msg/ParameterDescriptor")(dynamic_typing=True)  # 1 is a float, too
    given = {}
    for field in fields(config):
        default: Any = field.default
        value = node.declare_parameter(field.name, None if default == () else default, descriptor).value
        if value is not None:
            given[field.name] = tuple(value) if isinstance(value, (list, array)) else value
    return config(**given)
