"""A depth camera of your own: planes and people in its frames; tilt and height are told by the floor."""

import numpy as np
from tagalong.envs import RgbdConfig, World, WorldConfig
from tagalong.perception import PeopleFinder, Pinhole, PlaneFinder, RgbdFrame

# In place of a camera's driver: depth in millimetres, colour, and the intrinsics that its calibration tells.
simulated = RgbdConfig(pitch=np.radians(20.0), camera_height=1.3)
world = World(
    WorldConfig(scene="lab", route="operator", leader=False, people=2, camera=simulated), np.random.default_rng(3)
)
taken = world.frames[-1]
millimetres = np.nan_to_num(1000.0 * taken.depth).astype(np.uint16)
(fx, fy), (column, row) = simulated.pinhole.focal, simulated.pinhole.axis

camera = Pinhole.from_intrinsics((simulated.width, simulated.height), (fx, fy), (column - 0.5, row - 0.5))
frame = RgbdFrame(millimetres, taken.colour, camera, camera_height=None)  # None: the floor is to tell it
planes = PlaneFinder().find(frame)
people = PeopleFinder.load().find(planes.frame, planes)

mount = planes.mount
print(f"floor seen: {mount.floor_seen}; camera {mount.height:.2f} m high, {np.degrees(mount.pitch):.1f} degrees down")
print(f"{len(planes.kinds)} planes; {np.isfinite(planes.points[..., 0]).mean():.0%} of the pixels were measured")
for (x, y), likelihood in zip(people.positions, people.likelihood, strict=True):
    print(f"somebody at ({x:.1f}, {y:.1f}) m, likelihood {likelihood:.2f}; floor known: {people.floor_known}")
