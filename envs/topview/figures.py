"""The robot, the people and what the robot perceives, drawn on the building."""

import numpy as np
from numpy.typing import NDArray

from ...slam.geometry import transform_points
from . import palette
from .canvas import Canvas, Colour
from .snapshot import DrawnTracks, Snapshot

Array = NDArray[np.float64]

_ELLIPSE = np.stack((np.cos(np.linspace(0, 2 * np.pi, 25)), np.sin(np.linspace(0, 2 * np.pi, 25))), axis=1)


def draw_scan(canvas: Canvas, shot: Snapshot) -> None:
    """Shade what the scan sees; dot its returns, those of people in another colour."""
    if len(shot.scan_points) > 1:
        canvas.polygon(np.vstack((shot.robot_pose[:2], shot.scan_points)), palette.SEEN)
    canvas.dots(shot.scan_points[~shot.scan_dropped], palette.RETURN, 3)
    canvas.dots(shot.scan_points[shot.scan_dropped], palette.DROPPED, 4)


def draw_path(canvas: Canvas, path: Array) -> None:
    """Draw where the robot went."""
    if len(path) > 1:
        canvas.line(path, palette.PATH, 0.04)


def draw_people(canvas: Canvas, shot: Snapshot) -> None:
    """Draw each person's feet, shoulders and head; the leader in the leader's colour."""
    for index, (position, heading) in enumerate(zip(shot.person_positions, shot.person_headings, strict=True)):
        colour: Colour = palette.LEADER
        if index != shot.leader_index:
            colour = palette.BYSTANDERS[index % len(palette.BYSTANDERS)]
        for foot in shot.person_feet[index]:
            pose = (foot[0], foot[1], heading)
            canvas.polygon(transform_points(pose, _ELLIPSE * (0.14, 0.055) + (0.03, 0.0)), palette.SHOES)
        pose = (position[0], position[1], heading)
        edge: Colour = (colour[0] * 6 // 10, colour[1] * 6 // 10, colour[2] * 6 // 10)
        canvas.polygon(transform_points(pose, _ELLIPSE * (0.13, 0.23)), colour, edge)
        canvas.circle(position, 0.1, palette.SKIN, edge, 0.015)
        nose = transform_points(pose, np.array([[0.1, 0.0]]))[0]
        canvas.circle(nose, 0.03, palette.SKIN, edge, 0.01)


def draw_robot(canvas: Canvas, pose: Array, size: tuple[float, float]) -> None:
    """Draw the robot as a box with wheels, an arrow forwards and the laser."""
    half = np.array(size) / 2.0
    corner = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)], dtype=np.float64)
    for x in (-0.6, 0.6):
        for y in (-1.0, 1.0):
            wheel = corner * (0.1, 0.035) + (x * half[0], y * (half[1] - 0.02))
            canvas.polygon(transform_points(pose, wheel), palette.WHEEL)
    body = corner * (half - (0.0, 0.05))
    canvas.polygon(transform_points(pose, body), palette.ROBOT, palette.WHEEL)
    for side in (-1.0, 1.0):
        stripe = corner * (half[0] * 0.92, 0.018) + (0.0, side * (half[1] - 0.085))
        canvas.polygon(transform_points(pose, stripe), palette.ROBOT_TRIM)
    arrow = np.array([(0.9, 0.0), (0.45, 0.5), (0.45, -0.5)]) * (half[0], half[1] - 0.1)
    canvas.polygon(transform_points(pose, arrow), palette.ROBOT_TRIM)
    canvas.circle(pose[:2], 0.07, (90, 94, 104), palette.WHEEL, 0.015)


def draw_tracks(canvas: Canvas, tracks: DrawnTracks, robot: Array) -> None:
    """Ring each perceived person with its identity and velocity; join the robot to its leader."""
    for position, velocity, name in zip(tracks.positions, tracks.velocities, tracks.ids, strict=True):
        leads = int(name) == tracks.leader_id
        colour = palette.TRACK_LEADER if leads else palette.TRACK
        canvas.circle(position, 0.38, None, colour, 0.045 if leads else 0.025)
        if np.hypot(*velocity) > 0.15:
            _arrow(canvas, position, velocity, colour)
        _tag(canvas, position + np.array([0.42, 0.42]), f"{int(name)}", colour)
    if tracks.leader is None:
        return
    line = [robot[:2], tracks.leader]
    canvas.line(line, (*palette.TRACK_LEADER, 130), 0.025)
    if not tracks.leader_visible:
        for start in range(0, 360, 40):
            canvas.arc(tracks.leader, 0.38, start, start + 20, palette.TRACK_LEADER, 0.045)


def _arrow(canvas: Canvas, position: Array, velocity: Array, colour: Colour) -> None:
    unit = velocity / np.hypot(*velocity)
    start, tip = position + unit * 0.38, position + unit * 0.38 + velocity * 0.5
    canvas.line([start, tip], colour, 0.035)
    side = np.array([-unit[1], unit[0]]) * 0.07
    canvas.polygon([tip + unit * 0.13, tip + side, tip - side], colour)


def _tag(canvas: Canvas, position: Array, text: str, colour: Colour) -> None:
    canvas.circle(position, 0.17, (255, 255, 255, 235), colour, 0.025)
    canvas.label(position, text, colour, max(10, round(0.2 * canvas.camera.scale)))
