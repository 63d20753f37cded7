"""What hands messages to the logic of a node and from it: with a ROS that only notes what is asked of it."""

import runpy
import sys
from array import array
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from tagalong.scripts.cli import main
from tagalong.scripts.commands import ros as command
from tagalong.scripts.ros import node as nodes
from tagalong.scripts.ros import outputs

FOLDER = Path(__file__).resolve().parents[2] / "examples" / "ros"


class FakeNode:
    """A node that notes what is asked of it."""

    def __init__(self, given):
        self.given, self.publishers, self.subscriptions, self.timers, self.said = given, {}, {}, [], []
        self.now_s = 0.0

    def declare_parameter(self, name, default, descriptor):
        assert descriptor.dynamic_typing
        return SimpleNamespace(value=self.given.get(name, default))

    def create_publisher(self, kind, topic, quality):
        sent = []
        self.publishers[topic] = SimpleNamespace(kind=kind, quality=quality, sent=sent, publish=sent.append)
        return self.publishers[topic]

    def create_subscription(self, kind, topic, take, quality):
        self.subscriptions[topic] = SimpleNamespace(kind=kind, take=take, quality=quality)

    def create_timer(self, period_s, tick):
        self.timers.append(tick)

    def get_clock(self):
        return SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=round(1e9 * self.now_s)))

    def get_logger(self):
        return SimpleNamespace(info=self.said.append, warning=lambda text, **_: self.said.append(text))

    def destroy_node(self):
        self.said.append("destroyed")


@pytest.fixture
def ros(monkeypatch):
    """A ROS whose node has these parameters, and does while it spins what a test says."""
    pytest.importorskip("rosbags")
    store = outputs.RosMessages().store
    rclpy = ModuleType("rclpy")
    rclpy.qos, rclpy.signals = ModuleType("rclpy.qos"), ModuleType("rclpy.signals")
    for name in ("HistoryPolicy", "ReliabilityPolicy", "DurabilityPolicy"):
        words = ("KEEP_LAST", "BEST_EFFORT", "RELIABLE", "TRANSIENT_LOCAL", "VOLATILE")
        setattr(rclpy.qos, name, SimpleNamespace(**{word: word for word in words}))
    rclpy.qos.QoSProfile = SimpleNamespace
    rclpy.signals.SignalHandlerOptions = SimpleNamespace(NO="none")
    rclpy.given, rclpy.spin = {}, lambda node: None
    rclpy.init = lambda **options: vars(rclpy).update(options)
    rclpy.create_node = lambda name: vars(rclpy).setdefault(name, FakeNode(rclpy.given))
    rclpy.try_shutdown = lambda: None
    fakes = {"rclpy": rclpy, "rclpy.qos": rclpy.qos, "rclpy.signals": rclpy.signals}
    for kind, made in store.types.items():
        package, _, name = kind.partition("/msg/")
        module = fakes.setdefault(f"{package}.msg", ModuleType(f"{package}.msg"))
        setattr(module, name, as_of_ros(made))
    fakes["rcl_interfaces.msg"] = SimpleNamespace(ParameterDescriptor=SimpleNamespace)
    for name, module in fakes.items():
        monkeypatch.setitem(sys.modules, name, module)
    return rclpy


def as_of_ros(made):
    """Return a type of messages that takes, as those of ROS do, no numbers of numpy."""

    class Message(made):
        def __init__(self, **content):
            wrong = {name: value for name, value in content.items() if isinstance(value, np.ndarray | np.generic)}
            assert wrong == {}
            super().__init__(**content)

        @classmethod
        def get_fields_and_field_types(cls):
            return dict.fromkeys(made.__dataclass_fields__)

    Message.__name__ = made.__name__
    return Message


def said(now_s=1.0):
    """A scan of a room of 4 m, with where the laser and the robot are."""
    make = outputs.RosMessages()
    scan = make.make(
        "sensor_msgs/LaserScan", header=make.header(now_s, "laser"), angle_min=-1.5, angle_max=1.5,
        angle_increment=0.05, time_increment=0.0, scan_time=0.1, range_min=0.1, range_max=8.0,
        ranges=array("f", [2.0] * 61), intensities=array("f"),
    )  # fmt: skip
    return {
        "/tf_static": make.transform((0.1, 0.0, 0.0), now_s, ("base_link", "laser")),
        "odom": make.odometry((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), now_s, ("odom", "base_link")),
        "scan": scan,
    }


def hears(node, now_s=1.0):
    node.now_s = now_s
    for topic, message in said(now_s).items():
        node.subscriptions[topic].take(message)


@pytest.mark.parametrize("name", nodes.NODES)
def test_each_node_sends_on_its_topics_what_their_types_are(ros, name):
    ros.spin = hears
    assert main(["ros", name, "--ros-args", "-p", "preset:=recorded"]) == 0
    node = vars(ros)[f"tagalong_{name}"]
    assert ros.args == ["tagalong", "--ros-args", "-p", "preset:=recorded"]
    for topic, publisher in node.publishers.items():
        assert publisher.sent, topic
        assert all(type(message) is publisher.kind for message in publisher.sent)
    assert node.said == ["destroyed"]


def test_what_a_node_finds_out_is_told(ros, monkeypatch):
    monkeypatch.setattr(nodes.FilterLogic, "notes", lambda self: ["the laser spins"])
    ros.spin = lambda node: node.subscriptions["scan"].take(said()["scan"])
    nodes.run_node("filter")
    assert ros.tagalong_filter.said == ["the laser spins", "destroyed"]


def test_sensors_are_heard_as_they_send_and_late_comers_get_the_map(ros):
    nodes.run_node("slam")
    node = ros.tagalong_slam
    quality = {topic: each.quality for topic, each in {**node.subscriptions, **node.publishers}.items()}
    assert quality["scan"].reliability == quality["odom"].reliability == "BEST_EFFORT"
    assert quality["/tf_static"].durability == quality["map"].durability == "TRANSIENT_LOCAL"
    assert (quality["/tf"].reliability, quality["/tf"].durability) == ("RELIABLE", "VOLATILE")


def test_a_robot_is_told_to_stand_still_when_scans_stop_and_when_the_node_ends(ros):
    def spin(node):
        hears(node)
        node.now_s = 1.6
        node.timers[0]()
        raise KeyboardInterrupt

    ros.spin = spin
    ros.given["stamped"] = True
    nodes.run_node("follower")
    sent = ros.tagalong_follower.publishers["cmd_vel"].sent
    assert len(sent) == 3  # a command, the halt of the watchdog, that of the end
    assert [each.twist.linear.x for each in sent[1:]] == [0.0, 0.0]


def test_a_damaged_message_is_told_and_the_node_goes_on(ros):
    def spin(node):
        node.subscriptions["scan"].take(object())
        hears(node)

    ros.spin = spin
    nodes.run_node("people")
    assert "not what its type says" in ros.tagalong_people.said[0]
    assert ros.tagalong_people.publishers["people"].sent


def test_a_wrong_parameter_and_a_missing_ros_are_told_in_a_line(ros, capsys, monkeypatch):
    ros.given["max_speed"] = -1.0
    assert main(["ros", "follower"]) == 2
    assert "max_speed" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "rclpy", None)
    assert main(["ros", "filter"]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "a node needs rclpy, which comes with ROS 2" in told


def test_the_command_knows_the_nodes_that_there_are():
    assert set(command.NODES) == set(nodes.NODES)


def test_the_parameters_of_the_turtlebot_are_parameters_of_the_nodes():
    yaml = pytest.importorskip("ruamel.yaml")
    told = yaml.YAML(typ="safe").load((FOLDER / "turtlebot4.yaml").read_text())
    assert set(told) == {f"tagalong_{name}" for name in nodes.NODES}
    for name, (_, config) in nodes.NODES.items():
        config(**told[f"tagalong_{name}"]["ros__parameters"])


def test_the_launch_file_starts_each_node_with_the_parameters_beside_it(monkeypatch):
    noted = SimpleNamespace(
        LaunchDescription=list,
        DeclareLaunchArgument=lambda name, default_value: (name, default_value),
        ExecuteProcess=lambda **options: options,
        IfCondition=lambda condition: condition,
        LaunchConfiguration=lambda name: f"${name}",
    )
    for module in ("launch", "launch.actions", "launch.conditions", "launch.substitutions"):
        monkeypatch.setitem(sys.modules, module, noted)
    made = runpy.run_path(str(FOLDER / "turtlebot4.launch.py"))["generate_launch_description"]()
    (_, file), *rest = made
    assert Path(file) == FOLDER / "turtlebot4.yaml"
    commands = [each["cmd"] for each in rest if isinstance(each, dict)]
    assert {words[2] for words in commands} == set(nodes.NODES)
    assert all(words[3:] == ["--ros-args", "--params-file", "$params_file"] for words in commands)
