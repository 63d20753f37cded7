"""Both legs of a person seen as one cluster, which no forest of legs believes in."""

import numpy as np
from numpy.typing import NDArray

from ...slam.geometry import transform_points
from ..legs.detector import Detections
from .config import MergedLegsConfig
from .data_association import assign, distances
from .local_grid import LocalGrid
from .person_tracks import Sightings
from .tracks import Tracks


class MergedLegs:
    """Finds people of whom no leg was seen in clusters wider than a leg.

    Such a cluster must stand where the person was predicted, and on free cells; its confidence counts.

    Args:
        config: How wide, and how near.
        grid: Where things stand that are not human.
    """

    def __init__(self, config: MergedLegsConfig, grid: LocalGrid) -> None:
        self._config, self._grid = config, grid

    def measure(
        self, tracks: Tracks, sightings: Sightings, detections: Detections, pose: NDArray[np.float64], time_s: float
    ) -> Sightings:
        """Return `sightings` of the people in `tracks`, with those seen as one cluster added.

        Args:
            tracks: Predicted to this scan.
            sightings: What the legs seen apart say.
            detections: All clusters of the scan, robot frame.
            pose: (3,) T_odom_robot.
            time_s: Of the scan [s].
        """
        config, clusters = self._config, detections.clusters
        unseen = np.flatnonzero(~sightings.seen & (tracks.since_leg_s() < config.duration_s))
        if len(unseen) == 0:
            return sightings
        ends = clusters.points[clusters.end - 1] - clusters.points[clusters.start]
        width = np.hypot(ends[:, 0], ends[:, 1])
        wide = np.flatnonzero(~detections.human & (width > config.width_min) & (width < config.width_max))
        positions = transform_points(pose, detections.positions[wide])
        free = self._grid.is_free(positions, time_s)
        rows, columns = assign(distances(tracks.people["x"][unseen, :2], positions[free]), config.gate)
        seen, centre, confidence = sightings.seen.copy(), sightings.centre.copy(), sightings.confidence.copy()
        seen[unseen[rows]] = True
        centre[unseen[rows]] = positions[free][columns]
        confidence[unseen[rows]] = detections.confidence[wide][free][columns]
        return Sightings(seen, centre, confidence, sightings.one_leg)
