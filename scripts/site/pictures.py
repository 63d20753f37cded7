"""`python -m tagalong.scripts.site.pictures DIR`: draws the pictures and videos of the site anew, from one seed.

They are in the repository as `docs/images/environments` and `docs/images/methods`; `make pictures` draws them there.
"""

import sys
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ...agents.roster import make_follower
from ...agents.tour import FollowingTour, TourConfig, following_tour
from ...envs.follow_env import FollowEnv
from ...envs.recording.operator import Operator
from ...envs.recording.rollout import rollout
from ...envs.registration import IDS
from ...envs.sensors.camera.config import RgbdConfig
from ...envs.world.config import WorldConfig
from ...envs.world.world import World
from ...perception.rgbd.frame import RgbdFrame
from ...perception.rgbd.people import RgbdPeople
from ...perception.rgbd.people_finder import PeopleFinder
from ...perception.rgbd.planes import PlaneFinder
from ...slam.engine import make_slam
from ...slam.files.output import replacing
from ...slam.geometry import between, compose, transform_points
from ...slam.localization.localizer import Localizer
from ...slam.runner import run_slam
from ...slam.scan import LaserScan
from ...slam.scan_to_scan.matchers import make_matcher
from ..figures.canvas import BLUE, GREEN, INK, ORANGE, PlanCanvas, save_png, side_by_side
from ..figures.detections import save_detections
from ..figures.scans import scan_pair_picture
from ..figures.trajectory import trajectory_picture
from .planner_picture import planner_picture

WIDTH = 900
"""Of a picture [px]."""
COLOURS = 256
"""Of a picture's palette: with fewer, rare ones are lost, such as of a start."""
SEED = 3
"""Of everything that is drawn here."""
VIDEO_STEPS, VIDEO_EVERY, VIDEO_FPS = 240, 4, 8.0
"""Length of an environment's video [steps], steps between its frames, and frames a second [1/s]: 3.2 times as fast."""
VIDEO_WIDTH, VIDEO_QUALITY = 560, 40
"""Of such a video [px], and how well it is kept (WebP's 0 to 100): some 250 kilobytes."""
MATCHED = (200, 208)
"""Scans of the drive that the matchers lay on each other."""
CAMERA_FRAMES, CAMERA_S = 4, 120.0
"""So many frames of the camera are shown, of so long a drive at most [s]."""
_WALLS = (190, 195, 202)


def draw_all(folder: Path) -> None:
    """Draw every picture into `folder`."""
    for arguments in IDS.values():
        scene = str(arguments["scene"])
        save_webp(folder / "environments" / f"{scene}.webp", environment_video(arguments))
    tour = following_tour(TourConfig(scene="meeting_room", people=3, seed=SEED))
    _save(folder / "methods" / "people-filter.png", filter_picture(tour))
    _save(folder / "methods" / "matchers.png", matcher_picture(tour))
    for name in ("gmapping", "cartographer"):
        _save(folder / "methods" / f"{name}.png", engine_picture(tour, name))
    _save(folder / "methods" / "followers.png", followers_picture())
    _save(folder / "methods" / "mppi.png", planner_picture(SEED))
    _save(folder / "methods" / "mapper.png", mapper_picture())
    _save(folder / "methods" / "localization.png", localization_picture(tour))
    _save(folder / "methods" / "explorers.png", explorer_picture())
    save_detections(folder / "methods" / "camera.png", camera_frames())


def environment_video(arguments: dict[str, Any]) -> list[Image.Image]:
    """Return the first 24 s behind PID, as the environment renders itself."""
    env = gym.make("tagalong/Corridor-v0", render_mode="rgb_array", **arguments)
    frames: list[Image.Image] = []

    def film(inner: FollowEnv) -> None:
        if round(inner.truth.time_s * inner.config.task.control_hz) % VIDEO_EVERY == 0:
            picture = inner.render()
            assert picture is not None
            frames.append(Image.fromarray(picture))

    rollout(env, make_follower("pid"), seed=SEED, steps=VIDEO_STEPS, after_step=film)
    env.close()
    return frames


def filter_picture(tour: FollowingTour) -> Image.Image:
    """Return the scan with most returns on people, raw and filtered."""
    scans = tour.drive.recording.scans
    removed = [int((a.is_return & ~b.is_return).sum()) for a, b in zip(scans, tour.filtered, strict=True)]
    at = int(np.argmax(removed))
    return scan_pair_picture(scans[at], tour.filtered[at], tour.people_robot[at])


def engine_picture(tour: FollowingTour, name: str) -> Image.Image:
    """Return the map and the way that an engine makes of the filtered scans, and the way by odometry alone."""
    drive = tour.drive.recording
    engine = make_slam(name, seed=SEED)
    for odometry, scan in zip(drive.odometry, tour.filtered, strict=True):
        engine.update(odometry, scan)
    engine.finish()
    ways = {f"by {name}": engine.trajectory(), "by odometry alone": drive.odometry}
    return trajectory_picture(engine.map(), ways, f"meeting room, 3 people filtered out, {name}")


def matcher_picture(tour: FollowingTour) -> Image.Image:
    """Return two scans 0.8 s apart, laid on each other by nothing, by PL-ICP and by the global matcher."""
    first, second = (tour.filtered[at] for at in MATCHED)
    lasers = [compose(tour.drive.truth[at], first.T_robot_lidar) for at in MATCHED]
    wanted = between(*lasers)
    sheets = [_two_scans(first, second, np.zeros(3), "no motion assumed")]
    for name in ("plicp", "global"):
        pose = np.asarray(make_matcher(name).match(first, second, np.zeros(3)).pose)
        off = 100.0 * float(np.hypot(*(pose - wanted)[:2]))
        sheets.append(_two_scans(first, second, pose, f"{name}: {off:.1f} cm off"))
    return side_by_side(sheets)


def _two_scans(first: LaserScan, second: LaserScan, pose: NDArray[np.float64], title: str) -> Image.Image:
    canvas = PlanCanvas((-5.0, -5.0), (5.0, 5.0), title, (560, 560))
    for scan, place, colour in ((first, np.zeros(3), INK), (second, pose, ORANGE)):
        points = transform_points(place, scan.beam_points)
        canvas.dots(points[np.all(np.abs(points) < 5.0, axis=1)], colour, 1.6)
    canvas.legend([("first scan", INK), ("second scan", ORANGE)])
    return canvas.finished()


def followers_picture() -> Image.Image:
    """Return the ways of three followers behind the same leader through the same office."""
    env = gym.make("tagalong/Office-v0", slam=None, people_count=4, split="test")
    inner = env.unwrapped
    assert isinstance(inner, FollowEnv)
    ways = {}
    for name in ("pid", "pure_pursuit", "learned"):
        history = rollout(env, make_follower(name, inner.interface), seed=SEED).history
        ways[name] = history.robot_pose[:, :2]
        leader = history.leader_position
    floor = np.asarray(inner.world.scene.floor)
    canvas = PlanCanvas(floor.min(axis=0) - 0.3, floor.max(axis=0) + 0.3, "one tour, three followers", (1200, 800))
    for solid in inner.world.scene.solids:
        if solid.at_height(0.3):
            canvas.polygon(solid.outline(), _WALLS)
    canvas.line(leader, INK, 1.5)
    colours = dict(zip(ways, (ORANGE, GREEN, BLUE), strict=True))
    for name, way in ways.items():
        canvas.line(way, colours[name], 2.0)
    canvas.legend([("leader", INK), *colours.items()])
    return canvas.finished()


def mapper_picture() -> Image.Image:
    """Return the maps that PID and the mapper come home with from the same tour."""
    env = gym.make("tagalong/Office-v0", slam="cartographer", people_count=3, split="test", coverage=True)
    inner = env.unwrapped
    assert isinstance(inner, FollowEnv)
    sheets = []
    for name in ("pid", "mapper"):
        history = rollout(env, make_follower(name, inner.interface), seed=SEED).history
        title = f"{name}: {100 * history.coverage[-1]:.0f} % of the floor seen"
        sheets.append(trajectory_picture(inner.own_map().map, {name: history.estimated_pose}, title))
    return side_by_side(sheets)


def localization_picture(tour: FollowingTour) -> Image.Image:
    """Return where a robot that does not know where it is finds itself on the map of the same drive."""
    drive = tour.drive.recording
    run = run_slam(make_slam("gmapping", seed=SEED), drive)
    grid, localizer, found = run.map(), Localizer(run.map()), []
    half = len(drive) // 2
    for odometry, scan in zip(drive.odometry[half:], drive.scans[half:], strict=True):
        pose = localizer.update(odometry, scan).pose
        found.append(np.full(3, np.nan) if pose is None else pose)
    poses = np.array(found)
    sure = poses[~np.isnan(poses[:, 0])]
    title = f"sure at {len(sure)} of {len(poses)} scans, no start given"
    return trajectory_picture(grid, {"by localization": sure, "by SLAM": run.trajectory[half:]}, title)


def explorer_picture() -> Image.Image:
    """Return the way of the frontier explorer, and the map that it has made of the meeting room."""
    env = gym.make("tagalong/MeetingRoom-v0", leader=False, people_count=1, slam="cartographer")
    inner = env.unwrapped
    assert isinstance(inner, FollowEnv)
    history = rollout(env, make_follower("frontier", inner.interface), seed=SEED).history
    title = f"{100 * history.coverage[-1]:.0f} % of the floor seen in {history.time_s[-1]:.0f} s"
    return trajectory_picture(inner.own_map().map, {"by frontiers": history.estimated_pose}, title)


def camera_frames() -> list[tuple[RgbdFrame, RgbdPeople]]:
    """Return frames of the laboratory in which somebody was found, and who."""
    config = WorldConfig(scene="lab", route="operator", leader=False, people=0, camera=RgbdConfig())
    world = World(config, np.random.default_rng(SEED))
    operator, planes, people = Operator(world.scene), PlaneFinder(), PeopleFinder.load()
    shown: list[tuple[RgbdFrame, RgbdPeople]] = []
    last_s = -np.inf
    while len(shown) < CAMERA_FRAMES and world.time_s < CAMERA_S:
        world.step(operator.command(world.truth))
        frame = world.frames[-1] if world.frames else None
        if frame is not None and frame.time_s > last_s + 4.0:
            found = people.find(frame, planes.find(frame))
            if len(found):
                last_s = frame.time_s
                shown.append((frame, found))
    return shown


def save_webp(path: Path, frames: list[Image.Image]) -> None:
    """Write frames of one size as a WebP that moves and loops: a quarter of a GIF, and shown by every browser."""
    size = (VIDEO_WIDTH, round(frames[0].height * VIDEO_WIDTH / frames[0].width))
    first, *others = [frame.resize(size, Image.Resampling.LANCZOS) for frame in frames]
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as temporary:
        first.save(
            temporary,
            format="WEBP",
            save_all=True,
            append_images=others,
            duration=round(1000 / VIDEO_FPS),
            loop=0,
            quality=VIDEO_QUALITY,
        )


def _save(path: Path, picture: Image.Image) -> None:
    """Write a picture, narrowed and with few colours, so that it is some tens of kilobytes."""
    path.parent.mkdir(parents=True, exist_ok=True)
    height = round(picture.height * WIDTH / picture.width)
    small = picture.resize((WIDTH, height), Image.Resampling.LANCZOS) if picture.width > WIDTH else picture
    save_png(path, small.convert("P", palette=Image.Palette.ADAPTIVE, colors=COLOURS))


if __name__ == "__main__":
    draw_all(Path(sys.argv[1]))
