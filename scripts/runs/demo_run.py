"""The main job, once: follow, map from raw and from filtered scans, map the empty building, compare, draw."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ...agents.tour import FollowingTour, TourConfig, following_tour
from ...envs.follow_env import FollowEnv
from ...envs.recording.slow_tour import slow_tour
from ...envs.world.world import WorldConfig
from ...slam.files.output import write_json
from ...slam.logs.drive_folder import SimulatedDrive, write_drive
from ...slam.logs.ros_map import write_ros_map
from ..figures.canvas import save_png, side_by_side, stacked
from ..figures.maps import map_picture, overlay_picture
from ..figures.scans import scan_pair_picture
from ..figures.trajectory import trajectory_picture
from ..figures.video import save_gif
from ..lab.episode_recordings import recorded_episodes, shown_episodes
from ..lab.map_comparison import JudgedMap, MapComparisonConfig, MappedDrive, judge_map, map_reference

FRAME_EVERY = 5
"""Steps between two frames of the video."""
VIDEO_FPS = 10.0
"""Frames a second of the video: five times as fast as the drive [1/s]."""


@dataclass(eq=False)
class Stopwatch:
    """Wall-clock seconds by stage; kept apart from every result, since they differ between two runs."""

    stages: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Say that a stage begins, and time it."""
        print(f"  {name} ...", flush=True)
        start = perf_counter()
        yield
        self.stages[name] = perf_counter() - start


@dataclass(frozen=True, eq=False)
class DemoResult:
    """Everything that the demo made.

    Attributes:
        tour: The drive behind the leader.
        frames: Pictures of it (h, w, 3).
        reference_drive: The slow drive of the empty building.
        reference: Its map.
        raw: The map of the tour from raw scans.
        filtered: The map of the tour from filtered scans.
    """

    tour: FollowingTour
    frames: list[NDArray[np.uint8]]
    reference_drive: SimulatedDrive
    reference: MappedDrive
    raw: JudgedMap
    filtered: JudgedMap

    @property
    def metrics(self) -> dict[str, Any]:
        """All figures by name."""
        return {
            "ending": self.tour.episode.ending,
            "episode": self.tour.episode.metrics,
            "raw": self.raw.to_dict(),
            "filtered": self.filtered.to_dict(),
        }


def run_demo(
    tour_config: TourConfig,
    mapping: MapComparisonConfig,
    watch: Stopwatch,
    settings: Mapping[str, Any] | None = None,
    record: Path | None = None,
    live: bool = False,
) -> DemoResult:
    """Drive, map and compare.

    Args:
        tour_config: The drive.
        mapping: How the maps are made.
        watch: Times the stages.
        settings: Further arguments of the environment in which the robot follows.
        record: Where the drive is recorded for viewers (.mcap, .rrd); None: nowhere.
        live: Whether it is shown in rerun's viewer while it is driven.
    """
    frames: list[NDArray[np.uint8]] = []

    def film(env: FollowEnv) -> None:
        if round(env.truth.time_s * env.config.task.control_hz) % FRAME_EVERY == 0:
            picture = env.render()
            assert picture is not None
            frames.append(picture)

    with (
        watch.stage("following the leader"),
        recorded_episodes(record) as recording,
        shown_episodes(live) as shown,
    ):

        def watched(env: FollowEnv) -> None:
            film(env)
            recording.take(env)
            shown.take(env)

        tour = following_tour(tour_config, watch=watched, render_mode="rgb_array", **(settings or {}))
        recording.finish(tour.episode)
        shown.finish(tour.episode)
    with watch.stage("slow drive of the empty building"):
        reference_drive = slow_tour(WorldConfig(scene=tour_config.scene), tour_config.seed)
    with watch.stage("mapping: reference"):
        reference = map_reference(reference_drive, mapping)
    judged = {}
    for name, scans in (("raw", tour.drive.recording.scans), ("filtered", tour.filtered)):
        with watch.stage(f"mapping: {name} scans"):
            judged[name] = judge_map(tour.drive, scans, reference_drive, reference, mapping)
    return DemoResult(tour, frames, reference_drive, reference, judged["raw"], judged["filtered"])


def write_demo(folder: Path, result: DemoResult) -> None:
    """Write maps, pictures, the video and both drives into `folder`."""
    maps = {"reference": result.reference, "raw": result.raw.drive, "filtered": result.filtered.drive}
    for name, mapped in maps.items():
        write_ros_map(folder / f"map_{name}.yaml", mapped.map)
        save_png(folder / f"map_{name}.png", map_picture(mapped.map, f"{name} map"))
    save_png(folder / "overlay.png", _overlay(result))
    save_png(folder / "scan.png", _busiest_scan(result.tour))
    trajectories = {"by SLAM (filtered scans)": result.filtered.drive.trajectory}
    picture = trajectory_picture(result.filtered.drive.map, trajectories, "the robot's way in its own map")
    save_png(folder / "trajectory.png", picture)
    save_png(folder / "summary.png", summary_picture(result))
    save_gif(folder / "drive.gif", result.frames, VIDEO_FPS)
    write_drive(folder / "drives", result.tour.drive)
    write_drive(folder / "drives", result.reference_drive)


def write_metrics(folder: Path, content: dict[str, Any], watch: Stopwatch) -> None:
    """Write metrics.json and, apart from it, timing.json."""
    write_json(folder / "metrics.json", content)
    write_json(folder / "timing.json", {"stages_s": watch.stages, "total_s": sum(watch.stages.values())})


def summary_picture(result: DemoResult) -> Image.Image:
    """Return the demo in one picture: a moment of the drive above both maps."""
    moment = Image.fromarray(result.frames[len(result.frames) // 3])
    overlay = _overlay(result)
    width = max(moment.width, overlay.width)
    return stacked([_widened(moment, width), _widened(overlay, width)])


def _widened(picture: Image.Image, width: int) -> Image.Image:
    return picture.resize((width, round(picture.height * width / picture.width)), Image.Resampling.LANCZOS)


def _overlay(result: DemoResult) -> Image.Image:
    """Return both maps over the reference, as in Fig. 4 of the paper."""
    pictures = []
    for name, judged in (("raw scans", result.raw), ("people filtered", result.filtered)):
        title = f"{name}: ADNN {100 * judged.score.adnn.mean_m:.2f} cm"
        fit = judged.score.registration.T_ref_est
        pictures.append(overlay_picture(judged.drive.map, result.reference.map, title, fit))
    wide = pictures[0].width > 1.5 * pictures[0].height
    return stacked(pictures) if wide else side_by_side(pictures)


def _busiest_scan(tour: FollowingTour) -> Image.Image:
    """Return the scan with most returns on people, raw and filtered, as in Fig. 1 of the paper."""
    scans = tour.drive.recording.scans
    dropped = [int((a.is_return & ~b.is_return).sum()) for a, b in zip(scans, tour.filtered, strict=True)]
    at = int(np.argmax(dropped))
    return scan_pair_picture(scans[at], tour.filtered[at], tour.people_robot[at])
