"""An episode's building, people and start, drawn from one source; whatever simulates it afterwards."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..people.casting import MOST_ON_ROUTE, cast_people
from ..people.draft import CastRequest
from ..people.movement.terrain import Terrain
from ..people.wanderers import MOST_DRAWN
from ..robot.odometry import WheelOdometry, odometry_quality
from ..scenes.catalogue import make_scene
from ..scenes.recorded_walks import with_recorded_walks
from ..scenes.request import NoRoomError
from ..scenes.scene import Scene
from .config import WorldConfig
from .state import Plan

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class EpisodeDrawing:
    """What was drawn for an episode.

    Attributes:
        plan: Building, people and start.
        terrain: The building as walkers see it.
        streams: Sources of later draws, by what they are for.
        start_arc: Way of the robot along the route at the start [m].
        odometry: What the wheels believe, with the systematic errors of this episode.
    """

    plan: Plan
    terrain: Terrain
    streams: dict[str, np.random.Generator]
    start_arc: float
    odometry: WheelOdometry


MOST_DRAWS = 20
"""Of one episode: not every building has room for as many people as are asked for."""


def draw_episode(config: WorldConfig, rng: np.random.Generator, draws: int = MOST_DRAWS) -> EpisodeDrawing:
    """Draw an episode; where the building has no room for the people, draw again, from what `rng` gives next.

    All draws come from streams that are spawned from `rng` once, one each for the building, the leader, the other
    people, the odometry and the sensors: the same seed gives the same building and start whoever walks in it.

    Args:
        config: What to simulate.
        rng: Source of all draws; used only here.
        draws: How many, at most.

    Raises:
        NoRoomError: If none of the buildings has room.
    """
    for _ in range(draws - 1):
        try:
            return _drawn(config, _spawned(rng))
        except NoRoomError:
            continue
    return _drawn(config, _spawned(rng))


def _drawn(config: WorldConfig, streams: dict[str, np.random.Generator]) -> EpisodeDrawing:
    scene = make_scene(config.scene, streams["scene"], request=config.request())
    if config.walking_paths is not None:
        scene = with_recorded_walks(scene, config.walking_paths, streams["scene"])
    return _in_building(config, scene, None, streams)


def draw_again(drawing: EpisodeDrawing, rng: np.random.Generator) -> EpisodeDrawing:
    """Draw another episode in the building of `drawing`, on the same tour: other people, another start.

    Args:
        drawing: What was drawn there before.
        rng: Source of all draws; used only here.
    """
    return _in_building(drawing.plan.config, drawing.plan.scene, drawing.terrain, _spawned(rng))


def _in_building(
    config: WorldConfig, scene: Scene, terrain: Terrain | None, streams: dict[str, np.random.Generator]
) -> EpisodeDrawing:
    """Draw people and start in a building; its terrain is made if it is not known yet."""
    start, start_arc = _draw_start(scene, streams["scene"])
    terrain = terrain or Terrain(scene)
    count = _how_many(config, scene, streams["people"])
    casting = cast_people(
        CastRequest(
            scene=scene,
            terrain=terrain,
            people=count,
            standing=config.standing,
            style=config.leader_style,
            with_leader=config.leader and count > 0,
            start_arc=start_arc,
            leader_rng=streams["leader"],
            rng=streams["people"],
            heedless=config.heedless,
            heedless_rng=streams["heedless"],
            behaviours=config.behaviours,
            own_rng=streams["behaviours"],
        )
    )
    plan = Plan(config, scene, start, casting, int(streams["looks"].integers(2**63)))
    quality = odometry_quality(config.odometry) if isinstance(config.odometry, str) else config.odometry
    kept = {name: streams[name] for name in ("odometry", "lidar", "camera", "behaviours")}
    return EpisodeDrawing(plan, terrain, kept, start_arc, WheelOdometry(quality, kept["odometry"], start))


def _spawned(rng: np.random.Generator) -> dict[str, np.random.Generator]:
    """Return a source of draws for each subject, so that none depends on how much is drawn for another."""
    names = ("scene", "leader", "people", "odometry", "lidar", "camera", "looks", "behaviours", "heedless")
    children = np.random.SeedSequence([int(word) for word in rng.integers(0, 2**63, 4)]).spawn(len(names))
    return {name: np.random.default_rng(child) for name, child in zip(names, children, strict=True)}


def _how_many(config: WorldConfig, scene: Scene, rng: np.random.Generator) -> int:
    if config.people is not None:
        return config.people
    bystanders = int(rng.integers(0, 1 + (MOST_DRAWN if scene.walks else MOST_ON_ROUTE)))
    return bystanders + int(config.leader)


def _draw_start(scene: Scene, rng: np.random.Generator) -> tuple[Array, float]:
    """Return the robot's start pose (3,) near the beginning of the route, and its way along it [m]."""
    arc, lateral, turn = rng.uniform(0.0, 0.5), rng.uniform(-0.1, 0.1), rng.uniform(-0.12, 0.12)
    ahead = scene.route[1] - scene.route[0]
    ahead = ahead / np.hypot(*ahead)
    x, y = scene.route[0] + arc * ahead + lateral * np.array([-ahead[1], ahead[0]])
    return np.array([x, y, np.arctan2(ahead[1], ahead[0]) + turn]), float(arc)
