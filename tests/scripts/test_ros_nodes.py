"""What the nodes of ROS 2 do, without ROS: messages of bags that the simulator made, one after the other."""

import gymnasium as gym
import numpy as np
import pytest
from tagalong.agents import make_follower
from tagalong.envs import rollout
from tagalong.envs.recording import EpisodeRecording
from tagalong.scripts.cli import main
from tagalong.scripts.ros import filter_logic, follower_logic, outputs, slam_logic
from tagalong.slam import InputError
from tagalong.slam.geometry import between, compose
from tagalong.slam.logs import open_recording

rosbags = pytest.importorskip("rosbags.highlevel")
SOURCES = {"/scan": "scan", "/odom": "odom", "/tf_static": "/tf_static"}
SIMULATED = {"forest": "simulation", "preset": "recorded"}
STEPS = 50


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    """An episode in a corridor among people, as the simulator records it."""
    path = tmp_path_factory.mktemp("bag") / "episode.mcap"
    env = gym.make("tagalong/Corridor-v0", people_count=3, slam=None, beams=361)
    with open_recording(path) as recording:
        episodes = EpisodeRecording(recording)
        episodes.finish(rollout(env, make_follower("pid"), seed=4, steps=STEPS, after_step=episodes.take))
    return path


def messages(path, *topics):
    """Topic, time [s] and content of the messages of a bag, in its order."""
    with rosbags.AnyReader([path]) as reader:
        wanted = [each for each in reader.connections if each.topic in topics]
        found = [(c.topic, 1e-9 * ns, reader.deserialize(raw, c.msgtype)) for c, ns, raw in reader.messages(wanted)]
    return found


def play(logic, path):
    """What a node sends while a bag is played, by topic."""
    sent = {}
    for topic, now_s, message in messages(path, *SOURCES):
        for output in logic.take(SOURCES[topic], message, now_s):
            sent.setdefault(output.topic, []).append(output.message)
    return sent


def same(one, other):
    """Whether two messages say the same, NaN being NaN."""
    if hasattr(one, "__msgtype__"):
        return all(same(getattr(one, name), getattr(other, name)) for name in vars(one) if name != "__msgtype__")
    if isinstance(one, list):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, np.ndarray | float):
        return np.array_equal(np.asarray(one), np.asarray(other), equal_nan=True)
    return one == other


@pytest.fixture
def make():
    return outputs.RosMessages()


def test_the_filter_sends_message_by_message_what_the_command_writes_into_a_bag(bag, make, tmp_path):
    config = filter_logic.FilterNodeConfig(**SIMULATED)
    sent = play(filter_logic.FilterLogic(make, config), bag)
    words = [str(bag), str(tmp_path / "out.mcap"), "--forest", "simulation", "--lag", "0", "--quiet"]
    assert main(["filter", *words, "--scan-topic", "/scan", "--topic", "/node"]) == 0
    for ours, theirs in {"scan_filtered": "/node", "scan_filtered/tracks": "/node/tracks"}.items():
        written = [message for _, _, message in messages(tmp_path / "out.mcap", theirs)]
        assert len(sent[ours]) == len(written) == STEPS + 1
        assert all(map(same, sent[ours], written)), ours
    removed = [np.isnan(message.ranges).sum() for message in sent["scan_filtered"]]
    assert max(removed) > 5  # somebody was there


def test_people_are_where_they_walk(bag, make):
    sent = play(filter_logic.PeopleLogic(make, filter_logic.FilterNodeConfig(**SIMULATED)), bag)
    assert set(sent) == {"people", "people/tracks", "people/markers"}
    truth = [message for *_, message in messages(bag, "/truth/people")]
    poses = [message for *_, message in messages(bag, "/truth/pose")]
    markers, found = sent["people/markers"], 0
    T_world_odom = np.array([poses[0].pose.position.x, poses[0].pose.position.y, heading(poses[0].pose)])
    for seen, real in zip(markers[20:], truth[20:], strict=True):
        real_places = places(real)
        for place in places(seen):
            there = compose(T_world_odom, np.array([*place, 0.0]))[:2]
            found += np.hypot(*(real_places - there).T).min() < 0.4
    assert found >= 25
    assert {m.header.frame_id for message in markers for m in message.markers} == {"odom"}


def heading(pose):
    return 2.0 * np.arctan2(pose.orientation.z, pose.orientation.w)


def places(message):
    return np.array([(m.pose.position.x, m.pose.position.y) for m in message.markers[1:]]).reshape(-1, 2)


def test_slam_sends_the_map_and_where_the_odometry_is_on_it(bag, make):
    config = slam_logic.SlamNodeConfig(method="gmapping", map_every_s=1.0, ahead_s=0.2, **SIMULATED)
    sent = play(slam_logic.SlamLogic(make, config), bag)
    assert len(sent["/tf"]) == STEPS + 1
    assert len(sent["map"]) == 6
    grid = sent["map"][-1]
    assert grid.info.width * grid.info.height == len(grid.data)
    assert {-1, 0} < set(np.unique(grid.data).tolist())
    links = [each.transforms[0] for each in sent["/tf"]]
    assert {(link.header.frame_id, link.child_frame_id) for link in links} == {("map", "odom")}
    assert links[5].header.stamp.nanosec == round(1e9 * (0.5 + 0.2))
    poses = [message.pose for *_, message in messages(bag, "/truth/pose")]
    odometry = [message.pose.pose for *_, message in messages(bag, "/odom")]
    for k in (10, STEPS):
        T_map_odom = np.array([links[k].transform.translation.x, links[k].transform.translation.y, turn(links[k])])
        believed = compose(T_map_odom, planar(odometry[k]))
        assert np.abs(believed - between(planar(poses[0]), planar(poses[k])))[:2].max() < 0.15


@pytest.mark.parametrize("method", ["gmapping", "cartographer", "ekf"])
def test_slam_sends_where_the_robot_is_with_a_covariance(bag, make, method):
    config = slam_logic.SlamNodeConfig(method=method, map_every_s=1e6, filter_people=False, **SIMULATED)
    sent = play(slam_logic.SlamLogic(make, config), bag)
    truth = [planar(message.pose) for *_, message in messages(bag, "/truth/pose")]
    assert len(sent["pose"]) > STEPS // 2
    last = sent["pose"][-1]
    covariance = np.array(last.pose.covariance).reshape(6, 6)[np.ix_((0, 1, 5), (0, 1, 5))]
    assert last.header.frame_id == "map"
    assert (np.linalg.eigvalsh(covariance) > 0.0).all()
    error = planar(last.pose.pose) - between(truth[0], truth[-1])
    assert error @ np.linalg.solve(covariance, error) < 16.3  # one in a thousand is beyond


def test_while_slam_is_not_sure_it_sends_no_pose(bag, make, monkeypatch):
    logic = slam_logic.SlamLogic(make, slam_logic.SlamNodeConfig(map_every_s=1e6, filter_people=False, **SIMULATED))
    monkeypatch.setattr(logic, "_engine", Elsewhere())
    logic._map_s = 0.0
    assert "pose" not in play(logic, bag)


class Elsewhere:
    """An engine that has the robot at one place, far from where its odometry has it."""

    pose = np.array([2.0, 1.0, 1.5])
    located, covariance = False, np.eye(3)

    def update(self, odometry, scan):
        return self


def test_the_transform_takes_the_odometry_to_where_slam_has_the_robot(bag, make, monkeypatch):
    logic = slam_logic.SlamLogic(make, slam_logic.SlamNodeConfig(map_every_s=1e6, filter_people=False, **SIMULATED))
    monkeypatch.setattr(logic, "_engine", Elsewhere())
    logic._map_s = 0.0
    link = play(logic, bag)["/tf"][-1].transforms[0]
    T_map_odom = np.array([link.transform.translation.x, link.transform.translation.y, turn(link)])
    odometry = planar([message.pose.pose for *_, message in messages(bag, "/odom")][-1])
    np.testing.assert_allclose(compose(T_map_odom, odometry), Elsewhere.pose, atol=1e-6)


def turn(link):
    return 2.0 * np.arctan2(link.transform.rotation.z, link.transform.rotation.w)


def planar(pose):
    return np.array([pose.position.x, pose.position.y, heading(pose)])


class Robot:
    """The simulated robot behind messages: what its sensors say, and what a command does to it."""

    def __init__(self, make):
        self.env = gym.make("tagalong/Corridor-v0", people_count=1, slam=None, beams=361).unwrapped
        self.make = make
        self.env.reset(seed=3)

    def says(self):
        belief = self.env.belief
        now_s = belief.scan.time_s
        frames = self.make.transform(belief.scan.T_robot_lidar, now_s, ("base_link", "laser"))
        odometry = self.make.odometry(belief.odometry, np.zeros(3), now_s, ("odom", "base_link"))
        scan = self.make.scan(belief.scan, now_s, "laser")
        return now_s, (("/tf_static", frames), ("odom", odometry), ("scan", scan))

    def obeys(self, twist):
        scales = self.env.interface
        return self.env.step((twist.linear.x / scales.max_speed, twist.angular.z / scales.max_turn_rate))


def commands(outputs):
    return [output.message for output in outputs if output.topic == "cmd_vel"]


@pytest.fixture
def follower(make):
    scales = {"max_speed": 1.3, "max_turn_rate": 2.0, "half_length": 0.275, "half_width": 0.259}
    config = follower_logic.FollowerNodeConfig(follower="pid", **scales, **SIMULATED)
    return follower_logic.FollowerLogic(make, config)


def test_a_robot_that_obeys_the_commands_follows_its_leader(make, follower):
    robot = Robot(make)
    for _ in range(120):
        now_s, said = robot.says()
        outputs = [output for source, message in said for output in follower.take(source, message, now_s)]
        (command,) = commands(outputs)
        *_, info = robot.obeys(command)
    assert info["following_leader"]
    assert info["leader_distance"] < 2.0
    assert np.hypot(*robot.env.truth.robot_velocity[:2]) > 0.5
    assert any(marker.color.g > 0.6 for marker in outputs[0].message.markers[1:])  # the leader in green


def test_without_scans_for_half_a_second_there_is_one_halt_and_then_nothing(make, follower):
    robot = Robot(make)
    now_s, said = robot.says()
    assert len(commands([output for each in said for output in follower.take(*each, now_s)])) == 1
    assert follower.tick(now_s + 0.4) == []
    (halt,) = commands(follower.tick(now_s + 0.51))
    assert (halt.linear.x, halt.angular.z) == (0.0, 0.0)
    assert follower.tick(now_s + 0.6) == []


def test_a_scan_that_comes_late_moves_nothing(make, follower):
    now_s, said = Robot(make).says()
    assert commands([output for each in said for output in follower.take(*each, now_s + 0.6)]) == []


def test_scans_without_odometry_move_nothing(make, follower):
    robot = Robot(make)
    now_s, said = robot.says()
    for each in said:
        follower.take(*each, now_s)
    for _ in range(8):
        robot.env.step((0.0, 0.0))
        now_s, said = robot.says()
        outputs = follower.take("scan", dict(said)["scan"], now_s)
    assert commands(outputs) == []


def test_a_clock_that_is_ahead_makes_nothing_newer(make, follower):
    now_s, said = Robot(make).says()
    for each in said:
        follower.take(*each, now_s - 10.0)
    assert commands(follower.tick(now_s - 10.0 + 0.51))


@pytest.mark.parametrize("name", ["learned", "reinforced"])
def test_policies_drive_by_what_a_full_circle_has_of_what_they_know(make, name):
    beams = {"beams": 720, "field_of_view": np.deg2rad(359.5)}
    env = gym.make("tagalong/Corridor-v0", people_count=1, slam=None, **beams).unwrapped
    env.reset(seed=3)
    robot = Robot(make)
    robot.env = env
    now_s, said = robot.says()
    logic = follower_logic.FollowerLogic(make, follower_logic.FollowerNodeConfig(follower=name, **SIMULATED))
    outputs = [o for each in said[:2] for o in logic.take(*each, now_s)]
    assert len(commands(outputs + logic.take(*said[2], now_s))) == 1


def test_who_explores_does_not_follow(make):
    with pytest.raises(InputError, match="random explores without a leader"):
        follower_logic.FollowerLogic(make, follower_logic.FollowerNodeConfig(follower="random"))


def test_commands_may_carry_a_stamp(make):
    config = follower_logic.FollowerNodeConfig(follower="pid", stamped=True, **SIMULATED)
    logic = follower_logic.FollowerLogic(make, config)
    now_s, said = Robot(make).says()
    (command,) = commands([output for each in said for output in logic.take(*each, now_s)])
    assert logic.outputs["cmd_vel"] == command.__msgtype__ == "geometry_msgs/msg/TwistStamped"
    assert command.header.frame_id == "base_link"


def test_a_laser_with_another_number_of_beams_in_each_turn_is_followed_all_the_same(make, follower):
    robot = Robot(make)
    for number in range(4):
        now_s, said = robot.says()
        scan = dict(said)["scan"]
        kept = 361 - number
        scan = make.make("sensor_msgs/LaserScan", **{**fields_of(scan), "ranges": scan.ranges[:kept]})
        outputs = [o for each in (*said[:2], ("scan", scan)) for o in follower.take(*each, now_s)]
        assert len(commands(outputs)) == 1
        robot.env.step((0.0, 0.0))


def fields_of(message):
    return {name: value for name, value in vars(message).items() if name != "__msgtype__"}


def test_scans_wait_until_the_place_of_the_laser_is_known(bag, make):
    config = filter_logic.FilterNodeConfig(**SIMULATED)
    unplaced, told = (
        filter_logic.FilterLogic(make, config),
        filter_logic.FilterNodeConfig(laser_pose=(0.1, 0.0, 0.0), **SIMULATED),
    )
    placed = filter_logic.FilterLogic(make, told)
    first = messages(bag, "/scan", "/odom")[:4]
    assert [o for topic, now_s, m in first for o in unplaced.take(SOURCES[topic], m, now_s)] == []
    assert len([o for topic, now_s, m in first for o in placed.take(SOURCES[topic], m, now_s)]) == 8


def test_a_message_that_is_not_what_its_type_says_is_told_and_the_next_one_is_taken(bag, make):
    logic = filter_logic.FilterLogic(make, filter_logic.FilterNodeConfig(laser_pose=(0.1, 0.0, 0.0), **SIMULATED))
    with pytest.raises(InputError, match="not what its type says"):
        logic.take("odom", object(), 0.0)
    with pytest.raises(InputError, match="not what its type says"):
        logic.take("scan", object(), 0.0)
    first = messages(bag, "/scan", "/odom")[:4]
    assert [o.topic for topic, now_s, m in first for o in logic.take(SOURCES[topic], m, now_s)]


@pytest.mark.parametrize(
    ("kind", "wrong", "told"),
    [
        (filter_logic.FilterNodeConfig, {"laser_pose": (0.1,)}, "laser_pose must be x, y, theta"),
        (filter_logic.FilterNodeConfig, {"laser_pose": 1.0}, "laser_pose must be x, y, theta"),
        (filter_logic.FilterNodeConfig, {"laser_pose": (0.1, "left", 0.0)}, "laser_pose"),
        (filter_logic.FilterNodeConfig, {"laser_pose": (1e25, 0.0, 0.0)}, "laser_pose"),
        (filter_logic.FilterNodeConfig, {"forest": 7}, "`forest` must be a word, got 7"),
        (filter_logic.FilterNodeConfig, {"preset": [1]}, "`preset` must be a word"),
        (follower_logic.FollowerNodeConfig, {"stamped": 1.0}, "`stamped` must be true or false"),
        (follower_logic.FollowerNodeConfig, {"max_speed": 0.0}, "max_speed"),
        (follower_logic.FollowerNodeConfig, {"patience_s": float("nan")}, "patience_s"),
        (slam_logic.SlamNodeConfig, {"map_every_s": -1.0}, "map_every_s"),
        (slam_logic.SlamNodeConfig, {"sweep": "round"}, "a laser's sweep is a share"),
        (slam_logic.SlamNodeConfig, {"sweep": 1.0}, "`sweep` must be a word"),
    ],
)
def test_a_parameter_that_cannot_be_is_told(kind, wrong, told):
    with pytest.raises(InputError, match=told):
        kind(**wrong)


@pytest.mark.parametrize("kept", [0, 1])
def test_a_scan_of_hardly_any_beams_is_told_and_the_next_one_followed(make, follower, kept):
    robot = Robot(make)
    for number in range(4):
        now_s, said = robot.says()
        scan = dict(said)["scan"]
        if number in (0, 2):
            few = make.make("sensor_msgs/LaserScan", **{**fields_of(scan), "ranges": scan.ranges[:kept]})
            with pytest.raises(InputError, match="beams"):
                _ = [o for each in (*said[:2], ("scan", few)) for o in follower.take(*each, now_s)]
        else:
            assert len(commands([o for each in said for o in follower.take(*each, now_s)])) == 1
        robot.env.step((0.0, 0.0))
