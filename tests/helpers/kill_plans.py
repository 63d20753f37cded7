"""Which commands the kill tests kill: all that write, with options that let them end soon."""

import gzip
import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

TAGALONG = ("-m", "tagalong")


@dataclass(frozen=True, kw_only=True)
class Plan:
    """One command.

    Attributes:
        words: Of Python's command line; "IN" stands for the folder of what they read.
        within_s: The kills come at random within so many seconds; None: within the time of a whole run.
        compared: Whether it is run to its end, undisturbed and after kills, and the files are compared.
        in_a_row: Kills in the same folder before it is run to its end.
        once: What it makes last, if it refuses to write where that is already.
        times: Names of its JSON under which stand times by nature; all the rest is compared.
    """

    words: tuple[str, ...]
    within_s: float | None = None
    compared: bool = True
    in_a_row: int = 5
    once: str | None = None
    times: frozenset[str] = frozenset()


def _tagalong(words: str, **more) -> Plan:
    return Plan(words=(*TAGALONG, *words.split()), **more)


_LONG: dict[str, Any] = {"within_s": 8.0, "in_a_row": 20}
"""Of a command that takes minutes and keeps what is done: every kill finds it farther on."""
_SPEEDS = frozenset({"reference_kernel_ms", "steps_per_s", "real_time_factor", "mean_ms", "p95_ms"}) | {
    "single environment",
    "vector environment, 2 processes",
}
"""What `bench speed` measures: of it, the names of its parts, their counts and the machine are compared."""
PLANS = {
    "slam": _tagalong("slam IN/room.log.gz --out out --method gmapping --set particles=20 --set linear_update=0.05"),
    "slam ekf": _tagalong("slam IN/room.log.gz --method ekf --out out"),
    "slam graph": _tagalong("slam IN/room.log.gz --method cartographer --out out"),
    "localize": _tagalong("localize IN/room.log.gz --map IN/map/map.yaml --out out"),
    "slam record": _tagalong("slam IN/room.log.gz --method ekf --out out --record out/drive.mcap"),
    "perceive": _tagalong("perceive IN/room.log.gz --out out"),
    "perceive record": _tagalong("perceive IN/room.log.gz --out out --record out/people.rrd"),
    "perceive frames": _tagalong("perceive IN/frames --out out"),
    "data derive": _tagalong("data derive IN/data --into out"),
    "filter": _tagalong("filter IN/room.log.gz out/room.log.gz"),
    "filter bag": _tagalong("filter IN/room.bag out/room.bag"),
    "filter mcap": _tagalong("filter IN/room.mcap out/room.mcap"),
    "filter folder": _tagalong("filter IN/room out/room", once="out/room"),
    "score": _tagalong("score IN/map/map.yaml IN/map/map.yaml --json out/scores.json --overlay out/overlay.png"),
    "reproduce following": _tagalong("reproduce following --quick --repeats 1 --no-sweep --jobs 2 --out out", **_LONG),
    "reproduce scan-matching": _tagalong("reproduce scan-matching --quick --trials 10 --jobs 2 --out out", **_LONG),
    "reproduce clustering": _tagalong("reproduce clustering --quick --worlds 2 --jobs 2 --out out", **_LONG),
    "reproduce immobile": _tagalong(
        "reproduce immobile --quick --minutes 0.1 --poses truth --camera-hz 1 --jobs 2 --out out", **_LONG
    ),
    "reproduce guidance": _tagalong("reproduce guidance --quick --repeats 2 --minutes 0.1 --jobs 2 --out out", **_LONG),
    "train legs": _tagalong(
        "train legs --forest simulation --scans 40 --drives 1 --test-scans 10 --test-drives 1 --trees 3 --out out"
    ),
    "train people": _tagalong(
        "train people --buildings 24 --level-buildings 12 --frames 4 --test-buildings 1 --out out", in_a_row=20
    ),
    "train follower": Plan(words=("IN/train_follower.py", "out"), **_LONG),
    "train worlds": Plan(words=("IN/train_worlds.py", "out")),
    "train errors": _tagalong("train tracker-errors --seeds 1 --check-seeds 1 --steps 60 --out out", in_a_row=20),
    "evaluate": _tagalong("evaluate pid --episodes 1 --beams 181 --out out"),
    "evaluate record": _tagalong("evaluate pid --episodes 1 --beams 181 --out out --record out/episode.mcap"),
    "record": _tagalong("record --episodes 2 --beams 181 --out out"),
    "compare": _tagalong(
        "compare --suites corridor --followers pid plain_pid --episodes 1 --leaderboard out/leaderboard.md --out out"
    ),
    "teleop": _tagalong("teleop --operator model --out out/drive.txt"),
    "results": _tagalong("results --quick --jobs 2 --out out", **_LONG),
    "bench speed": _tagalong("bench speed --steps 2 --out out", in_a_row=20, times=_SPEEDS),
    "bench simulators": _tagalong("bench simulators --suites corridor --episodes 2 --out out"),
    "compare --slam": _tagalong(
        "compare --suites corridor --followers pid plain_pid --episodes 1 --slam cartographer --jobs 2 --out out"
    ),
    "bench drawn-worlds": _tagalong("bench drawn-worlds --kinds cells --seeds 0 1 --jobs 2 --out out"),
    "demo": _tagalong("demo --out out", in_a_row=20),
}

TRAIN = """
import sys
from dataclasses import replace
from pathlib import Path

from tagalong.scripts.console.last_words import told


def train():
    from tagalong.agents.training import (
        CurriculumConfig, ImitationConfig, ReinforcementConfig, RunConfig, TrainingRun, make_preset
    )

    preset = replace(
        make_preset("corridor", "ppo"),
        env={"slam": None, "beams": 360, "people": "truth"},
        fine={},
        curriculum=CurriculumConfig(scenes=(("corridor", 1.0),), bystanders=(0,)),
        imitation=ImitationConfig(rounds=2, drives=2, most_steps=60, epochs=2, last_epochs=2, batch=64),
        reinforcement=ReinforcementConfig(steps=0),
        width=32,
        evaluations=1,
        most_steps=80,
    )
    TrainingRun(RunConfig(preset=preset, name="tiny", workers=2), Path(sys.argv[1]), print).train()
    return 0


if __name__ == "__main__":
    sys.exit(told(train))
"""

TRAIN_WORLDS = """
import sys
from pathlib import Path

from tagalong.scripts.console.last_words import told


def train():
    from tagalong.agents.training.worlds.preset import WorldsPreset
    from tagalong.agents.training.worlds.run import WorldsRun, WorldsRunConfig

    preset = WorldsPreset(
        kinds=({"scene": "office"}, {"scene": "corridor", "people": 3}), worlds=5, episodes=8, env={"beams": 90},
        steps=3000, rollout=80, batch=100, epochs=1, width=8, most_steps=60,
    )
    WorldsRun(WorldsRunConfig(preset=preset, workers=2), Path(sys.argv[1]), print).train()
    return 0


if __name__ == "__main__":
    sys.exit(told(train))
"""


def prepare(folder: Path) -> None:
    """Write what the commands read: a drive, its bags, the room's map, frames, logs to derive from, a tiny training."""
    from tagalong.scripts import cli
    from tagalong.slam.logs import write_carmen

    folder.mkdir(parents=True, exist_ok=True)
    write_carmen(folder / "room.log.gz", room_drive(80))
    _write_bags(folder, room_drive(400))
    (folder / "train_follower.py").write_text(TRAIN)
    (folder / "train_worlds.py").write_text(TRAIN_WORLDS)
    _write_frames(folder / "frames")
    _write_originals(folder / "data" / "slam_logs")
    if cli.main(["slam", str(folder / "room.log.gz"), "--method", "ekf", "--out", str(folder / "map"), "--quiet"]):
        sys.exit("the room could not be mapped")


def _write_bags(folder: Path, drive) -> None:
    """Write a drive as a bag of ROS 1, as an MCAP file, and as a folder of ROS 2."""
    from rosbags.convert import convert
    from rosbags.typesys import Stores, get_typestore
    from tagalong.slam.logs import open_recording

    with open_recording(folder / "room.mcap") as recording:
        for pose, scan in zip(drive.odometry, drive.scans, strict=True):
            recording.scan(scan)
            recording.odometry(scan.time_s, pose)
    for name, kind, version in (("room", Stores.ROS2_HUMBLE, 9), ("room.bag", Stores.ROS1_NOETIC, 0)):
        store = get_typestore(kind)
        convert([folder / "room.mcap"], folder / name, "sqlite3", version, None, "file", None, store, (), (), (), ())


def _write_frames(folder: Path) -> None:
    """Write frames of a floor and a wall, as of a camera one metre above it."""
    folder.mkdir()
    rows, columns, focal = 120, 160, 130.0
    floor = 1.0 / np.maximum((np.arange(rows)[:, None] - 59.5) / focal, 1e-3)
    for k in range(12):
        depth = np.minimum(floor, 2.0 + 0.1 * k) * np.ones((rows, columns))
        Image.fromarray(np.round(1000.0 * depth).astype(np.uint16)).save(folder / f"{k:02d}_depth.png")
    camera = {"width": columns, "height": rows, "fx": focal, "fy": focal, "cx": 79.5, "cy": 59.5}
    (folder / "camera.json").write_text(json.dumps(camera))


def _write_originals(folder: Path) -> None:
    """Write logs as a program leaves them that corrected their poses: `tagalong data derive` makes odometry of them."""
    folder.mkdir(parents=True)
    lines = []
    for k in range(3000):
        pose = f"{0.01 * k:.3f} 0.0 0.0"
        scan = " ".join(["2.0"] * 90)
        lines += [f"ODOM {pose} 0.1 0 0 {k} h {k}", f"FLASER 90 {scan} {pose} {pose} {k} h {k}"]
    packed = gzip.compress("\n".join(lines).encode() + b"\n", 1, mtime=0)
    for name in ("aces", "belgioioso", "fhw"):
        (folder / f"{name}-corrected.log.gz").write_bytes(packed)


def room_drive(count: int):
    """Return a drive of `count` scans through a room of 6 by 5 metres."""
    from tagalong.slam import LaserScan, RecordedDrive

    bearings = np.linspace(-np.pi, np.pi, 180, endpoint=False)
    cosine, sine = np.abs(np.cos(bearings)), np.abs(np.sin(bearings))
    odometry, scans = [], []
    for i in range(count):
        x = 0.03 * i
        across = np.where(np.cos(bearings) > 0, 4.0 - x, 2.0 + x) / np.maximum(cosine, 1e-9)
        ranges = np.minimum(across, 2.5 / np.maximum(sine, 1e-9))
        odometry.append((x, 0.0, 0.0))
        scans.append(LaserScan(ranges, bearings, 0.1, 20.0, 0.1 * i))
    return RecordedDrive(np.array(odometry), scans, None, "room")
