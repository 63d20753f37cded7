"""Region growing: planes in an organized point cloud. Kernels; lengths in m."""

import numpy as np

from ...slam.view_kernel import kernel


@kernel
def tolerance(depth):
    """Return how far from its plane a point at `depth` may lie: the camera's noise grows with the square of depth."""
    return 0.015 + 0.0012 * depth * depth


@kernel
def _fit(moments, count):
    """Return the plane (4,), n p = d, through points with sums `moments` (9,): x y z xx xy xz yy yz zz."""
    mean = moments[:3] / count
    spread = np.empty((3, 3))
    k = 3
    for i in range(3):
        for j in range(i, 3):
            spread[i, j] = moments[k] / count - mean[i] * mean[j]
            spread[j, i] = spread[i, j]
            k += 1
    vectors = np.linalg.eigh(spread)[1]
    plane = np.empty(4)
    plane[:3] = vectors[:, 0]
    plane[3] = (plane[:3] * mean).sum()
    if plane[3] > 0.0:  # the normal points to the camera, which is at the origin
        plane[:] = -plane
    return plane


@kernel
def _add(moments, p):
    k = 3
    for i in range(3):
        moments[i] += p[i]
        for j in range(i, 3):
            moments[k] += p[i] * p[j]
            k += 1


@kernel
def _joins(plane, p, n, cos_turn):
    """Return whether a point `p` with normal `n` belongs to a plane; not where either is NaN."""
    away = abs(plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] - plane[3])
    return away < tolerance(p[0]) and n[0] * plane[0] + n[1] * plane[1] + n[2] * plane[2] >= cos_turn


@kernel
def _grow(points, normals, seed, number, cos_turn, region, queue):
    """Grow one region from a seed into `region` and `queue`; return how many pixels it has, and its plane."""
    height, width = region.shape
    plane = np.empty(4)
    plane[:3] = normals[seed // width, seed % width]
    plane[3] = (plane[:3] * points[seed // width, seed % width]).sum()
    moments = np.zeros(9)
    queue[0], head, tail, refit = seed, 0, 1, 12
    region[seed // width, seed % width] = number
    while head < tail:
        row, col = queue[head] // width, queue[head] % width
        _add(moments, points[row, col])
        head += 1
        if head >= refit:
            plane = _fit(moments, head)
            refit = head + head // 2
        for step in range(4):
            i, j = row + (step == 0) - (step == 1), col + (step == 2) - (step == 3)
            inside = 0 <= i < height and 0 <= j < width
            if inside and region[i, j] == -1 and _joins(plane, points[i, j], normals[i, j], cos_turn):
                region[i, j] = number
                queue[tail] = i * width + j
                tail += 1
    return tail, _fit(moments, tail)


@kernel
def grow_regions(points, normals, seeds, least, cos_turn, region, planes):
    """Collect pixels into planar regions, from the flattest on; return the number of regions.

    A neighbour joins when it lies within `tolerance` of the region's plane and its normal does not turn away by more
    than the angle of `cos_turn`. The plane is fitted anew each time the region has grown by half.

    Args:
        points: (h, w, 3), NaN where nothing was measured.
        normals: (h, w, 3), NaN where unknown.
        seeds: (m,) flat numbers of the pixels to start from, in this order.
        least: Fewest pixels of a region.
        cos_turn: Cosine of the largest angle between the normals of pixel and plane.
        region: (h, w) int32, -1 at first; written, the number of each pixel's region, -2 in regions too small.
        planes: (k, 4) written; normal towards the camera and offset, n p = d.
    """
    height, width = region.shape
    queue = np.empty(height * width, dtype=np.int64)
    found = 0
    for seed in seeds:
        if found == len(planes):
            break
        if region[seed // width, seed % width] != -1:
            continue
        size, plane = _grow(points, normals, seed, found, cos_turn, region, queue)
        if size < least:
            for k in range(size):
                region[queue[k] // width, queue[k] % width] = -2
        else:
            planes[found] = plane
            found += 1
    return found


@kernel
def settle(points, planes, region, radius, settled):
    """Give each measured pixel to the plane among those of its neighbours to which it is nearest, if near enough.

    Args:
        points: (h, w, 3), NaN where nothing was measured.
        planes: (k, 4) normals and offsets.
        region: (h, w) int32, negative for none.
        radius: How far away neighbours are [pixels].
        settled: (h, w) int32, written; -1 for none.
    """
    height, width = region.shape
    for row in range(height):
        for col in range(width):
            settled[row, col] = -1
            p = points[row, col]
            if not np.isfinite(p[0]):
                continue
            best, tried = tolerance(p[0]), -1
            for i in range(max(0, row - radius), min(height, row + radius + 1)):
                for j in range(max(0, col - radius), min(width, col + radius + 1)):
                    k = region[i, j]
                    if k < 0 or k == tried:
                        continue
                    tried = k
                    away = abs(planes[k, 0] * p[0] + planes[k, 1] * p[1] + planes[k, 2] * p[2] - planes[k, 3])
                    if away < best:
                        best = away
                        settled[row, col] = k
