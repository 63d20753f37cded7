"""What the node `follower` does: finds the leader in scans, and commands the robot, as long as it sees."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...agents import EXPLORERS, Follower, make_follower
from ...envs.onboard.camera_pipeline import NoCamera
from ...envs.onboard.immobile_map import OwnDrawing
from ...envs.onboard.mappers import NoMapper
from ...envs.onboard.stack import OnboardStack
from ...envs.task.interface import FollowInterface
from ...envs.task.observation import ObservationConfig, Observed, Observer
from ...perception.config import perception_preset
from ...perception.leader.selector import LeaderSelector
from ...perception.people_filter import PeopleFilter
from ...slam.bounds import check_numbers, check_positive
from ...slam.errors import InputError
from ...slam.scan import LaserScan
from .filter_logic import MARKERS, people_markers
from .live_scans import InputConfig, LiveScan, LiveScans
from .outputs import MadeMessages, Maker, Output

TWIST, STAMPED_TWIST = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"


@dataclass(frozen=True, kw_only=True)
class FollowerNodeConfig(InputConfig):
    """Parameters of the node `follower`.

    Attributes:
        follower: Who drives, as of `tagalong evaluate`: "pid", "learned", "pid+guard", module:class, a folder.
        preset: Numbers of the tracker, as of `tagalong filter --preset`.
        forest: Leg forest: "real", "simulation" or a file.
        max_speed: Highest forward speed [m/s].
        max_turn_rate: Highest turn rate [rad/s].
        half_length: Half of the robot's length [m].
        half_width: Half of its width [m].
        patience_s: Without a scan and odometry younger than this there is no command [s].
        stamped: Whether commands are TwistStamped, as Nav2 has them from Jazzy on; else Twist.
    """

    follower: str = "pid+guard"
    preset: str = "recorded"
    forest: str = "real"
    max_speed: float = 0.3
    max_turn_rate: float = 1.0
    half_length: float = 0.18
    half_width: float = 0.18
    patience_s: float = 0.5
    stamped: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        check_numbers(self)
        check_positive(self, "max_speed", "max_turn_rate", "half_length", "half_width", "patience_s")


class FollowerLogic:
    """Sends commands while scans and odometry come, once a halt when they do not, and then nothing.

    The leader is who stands nearest when the node begins, as in the environments; `Belief` is made as there.

    Args:
        maker: Of messages.
        config: Parameters.
    """

    def __init__(self, maker: Maker, config: FollowerNodeConfig) -> None:
        self.outputs = {"cmd_vel": STAMPED_TWIST if config.stamped else TWIST, "people/markers": MARKERS}
        self._config, self._messages, self._scans = config, MadeMessages(maker), LiveScans(config)
        perception = replace(perception_preset(config.preset), forest=config.forest)
        selector = LeaderSelector(perception.leader, perception.tracker.motion)
        self._stack = OnboardStack(PeopleFilter(perception), selector, NoMapper(), OwnDrawing(), NoCamera())
        self._driver: Follower | None = None
        self._bearings = np.zeros(0)
        self._observer: Observer | None = None
        make_follower(config.follower)  # who is unknown is told before anything moves
        if config.follower in EXPLORERS:
            raise InputError(f"{config.follower} explores without a leader; the node follows one")
        self._drives, self._fresh_s = False, -np.inf

    def take(self, source: str, message: Any, now_s: float) -> list[Output]:
        """Take a message; return the command that the newest scan gives, if it is new enough."""
        ready = self._scans.take(source, message, now_s)
        return [output for live in ready for output in self._send(live, now_s)] + self.tick(now_s)

    def tick(self, now_s: float) -> list[Output]:
        """Halt if nothing new has come for too long."""
        if not self._drives or now_s - self._fresh_s <= self._config.patience_s:
            return []
        return self.halt(now_s)

    def notes(self) -> list[str]:
        """Return what the scans have shown of the laser since the last call."""
        return self._scans.notes()

    def halt(self, now_s: float) -> list[Output]:
        """Return the command to stand still, which is the last one until scans come again."""
        self._drives = False
        return [self._command(np.zeros(3), now_s)]

    def _send(self, live: LiveScan, now_s: float) -> list[Output]:
        scan = self._resampled(live.scan)
        belief = self._stack.update(scan, live.odometry)
        markers = people_markers(self._messages, belief.filtered_scan, live, self._scans.odom_frame, belief.leader_id)
        sent = [Output("people/markers", markers)]
        assert self._observer is not None
        assert self._driver is not None
        action = self._driver.act(self._observer.observe(belief))
        self._fresh_s = min(scan.time_s, live.odometry_s, now_s)  # a clock that is ahead makes nothing newer
        if now_s - self._fresh_s <= self._config.patience_s:
            self._drives = True
            top = (self._config.max_speed, 0.0, self._config.max_turn_rate)
            velocity = np.clip((action[0], 0.0, action[-1]), -1.0, 1.0) * top
            sent.append(self._command(velocity, now_s))
        return sent

    def _resampled(self, scan: LaserScan) -> LaserScan:
        """Return the scan on the beams of the first one: some lasers have another number of them in each turn."""
        if len(scan) < 2:
            raise InputError(f"a scan has {len(scan)} beams: two are the fewest")
        if self._driver is None:
            self._begin(scan)
        if len(scan) == len(self._bearings) and np.allclose(scan.bearings, self._bearings, atol=1e-4):
            return scan
        after = np.clip(np.searchsorted(scan.bearings, self._bearings), 1, len(scan) - 1)
        nearer = after - (self._bearings - scan.bearings[after - 1] < scan.bearings[after] - self._bearings)
        return replace(scan, ranges=scan.ranges[nearer], bearings=self._bearings)

    def _begin(self, scan: LaserScan) -> None:
        config = self._config
        self._bearings = scan.bearings
        interface = FollowInterface(
            max_speed=config.max_speed,
            max_turn_rate=config.max_turn_rate,
            bearings=self._bearings,
            range_max=scan.range_max,
            T_robot_lidar=scan.T_robot_lidar,
            half_length=config.half_length,
            half_width=config.half_width,
        )
        beams = len(self._bearings)
        seen = Observed(config=ObservationConfig(), beams=beams, holonomic=False, leader=True, map=False, camera=None)
        self._observer = Observer(seen)
        self._driver = make_follower(config.follower, interface)
        self._driver.reset()

    def _command(self, velocity: NDArray[np.float64] | Sequence[float], now_s: float) -> Output:
        twist = self._messages.twist(velocity)
        if self._config.stamped:
            header = self._messages.header(now_s, "base_link")
            twist = self._messages.make("geometry_msgs/TwistStamped", header=header, twist=twist)
        return Output("cmd_vel", twist)
