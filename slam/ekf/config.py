"""Settings of EKF-SLAM."""

from dataclasses import dataclass, field

from ..bounds import Cell, Reach, check_numbers
from ..errors import InputError, unknown_name
from ..landmarks.clustering import METHODS
from ..landmarks.objects import SightingConfig
from .calibrated_motion import OdometryNoise

ASSOCIATIONS = ("nearest", "joint")


@dataclass(frozen=True, kw_only=True)
class EkfSlamConfig:
    """Settings of `EkfSlam`.

    Attributes:
        clustering: "heuristic", "kmeans", "gmm" or "dbscan".
        cluster_distance: Largest distance within an object [m], for "heuristic" and "dbscan".
        cluster_points: Fewest points of an object, for "heuristic" and "dbscan".
        association: "nearest" or "joint" (joint compatibility).
        gate: Largest squared Mahalanobis distance of a sighting to its landmark.
        new_gate: A sighting further than this from all landmarks is a new one; between both it is left out.
        travel: Scans are used once the robot went so far since the last used one [m] ...
        turn: ... or turned so far [rad]. The wheels' noise enters the very motion that their scale is learned from; the
            longer the way between two corrections, the less that pretends to tell (0.2 m: average NEES 3.2; 0.4: 3.0).
        sure: Sightings that make a landmark a lasting one.
        patience: A landmark that is not lasting is forgotten after being missed so often where it should be seen.
        lost_sigma: The engine is not located once a standard deviation of the position exceeds this [m].
        resolution: Side of a cell of the map [m].
        odometry: What is known of the wheels.
        sighting: What counts as a landmark.
    """

    clustering: str = "dbscan"
    cluster_distance: Reach = 0.5
    cluster_points: int = 1
    association: str = "joint"
    gate: float = 9.21
    new_gate: float = 25.0
    travel: float = 0.4
    turn: float = 0.2
    sure: int = 3
    patience: int = 3
    lost_sigma: float = 0.5
    resolution: Cell = 0.05
    odometry: OdometryNoise = field(default_factory=OdometryNoise)
    sighting: SightingConfig = field(default_factory=SightingConfig)

    def __post_init__(self) -> None:
        check_numbers(self)
        if self.clustering not in METHODS:
            raise unknown_name("clustering method", self.clustering, tuple(METHODS))
        if self.association not in ASSOCIATIONS:
            raise unknown_name("association", self.association, ASSOCIATIONS)
        if not 0.0 < self.gate <= self.new_gate:
            raise InputError(f"need 0 < `gate` <= `new_gate`, got {self.gate} and {self.new_gate}")
        for name in ("travel", "turn"):
            if not getattr(self, name) >= 0.0:
                raise InputError(f"`{name}` must not be negative, got {getattr(self, name)}")
        for name in ("cluster_distance", "lost_sigma", "resolution"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"`{name}` must be positive [m], got {getattr(self, name)}")
        for name in ("cluster_points", "sure", "patience"):
            if getattr(self, name) < 1:
                raise InputError(f"`{name}` must be at least 1, got {getattr(self, name)}")
