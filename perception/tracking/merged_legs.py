"""Both legs of a person seen as one cluster, which no forest of legs believes in."""

import numpy as np

from ...slam.view_kernel import inner_kernel
from .assignment import assigned
from .leg_kernels import since_leg
from .local_grid import are_free
from .track_kernels import distances
from .tracks import LEGS, PEOPLE


@inner_kernel
def see_merged_legs(tracks, seen, centre, confidence, found, places, time_s, c):
    """Find people of whom no leg was seen in clusters wider than a leg.

    Such a cluster must stand where the person was predicted, and on free cells; its confidence counts.

    Args:
        tracks: Predicted to this scan.
        seen: (n,) whether a leg of each person was seen; these three are written to.
        centre: (n, 2) where.
        confidence: (n,) of what was seen.
        found: All clusters of the scan, see `detection_kernel.Found`.
        places: (m, 2) where they are, odometry frame [m].
        time_s: Of the scan [s].
        c: Numbers of the tracker.
    """
    people = tracks.counts[PEOPLE]
    since_s = since_leg(tracks.legs[: tracks.counts[LEGS]], people)
    unseen = np.flatnonzero(~seen & (since_s < c.merged_legs_duration_s))
    if len(unseen) == 0:
        return
    wide = _wide(found, c)
    wide = wide[are_free(tracks.cells, places[wide], c.grid_resolution, time_s, c.grid_fade_s)]
    cost = distances(tracks.people["x"][:people][unseen], places[wide])
    rows, columns = assigned(cost, np.full(len(unseen), c.merged_legs_gate))
    for k in range(len(rows)):
        person, cluster = unseen[rows[k]], wide[columns[k]]
        seen[person], confidence[person] = True, found.confidence[cluster]
        centre[person, 0], centre[person, 1] = places[cluster, 0], places[cluster, 1]


@inner_kernel
def _wide(found, c):
    """Return (k,) the clusters that are no leg, and as wide as two."""
    points, start, end = found.points, found.start, found.end
    wide = np.zeros(len(start), np.bool_)
    for m in range(len(start)):
        if not found.human[m]:
            a, b = start[m], end[m] - 1
            width = np.hypot(points[b, 0] - points[a, 0], points[b, 1] - points[a, 1])
            wide[m] = c.merged_legs_width_min < width < c.merged_legs_width_max
    return np.flatnonzero(wide)
