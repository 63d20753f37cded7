"""One drive behind a leader, recorded: scans with and without people, odometry, truth and the episode's history."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from ..envs.follow_env import FollowEnv
from ..envs.recording.rollout import Episode, rollout
from ..envs.registration import IDS
from ..slam.errors import unknown_name
from ..slam.logs.drive import RecordedDrive
from ..slam.logs.drive_folder import SimulatedDrive
from ..slam.scan import LaserScan
from .roster import make_follower

SCENES = {"corridor": "tagalong/Corridor-v0", "meeting_room": "tagalong/MeetingRoom-v0"}
"""Environment ids of the paper's two scenes."""


@dataclass(frozen=True, kw_only=True)
class TourConfig:
    """A drive behind a leader.

    Attributes:
        scene: Name of the building.
        people: Number of walking people, the leader included.
        standing: Number of further people who come to stand still.
        odometry: Quality of the wheel odometry.
        follower: Name of the follower.
        seed: Seed of the episode.
        slam: Engine that runs during the drive, for the picture; None for none.
    """

    scene: str = "corridor"
    people: int = 2
    standing: int = 0
    odometry: str = "typical"
    follower: str = "pid"
    seed: int = 0
    slam: str | None = None

    @property
    def name(self) -> str:
        """Name of the drive, e.g. "corridor-2p-s0"; "+1" for a standing person."""
        standing = f"+{self.standing}" if self.standing else ""
        return f"{self.scene}-{self.people}p{standing}-s{self.seed}"


@dataclass(frozen=True, eq=False)
class FollowingTour:
    """What was recorded.

    Attributes:
        drive: Raw scans, odometry, true poses, and where the legs of people truly met the laser's plane.
        filtered: The scans as the robot's people filter left them.
        people_robot: For each scan (n, 2) the people that the robot tracked, in its frame [m].
        episode: The episode with its metrics.
    """

    drive: SimulatedDrive
    filtered: list[LaserScan]
    people_robot: list[NDArray[np.float64]]
    episode: Episode


class _Log:
    """Collects what the robot measured and what was true, step by step."""

    def __init__(self) -> None:
        self.raw: list[LaserScan] = []
        self.filtered: list[LaserScan] = []
        self.odometry: list[NDArray[np.float64]] = []
        self.people: list[NDArray[np.float64]] = []
        self.truth: list[NDArray[np.float64]] = []
        self.legs: list[NDArray[np.float64]] = []

    def take(self, env: FollowEnv) -> None:
        """Add the present moment."""
        belief, truth = env.belief, env.truth
        self.raw.append(belief.scan)
        self.filtered.append(belief.filtered)
        self.odometry.append(belief.odometry)
        self.people.append(belief.people_robot.positions)
        self.truth.append(truth.robot_pose)
        self.legs.append(truth.people.legs.reshape(-1, 2))

    def drive(self, name: str) -> SimulatedDrive:
        """Return what was collected as a drive."""
        truth = np.array(self.truth)
        return SimulatedDrive(RecordedDrive(np.array(self.odometry), self.raw, truth, name), truth, np.array(self.legs))


def following_tour(
    config: TourConfig, *, watch: Callable[[FollowEnv], None] | None = None, **env_options: Any
) -> FollowingTour:
    """Drive one tour behind the leader.

    Args:
        config: The drive.
        watch: Called after the reset and after every step, e.g. to take a picture.
        env_options: Further keywords of the environment.

    Raises:
        InputError: If a name is unknown.
    """
    ids = {str(fields["scene"]): name for name, fields in IDS.items()}
    if config.scene not in ids:
        raise unknown_name("scene", config.scene, tuple(ids))
    env = gym.make(ids[config.scene], slam=config.slam, **env_options)
    log = _Log()

    def after_step(inner: FollowEnv) -> None:
        log.take(inner)
        if watch is not None:
            watch(inner)

    inner = env.unwrapped
    assert isinstance(inner, FollowEnv)
    follower = make_follower(config.follower, inner.interface)
    options = {"people": config.people, "standing": config.standing, "odometry": config.odometry}
    episode = rollout(env, follower, seed=config.seed, options=options, after_step=after_step)
    env.close()
    return FollowingTour(log.drive(config.name), log.filtered, log.people, episode)
