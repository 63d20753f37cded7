"""Frames of the simulated camera with people placed at random: to train on, and to test on."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from ...envs.appearance.looks import dress
from ...envs.appearance.wardrobe import draw_outfit, wardrobe
from ...envs.people.body import PARTS, Physique, draw_physique
from ...envs.people.posture import pose_bodies
from ...envs.physics.mj import MjData, mujoco
from ...envs.robot.robot import RobotConfig
from ...envs.scenes.catalogue import make_scene
from ...envs.scenes.scene import Scene
from ...envs.sensors.camera.config import RgbdConfig
from ...envs.sensors.camera.rgbd import RgbdCamera
from ...envs.sensors.lidar import LidarConfig
from ...envs.world.building import build
from ...perception.rgbd.frame import RgbdFrame
from ...slam.geometry import inverse, transform_points
from .rgbd_props import REACH_M, before, draw_props
from .rgbd_seats import draw_chairs, seat_person
from .rgbd_truth import WholeBodies, people_of

Array = NDArray[np.float64]

HEADROOM = 2.5
"""Height of the ceiling where the scene has none [m]."""
_PEOPLE = 5


@dataclass(frozen=True, eq=False)
class LabelledFrame:
    """A frame and what is really in it.

    Attributes:
        frame: The frame.
        person: (h, w) int32 person that each pixel really met, -1 for nobody.
        places: (n, 2) people, robot frame [m].
        whole: (n,) pixels that each person would have in the picture with nothing before them.
        seated: (n,) who sits.
    """

    frame: RgbdFrame
    person: NDArray[np.int32]
    places: Array
    whole: NDArray[np.int64]
    seated: NDArray[np.bool_]


def draw_frames(
    rng: Generator,
    scenes: Sequence[str],
    clothing: str,
    props: str,
    count: int,
    camera: RgbdConfig | None = None,
    seated: float = 0.0,
    reach: float = REACH_M,
) -> list[LabelledFrame]:
    """Draw one building of `scenes` with people in it, and return `count` frames from places along its route.

    Args:
        rng: Source of all draws.
        scenes: Names of buildings to choose from.
        clothing: Name of the wardrobe.
        props: Name of the kinds of things that stand about, see `rgbd_props.py`.
        count: How many frames.
        camera: The camera; its wardrobe is not looked at.
        seated: Share of the frames with somebody on a chair.
        reach: People and things stand no farther off than this [m].
    """
    scene = make_scene(scenes[int(rng.integers(len(scenes)))], rng)
    if scene.ceiling is None and rng.random() < 0.7:
        scene = replace(scene, ceiling=HEADROOM)
    spots = _spots(rng, scene, count)
    scene = replace(scene, solids=(*scene.solids, *draw_props(rng, scene, spots, props, reach)))
    chairs, seats = draw_chairs(rng, scene, spots, seated, reach) if seated else ([], {})
    scene = replace(scene, solids=(*scene.solids, *chairs))
    physiques = tuple(draw_physique(rng) for _ in range(_PEOPLE))
    outfits = tuple(draw_outfit(rng, wardrobe(clothing)) for _ in range(_PEOPLE))
    lidar = LidarConfig()
    model = build(scene, physiques, RobotConfig(), lidar, 0.0125, outfits).model
    looks = dress(model, rng, outfits)
    taker, data = RgbdCamera(camera or RgbdConfig(), model, looks), mujoco.MjData(model)
    whole, frames = WholeBodies(taker.config, model, _PEOPLE), []
    for number, spot in enumerate(spots):
        people = _place_people(rng, scene, spot, reach)
        _pose(rng, data, people, physiques, lidar.height)
        sits = np.zeros(_PEOPLE, dtype=bool)
        if number in seats:
            sits[-1], people[-1] = True, seats[number][:2]
            seat_person(data, _PEOPLE - 1, seats[number], physiques[-1])
        mujoco.mj_kinematics(model, data)
        mujoco.mj_camlight(model, data)
        frame, geoms = taker.take(data, spot, rng, 0.0)
        places = transform_points(inverse(spot), people)
        frames.append(LabelledFrame(frame, people_of(model, geoms), places, whole.count(data, spot), sits))
    return frames


def _spots(rng: Generator, scene: Scene, count: int) -> Array:
    """Return (count, 3) poses of the robot near the route, looking along it or aside."""
    spots = np.empty((count, 3))
    for k in range(count):
        at = 0
        for _ in range(50):
            at = int(rng.integers(len(scene.route) - 1))
            x, y = scene.route[at] + rng.uniform(-0.5, 0.5, 2)
            if scene.clearance(np.array([x, y])) > 0.35:
                break
        else:
            x, y = scene.route[at]
        ahead = scene.route[at + 1] - scene.route[at]
        turn = rng.choice([0.0, np.pi]) + rng.normal(0.0, 0.6)
        spots[k] = x, y, np.arctan2(ahead[1], ahead[0]) + turn
    return spots


def _place_people(rng: Generator, scene: Scene, spot: Array, reach: float) -> Array:
    """Return (n, 2) places of people [m], most of them before the robot at `spot` (3,), some side by side."""
    places = np.zeros((_PEOPLE, 2))
    places[:, 0] = 1000.0 + 3.0 * np.arange(_PEOPLE)
    for k in range(int(rng.integers(0, _PEOPLE + 1))):
        place = before(rng, scene, spot, 0.22, reach)
        if k and rng.random() < 0.35:
            turn = rng.uniform(-np.pi, np.pi)
            place = places[k - 1] + float(rng.uniform(0.5, 0.75)) * np.array([np.cos(turn), np.sin(turn)])
        if place is None or scene.clearance(place, of_people=True) < 0.2:
            continue
        apart = np.hypot(*(places - place).T).min()
        if apart > 0.45 and np.hypot(*(place - spot[:2])) > 0.6:
            places[k] = place
    return places


def _pose(rng: Generator, data: MjData, places: Array, physiques: tuple[Physique, ...], laser_height: float) -> None:
    """Let everybody stand, or be somewhere in a step, looking anywhere."""
    count = len(places)
    heading = rng.uniform(-np.pi, np.pi, count)
    ahead = np.stack((np.cos(heading), np.sin(heading)), axis=-1)
    left = np.stack((-ahead[:, 1], ahead[:, 0]), axis=-1)
    stance = np.array([p.stance_half_width for p in physiques])[:, None]
    step = np.where(rng.random(count) < 0.5, 0.0, rng.uniform(-0.35, 0.35, count))[:, None]
    feet = np.stack((places + stance * left + step * ahead, places - stance * left - step * ahead), axis=1)
    lift = np.zeros((count, 2))
    lift[np.arange(count), rng.integers(0, 2, count)] = np.where(step[:, 0] == 0.0, 0.0, rng.uniform(0.0, 0.08, count))
    size = np.array([(p.thigh, p.shin, p.leg_radius, p.stance_half_width, p.walk_ratio) for p in physiques])
    parts = count * len(PARTS)
    legs = np.empty((count, 2, 2))
    pose_bodies(places, heading, size, feet, lift, laser_height, data.mocap_pos[:parts], data.mocap_quat[:parts], legs)
