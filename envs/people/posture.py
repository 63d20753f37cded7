"""Where the parts of a body are, by inverse kinematics of its legs; and where a shin cuts the laser's plane."""

import math

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_view_kernel, view_kernel
from .body import ANKLE, HIP_HALF_WIDTH, SHIN_LENGTH, SHIN_SHAPE

Array = NDArray[np.float64]
Point = tuple[float, float, float]


@view_kernel
def pose_bodies(
    position: Array,
    heading: Array,
    size: Array,
    feet: Array,
    lift: Array,
    laser_height: float,
    mocap_position: Array,
    mocap_quaternion: Array,
    legs: Array,
) -> None:
    """Place the six parts of every body by inverse kinematics of the legs, in place.

    Args:
        position: (n, 2) bodies [m].
        heading: (n,) [rad].
        size: (n, k) columns 0 and 1: length of thigh and shin [m].
        feet: (n, 2, 2) on the floor [m].
        lift: (n, 2) heights of the feet [m].
        laser_height: Height of the laser's plane [m].
        mocap_position: (6 n, 3) written.
        mocap_quaternion: (6 n, 4) written.
        legs: (n, 2, 2) written: where the axis of each shin meets the laser's plane [m].
    """
    for i in range(len(position)):
        cos, sin = math.cos(heading[i]), math.sin(heading[i])
        hips = hip_height(position[i], cos, sin, size[i, 0] + size[i, 1], feet[i], lift[i])
        base = 6 * i
        for part, height in ((0, hips), (1, hips + 0.75)):
            mocap_position[base + part, 0] = position[i, 0]
            mocap_position[base + part, 1] = position[i, 1]
            mocap_position[base + part, 2] = height
            mocap_quaternion[base + part, 0] = math.cos(heading[i] / 2.0)
            mocap_quaternion[base + part, 1] = 0.0
            mocap_quaternion[base + part, 2] = 0.0
            mocap_quaternion[base + part, 3] = math.sin(heading[i] / 2.0)
        for foot in range(2):
            hip, knee, ankle = joints(foot, position[i], cos, sin, hips, size[i], feet[i], lift[i])
            _place(base + 2 + 2 * foot, hip, knee, cos, sin, mocap_position, mocap_quaternion)
            _place(base + 3 + 2 * foot, knee, ankle, cos, sin, mocap_position, mocap_quaternion)
            share = (laser_height - ankle[2]) / (knee[2] - ankle[2])
            legs[i, foot, 0] = ankle[0] + share * (knee[0] - ankle[0])
            legs[i, foot, 1] = ankle[1] + share * (knee[1] - ankle[1])


@inner_view_kernel
def hip_height(position: Array, cos: float, sin: float, leg: float, feet: Array, lift: Array) -> float:
    """Return the largest height of the hips [m] at which legs of length `leg` reach both feet."""
    reach = 0.995 * leg
    height = ANKLE + 0.985 * leg
    for foot in range(2):
        side = HIP_HALF_WIDTH if foot == 0 else -HIP_HALF_WIDTH
        flat = math.hypot(feet[foot, 0] - position[0] + side * sin, feet[foot, 1] - position[1] - side * cos)
        height = min(height, ANKLE + lift[foot] + math.sqrt(max(0.04, reach * reach - flat * flat)))
    return height


@inner_view_kernel
def joints(
    foot: int, position: Array, cos: float, sin: float, hips: float, size: Array, feet: Array, lift: Array
) -> tuple[Point, Point, Point]:
    """Return hip, knee and ankle of a leg of one person; the knee is bent towards the heading."""
    side = HIP_HALF_WIDTH if foot == 0 else -HIP_HALF_WIDTH
    hip = (position[0] - side * sin, position[1] + side * cos, hips)
    ankle = (feet[foot, 0], feet[foot, 1], ANKLE + lift[foot])
    thigh, shin = size[0], size[1]
    x, y, z = hip[0] - ankle[0], hip[1] - ankle[1], hip[2] - ankle[2]
    length = math.sqrt(x**2 + y**2 + z**2)
    x, y, z = x / length, y / length, z / length
    length = min(length, 0.9999 * (thigh + shin))
    along = (shin * shin - thigh * thigh + length * length) / (2.0 * length)
    out = math.sqrt(max(0.0, shin * shin - along * along))
    ahead = cos * x + sin * y
    fx, fy, fz = cos - x * ahead, sin - y * ahead, -z * ahead
    norm = math.sqrt(fx**2 + fy**2 + fz**2)
    knee = (
        ankle[0] + along * x + out * (fx / norm),
        ankle[1] + along * y + out * (fy / norm),
        ankle[2] + along * z + out * (fz / norm),
    )
    return hip, knee, ankle


@inner_view_kernel
def _axes(upper: Point, lower: Point, cos: float, sin: float) -> tuple[Point, Point, Point]:
    """Return the axes of a limb between two joints in the frame of the heading: z along it, x as near to the heading
    as possible.
    """
    dx, dy, dz = upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    z0, z1, z2 = (cos * dx + sin * dy) / length, (cos * dy - sin * dx) / length, dz / length
    x0, x1, x2 = 1.0 - z0 * z0, -z0 * z1, -z0 * z2
    norm = math.sqrt(x0 * x0 + x1 * x1 + x2 * x2)
    x0, x1, x2 = x0 / norm, x1 / norm, x2 / norm
    y0, y1, y2 = z1 * x2 - z2 * x1, z2 * x0 - z0 * x2, z0 * x1 - z1 * x0
    return (x0, x1, x2), (y0, y1, y2), (z0, z1, z2)


@inner_view_kernel
def _place(part: int, upper: Point, lower: Point, cos: float, sin: float, positions: Array, quaternions: Array) -> None:
    """Write the pose of a limb between two joints.

    The rotation is taken in the frame of the heading, where it is a small tilt, and turned by the heading then.
    """
    x, y, z = _axes(upper, lower, cos, sin)
    w = math.sqrt(max(1e-9, 1.0 + x[0] + y[1] + z[2])) / 2.0
    qx, qy, qz = (y[2] - z[1]) / (4.0 * w), (z[0] - x[2]) / (4.0 * w), (x[1] - y[0]) / (4.0 * w)
    half = math.atan2(sin, cos) / 2.0
    c, s = math.cos(half), math.sin(half)
    positions[part, 0] = (upper[0] + lower[0]) / 2.0
    positions[part, 1] = (upper[1] + lower[1]) / 2.0
    positions[part, 2] = (upper[2] + lower[2]) / 2.0
    quaternions[part, 0] = c * w - s * qz
    quaternions[part, 1] = c * qx - s * qy
    quaternions[part, 2] = c * qy + s * qx
    quaternions[part, 3] = c * qz + s * w


@inner_view_kernel
def cut_shins(
    position: Array, heading: float, size: Array, feet: Array, lift: Array, height: float, ellipses: Array
) -> int:
    """Write where the shins of one person cut a horizontal plane, as `ellipses` (2, 6); return how many do.

    An ellipse is a row of its centre x and y [m], and xx, xy, yy of the form that is 1 on its rim [1/m^2], and the
    radius of a circle around it [m]. The other arguments as in `pose_bodies`, of one person.
    """
    cos, sin = math.cos(heading), math.sin(heading)
    hips = hip_height(position, cos, sin, size[0] + size[1], feet, lift)
    sx, sy, sz = SHIN_SHAPE[0] * size[2], SHIN_SHAPE[1] * size[2], SHIN_LENGTH * size[1]
    count = 0
    for foot in range(2):
        _, knee, ankle = joints(foot, position, cos, sin, hips, size, feet, lift)
        ex, ey, ez = _axes(knee, ankle, cos, sin)
        px, py, pz = 1.0 / (sx * sx), 1.0 / (sy * sy), 1.0 / (sz * sz)
        xx = (
            px * ex[0] * ex[0] + py * ey[0] * ey[0] + pz * ez[0] * ez[0]
        )  # the ellipsoid's form, in the heading's frame
        xy = px * ex[0] * ex[1] + py * ey[0] * ey[1] + pz * ez[0] * ez[1]
        yy = px * ex[1] * ex[1] + py * ey[1] * ey[1] + pz * ez[1] * ez[1]
        xz = px * ex[0] * ex[2] + py * ey[0] * ey[2] + pz * ez[0] * ez[2]
        yz = px * ex[1] * ex[2] + py * ey[1] * ey[2] + pz * ez[1] * ez[2]
        zz = px * ex[2] * ex[2] + py * ey[2] * ey[2] + pz * ez[2] * ez[2]
        above, det = height - (knee[2] + ankle[2]) / 2.0, xx * yy - xy * xy
        u, v = -above * (yy * xz - xy * yz) / det, -above * (xx * yz - xy * xz) / det
        level = 1.0 - zz * above * above - above * (xz * u + yz * v)
        if level <= 0.0:
            continue
        row = ellipses[count]
        row[0] = (knee[0] + ankle[0]) / 2.0 + cos * u - sin * v
        row[1] = (knee[1] + ankle[1]) / 2.0 + sin * u + cos * v
        row[2] = (cos * cos * xx - 2.0 * cos * sin * xy + sin * sin * yy) / level
        row[3] = (cos * sin * (xx - yy) + (cos * cos - sin * sin) * xy) / level
        row[4] = (sin * sin * xx + 2.0 * cos * sin * xy + cos * cos * yy) / level
        half = (row[2] + row[4]) / 2.0
        row[5] = 1.0 / math.sqrt(half - math.sqrt(max(half * half - row[2] * row[4] + row[3] * row[3], 0.0)))
        count += 1
    return count
