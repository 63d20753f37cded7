"""How an environment shows itself: a top view, MuJoCo's camera, MuJoCo's viewer, or not at all."""

import os
import sys
from importlib.util import find_spec
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError, unknown_name
from ...slam.geometry import compose, inverse, transform_points
from ..onboard.stack import Belief
from ..physics.mj import mujoco
from ..sensors.camera.opengl import open_renderer
from ..viewing.live import LiveRenderer, require_viewer
from ..world.truth import TrueState
from ..world.world import World
from . import DrawnTracks, Snapshot, TopView

Picture = NDArray[np.uint8]
MODES = ("rgb_array", "human", "rerun")
SHOWN_AT_ONCE = ("human", "rerun")
"""Modes that show every step by themselves."""
BACKENDS = ("topview", "mujoco")


class Renderer(Protocol):
    """Shows one moment."""

    def draw(self, world: World, truth: TrueState, belief: Belief, trail: NDArray[np.float64]) -> Picture | None:
        """Return the picture, or None where it is shown elsewhere."""
        ...

    def close(self) -> None:
        """Free what was opened."""
        ...


def possible_modes() -> list[str]:
    """Return the render modes that work here: windows need a display, and rerun its extra."""
    able = {"human": has_display(), "rerun": has_display() and find_spec("rerun") is not None}
    return [mode for mode in MODES if able.get(mode, True)]


def has_display() -> bool:
    """Return whether a window can be opened."""
    if not sys.platform.startswith("linux"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def make_renderer(mode: str | None, backend: str) -> Renderer:
    """Return what draws for a render mode.

    Raises:
        InputError: If the mode or the back end is unknown, or "human" or "rerun" has no display to show itself on.
        MissingExtraError: If it is "rerun", and that is not installed.
    """
    if not isinstance(mode, str | None):
        raise unknown_name("render mode", mode, MODES)
    if not isinstance(backend, str) or backend not in BACKENDS:
        raise unknown_name("render back end", backend, BACKENDS)
    if mode is None:
        return NoRenderer()
    if mode == "human":
        if not has_display():
            raise InputError('render_mode="human" needs a display, there is none; render_mode="rgb_array" does not')
        return ViewerRenderer()
    if mode == "rerun":
        require_viewer(display=has_display())
        return LiveRenderer()
    if mode != "rgb_array":
        raise unknown_name("render mode", mode, MODES)
    return TopViewRenderer() if backend == "topview" else CameraRenderer()


class NoRenderer:
    """Shows nothing."""

    def draw(self, world: World, truth: TrueState, belief: Belief, trail: NDArray[np.float64]) -> None:
        """Return None."""

    def close(self) -> None:
        """Do nothing."""


class TopViewRenderer:
    """Draws from above with numpy and Pillow."""

    def __init__(self) -> None:
        self._of: World | None = None
        self._view: TopView | None = None

    def draw(self, world: World, truth: TrueState, belief: Belief, trail: NDArray[np.float64]) -> Picture:
        """Return the picture (540, 960, 3)."""
        if self._view is None or self._of is not world:
            self._of, self._view = world, TopView(world.scene)
        return self._view.draw(snapshot(world, truth, belief, trail))

    def close(self) -> None:
        """Forget the building."""
        self._of = self._view = None

    def __getstate__(self) -> dict[str, Any]:
        return {"_of": None, "_view": None}


class CameraRenderer:
    """Looks over the robot's shoulder with MuJoCo's camera; needs OpenGL (EGL, OSMesa or a display)."""

    def __init__(self) -> None:
        self._of: World | None = None
        self._renderer: Any = None

    def draw(self, world: World, truth: TrueState, belief: Belief, trail: NDArray[np.float64]) -> Picture:
        """Return the picture (480, 640, 3).

        Raises:
            InputError: If there is no OpenGL.
        """
        if self._of is not world:
            self.close()
            self._of, self._renderer = world, _open_renderer(world)
        camera = mujoco.MjvCamera()
        camera.lookat[:] = [*truth.robot_pose[:2], 0.6]
        camera.distance, camera.elevation, camera.azimuth = 4.5, -32.0, np.degrees(truth.robot_pose[2])
        self._renderer.update_scene(world.data, camera)
        return self._renderer.render().copy()

    def close(self) -> None:
        """Free the OpenGL context."""
        if self._renderer is not None:
            self._renderer.close()
        self._of = self._renderer = None

    def __getstate__(self) -> dict[str, Any]:
        return {"_of": None, "_renderer": None}


class ViewerRenderer:
    """MuJoCo's own viewer in a window."""

    def __init__(self) -> None:
        self._of: World | None = None
        self._viewer: Any = None

    def draw(self, world: World, truth: TrueState, belief: Belief, trail: NDArray[np.float64]) -> None:
        """Show the present state."""
        if self._of is not world:
            self.close()
            self._of, self._viewer = world, _open_viewer(world)
        self._viewer.sync()

    def close(self) -> None:
        """Close the window."""
        if self._viewer is not None:
            self._viewer.close()
        self._of = self._viewer = None

    def __getstate__(self) -> dict[str, Any]:
        return {"_of": None, "_viewer": None}


def snapshot(world: World, truth: TrueState, belief: Belief, trail: NDArray[np.float64]) -> Snapshot:
    """Return what the top view draws; what the robot believes is carried into the world by its true pose."""
    scan, T_world_robot = belief.scan, truth.robot_pose
    T_world_odom = compose(T_world_robot, inverse(belief.odometry))
    turn = np.array([0.0, 0.0, T_world_odom[2]])
    leader = belief.leader
    tracks = DrawnTracks(
        positions=transform_points(T_world_odom, belief.people.positions),
        velocities=transform_points(turn, belief.people.velocities),
        ids=belief.people.ids,
        leader_id=belief.leader_id,
        leader=None if leader is None else transform_points(T_world_robot, leader.position[None])[0],
        leader_visible=belief.sees_leader,
    )
    mapped = not np.isnan(belief.map_pose).any()
    return Snapshot(
        time_s=truth.time_s,
        robot_pose=T_world_robot,
        robot_size=world.config.robot.size[:2],
        person_positions=truth.people.positions,
        person_headings=truth.people.headings,
        person_feet=truth.people.feet,
        leader_index=truth.leader_index,
        scan_points=transform_points(compose(T_world_robot, scan.T_robot_lidar), scan.points),
        scan_dropped=(scan.is_return & ~belief.filtered.is_return)[scan.is_return],
        tracks=tracks,
        map=belief.map if mapped else None,
        T_world_map=world.start,
        path=trail,
        captions=_captions(truth, belief),
    )


def _captions(truth: TrueState, belief: Belief) -> tuple[tuple[str, str], ...]:
    always = (("speed", f"{truth.robot_velocity[0]:.2f} m/s"), ("people tracked", f"{len(belief.people)}"))
    if truth.leader_index < 0:
        return (("leader", "nobody"), *always)
    gap = float(np.hypot(*(truth.people.positions[truth.leader_index] - truth.robot_pose[:2])))
    leader = "not chosen yet"
    if belief.leader is not None:
        leader = f"track {belief.leader_id}, seen" if belief.sees_leader else "lost, predicted"
    return (("distance to leader", f"{gap:.2f} m"), ("leader", leader), *always)


def _open_renderer(world: World) -> Any:
    if not has_display():
        os.environ.setdefault("MUJOCO_GL", "egl")
    return open_renderer(world.model, 480, 640, instead='render_backend="topview"')


def _open_viewer(world: World) -> Any:
    from mujoco import viewer  # imported late: it opens the window system

    return viewer.launch_passive(world.model, world.data, show_left_ui=False, show_right_ui=False)
