"""Planes of the simulated camera's frames against the true surfaces."""

import numpy as np
from tagalong.envs.recording.operator import Operator
from tagalong.envs.sensors.camera.config import RgbdConfig
from tagalong.envs.sensors.lidar import LidarConfig
from tagalong.envs.world.world import World, WorldConfig
from tagalong.perception import PlaneFinder
from tagalong.perception.rgbd import Surface

SURFACES = {"floor": Surface.FLOOR, "ceiling": Surface.CEILING, "wall": Surface.WALL, "table": Surface.TOP}


def shares_right(seed, vibration):
    """Share of the points of each surface that are labelled right, over frames of the first lap, 3 s apart."""
    camera = RgbdConfig(rate_hz=1.0, vibration=vibration)
    options = {"people": 0, "leader": False, "lidar": LidarConfig(beams=31), "camera": camera}
    world = World(WorldConfig(scene="lab", route="operator", **options), np.random.default_rng(seed))
    kinds = np.array(["floor", "ceiling", *(solid.kind for solid in world.scene.solids)] + ["mover"] * 100)
    operator, finder = Operator(world.scene), PlaneFinder()
    right, total = dict.fromkeys(SURFACES, 0), dict.fromkeys(SURFACES, 0)
    for step in range(1200):
        world.step(operator.command(world.truth))
        if step % 30:
            continue
        frame, geoms = world.frames[-1], world.frame_geoms()
        planes = finder.find(frame)
        measured = np.isfinite(frame.depth) & (geoms >= 0)
        for name, surface in SURFACES.items():
            mine = measured & (kinds[geoms] == name)
            if name == "table":
                mine &= np.nan_to_num(planes.points[..., 2]) > 0.66
            right[name] += int((planes.surface[mine] == surface).sum())
            total[name] += int(mine.sum())
    return {name: right[name] / total[name] for name in SURFACES}


def test_floor_ceiling_walls_and_table_tops_are_found_in_the_lab_and_under_vibration():
    for seed, vibration in ((0, 0.0), (1, np.radians(1.5))):
        shares = shares_right(seed, vibration)
        assert min(shares[name] for name in ("floor", "ceiling", "wall")) > 0.95, shares
        assert shares["table"] > 0.8, shares
