"""A drive through the simulated lab, recorded as a robot with laser and RGB-D camera would record it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ...envs.recording.operator import Operator
from ...envs.sensors.camera.config import RgbdConfig
from ...envs.world.world import World
from ...perception.rgbd.registration import turned_optical
from ...slam.geometry import between
from ...slam.logs.sensor_recording import SensorRecording
from ...slam.logs.tum import Trajectory, write_tum
from ..reproduce.immobile.drives import lab_world

Array = NDArray[np.float64]

LONGEST_S = 420.0


@dataclass(frozen=True)
class RecordedLab:
    """What was recorded.

    Attributes:
        scans: How many.
        frames: How many.
        seconds: How long the drive was [s].
    """

    scans: int
    frames: int
    seconds: float


def record_lab(path: Path, seed: int, camera: RgbdConfig, longest_s: float = LONGEST_S) -> RecordedLab:
    """Drive once through the lab of `seed` as in `tagalong reproduce immobile`; write `path` and its true poses.

    The true poses, in the frame of the first odometry, are PATH.gt.tum: one a scan.

    Args:
        path: Of the file, ending in .mcap.
        seed: Of building, people and noise.
        camera: The camera.
        longest_s: Where the drive is cut off [s].
    """
    world = lab_world(seed, camera)
    operator, start = Operator(world.scene), world.start.copy()
    times: list[float] = []
    poses: list[Array] = []
    frames, last = 0, None
    with SensorRecording(path) as recording:
        recording.mount(0.0, _mount(camera))
        while True:
            if not times or world.scan().time_s > times[-1]:
                _take(recording, world)
                times.append(world.scan().time_s)
                poses.append(between(start, world.truth.robot_pose))
            if world.frames and world.frames[-1] is not last:
                last = world.frames[-1]
                (across, down), (column, row) = last.camera.focal, last.camera.axis
                centre = (column - 0.5, row - 0.5)
                recording.frame(last.time_s, last.depth, last.colour, (across, down), centre)
                frames += 1
            if operator.done(world.truth) or world.time_s >= longest_s:
                break
            world.step(operator.command(world.truth))
        write_tum(path.with_name(f"{path.name}.gt.tum"), Trajectory(np.array(times), np.array(poses)))
    return RecordedLab(len(times), frames, world.time_s)


def _take(recording: SensorRecording, world: World) -> None:
    scan = world.scan()
    recording.odometry(scan.time_s, world.odometry)
    recording.scan(scan)


def _mount(camera: RgbdConfig) -> Array:
    """Return T_robot_optical (4, 4)."""
    (x, y, theta), pitch, roll = camera.mount, camera.pitch, camera.roll
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("ZYX", (theta, pitch, roll)).as_matrix()
    pose[:3, 3] = x, y, camera.camera_height
    return np.asarray(pose @ np.linalg.inv(turned_optical(np.eye(4))), dtype=np.float64)
