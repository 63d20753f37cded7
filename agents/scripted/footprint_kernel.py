"""How near a robot's box comes to things on its way, compiled: a planner asks it of some 100,000 pairs a step."""

import math

import numpy as np

from ...slam.view_kernel import kernel


@kernel
def box_gaps(poses, obstacles, half_length, half_width, far):
    """Return (c, t) the distance from the robot's edge at each of the poses (c, t, 3) to the nearest obstacle (n, 2).

    Lengths are in metres, in one frame; the box is 2 `half_length` long and 2 `half_width` wide. The distance is `far`
    at most; that of an obstacle inside the box is negative.
    """
    gaps = np.empty(poses.shape[:2])
    reach = math.hypot(half_length, half_width) + far
    for c in range(poses.shape[0]):
        for t in range(poses.shape[1]):
            x, y = poses[c, t, 0], poses[c, t, 1]
            cos, sin = math.cos(poses[c, t, 2]), math.sin(poses[c, t, 2])
            least = far
            for n in range(len(obstacles)):
                dx, dy = obstacles[n, 0] - x, obstacles[n, 1] - y
                if abs(dx) > reach or abs(dy) > reach:
                    continue
                along, aside = abs(cos * dx + sin * dy) - half_length, abs(cos * dy - sin * dx) - half_width
                if along > 0.0 and aside > 0.0:
                    least = min(least, math.hypot(along, aside))
                else:
                    least = min(least, max(along, aside))
            gaps[c, t] = least
    return gaps
