"""What is installed and what works on this machine."""

import os
import subprocess
import sys
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np

from ...envs.topview.rendering import has_display
from ...envs.world.world import World, WorldConfig
from ...slam.engine import make_slam
from ...slam.geometry import between

CORE = ("gymnasium", "mujoco", "numpy", "scipy", "scikit-learn", "filterpy", "threadpoolctl", "numba", "pillow", "tqdm")
"""Distributions that the package cannot do without."""

EXTRAS: Mapping[str, tuple[str, ...]] = {
    "learn": ("torch", "stable-baselines3", "sb3-contrib", "tensorboard", "safetensors", "onnx", "onnxruntime"),
    "cuda": ("numba-cuda", "numpy"),
    "viz": ("matplotlib", "moviepy"),
    "ros": ("rosbags", "mcap"),
    "rerun": ("rerun-sdk",),
    "datasets": ("minari", "pyarrow"),
    "cluster": ("ray", "distributed"),
    "docs": ("mkdocs", "mkdocs-material", "latex2mathml"),
    "dev": (
        *("build", "basedpyright", "evo", "hypothesis", "mcap", "minari", "pyarrow", "pysocialforce", "pytest"),
        *("pytest-xdist", "rosbags", "ruff", "scikit-image"),
    ),
}
"""Distributions that each extra brings."""

OPENGL_BACKENDS = ("egl", "osmesa", "glfw")

OPENGL_REMEDIES: Mapping[str, str] = {
    "egl": "install a driver or Mesa (Debian: apt install libegl1 libgl1-mesa-dri)",
    "osmesa": "install OSMesa (Debian: apt install libosmesa6)",
    "glfw": "needs a display, or a virtual one (xvfb-run)",
}
"""What to do about a back end that does not work."""

_DRAW = """
import os, threading, time
def end_with_parent(parent=os.getppid()):
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)
threading.Thread(target=end_with_parent, daemon=True).start()
import mujoco
model = mujoco.MjModel.from_xml_string('<mujoco><worldbody><light pos="0 0 3"/><geom size="1"/></worldbody></mujoco>')
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
renderer = mujoco.Renderer(model, 32, 32)
renderer.update_scene(data)
assert renderer.render().any(), "the picture is black"
"""
_STEPS = 25
_COMMAND = (0.4, 0.3)  # a slow bend [m/s, rad/s]


@dataclass(frozen=True)
class Check:
    """How a trial went.

    Attributes:
        name: What was tried.
        works: Whether it works.
        note: One line: why not, or how well.
    """

    name: str
    works: bool
    note: str = ""


def installed_version(distribution: str) -> str | None:
    """Return the version of a distribution, None if it is not installed."""
    try:
        return version(distribution)
    except PackageNotFoundError:
        return None


def check_extras() -> list[Check]:
    """Return for each extra whether all that it brings is installed, and what is missing."""
    missing = {name: [d for d in parts if installed_version(d) is None] for name, parts in EXTRAS.items()}
    return [Check(name, not parts, ", ".join(parts)) for name, parts in missing.items()]


def check_surroundings() -> list[Check]:
    """Return what else commands look for; the notes say what to do where it is not there."""
    cache = Path(os.environ.get("NUMBA_CACHE_DIR") or Path(__file__).parent)
    data = os.environ.get("TAGALONG_DATA")
    held = data is not None and (Path(data) / "slam_logs").is_dir()
    wanted = (
        "set TAGALONG_DATA to a folder with recordings; `tagalong data` lists them"
        if data is None
        else (f"`tagalong data check` says what {data} lacks")
    )
    kept = os.access(cache, os.W_OK)
    return [
        Check(
            "compiled kernels are kept", kept, "" if kept else "set NUMBA_CACHE_DIR to a folder that you can write to"
        ),
        Check("recorded logs", held, "" if held else wanted),
        Check("display", has_display(), "" if has_display() else "none is needed but for viewers and --viewer"),
    ]


def check_opengl(backends: Iterable[str] = OPENGL_BACKENDS, limit_s: float = 30.0) -> list[Check]:
    """Return which of MuJoCo's OpenGL back ends can draw a picture here.

    Each is tried in a process of its own, all at once, as a broken driver may hang or crash.
    """
    began = time.monotonic()
    trials = {
        name: subprocess.Popen(  # noqa: S603 (this Python, a program written above, names from a table)
            [sys.executable, "-c", _DRAW],
            env={**os.environ, "MUJOCO_GL": name},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        for name in backends
    }
    try:
        return [_outcome(name, trial, began + limit_s) for name, trial in trials.items()]
    finally:
        for trial in trials.values():  # those that an interrupted doctor still waits for
            trial.kill()


def _outcome(name: str, trial: "subprocess.Popen[str]", deadline: float) -> Check:
    try:
        _, errors = trial.communicate(timeout=max(deadline - time.monotonic(), 0.1))
    except subprocess.TimeoutExpired:
        trial.kill()
        trial.communicate()
        return Check(name, False, "did not answer in time")
    if trial.returncode == 0:
        return Check(name, True)
    lines = [line for line in errors.splitlines() if line and not line[0].isspace()]
    return Check(name, False, lines[-1][:90] if lines else f"ended with status {trial.returncode}")


def check_drive() -> Check:
    """Drive a simulated robot through a room for a moment, map it with GMapping, and compare with the truth."""
    began = time.perf_counter()
    world = World(WorldConfig(scene="meeting_room", people=1), np.random.default_rng(0))
    engine = make_slam("gmapping", particles=5, linear_update=0.1, angular_update=0.1, seed=0)
    start, T_map_start = world.truth.robot_pose, world.odometry
    engine.update(T_map_start, world.scan())
    for _ in range(_STEPS):
        world.step(_COMMAND)
        engine.update(world.odometry, world.scan())
    truth, estimate = between(start, world.truth.robot_pose), between(T_map_start, engine.pose)
    moved, off = float(np.hypot(truth[0], truth[1])), float(np.hypot(*(estimate - truth)[:2]))
    took = time.perf_counter() - began
    cells = int(engine.map().occupied.sum())
    works = moved > 0.3 and off < 0.1 and cells > 100
    note = f"{took:.1f} s; drove {moved:.2f} m, pose off by {100 * off:.1f} cm, {cells} occupied cells"
    return Check("simulate and map", works, note)
