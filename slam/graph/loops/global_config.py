"""Settings of global SLAM."""

from dataclasses import dataclass, field

from ...bounds import Share, Threads, check_numbers, check_positive
from ...pose_graph.adjustment import AdjustmentConfig
from ...revisits import RevisitConfig
from .constraints import ConstraintConfig


@dataclass(frozen=True, kw_only=True)
class GlobalSlamConfig:
    """Settings of `GlobalSlam`.

    Attributes:
        constraints: How constraints are made.
        adjustment: How the graph is adjusted.
        adjust_every: The graph is adjusted after so many nodes, if a constraint is new ...
        adjust_share: ... and this share of all nodes is: all adjustments cost as much as 50 of the whole graph then,
            however long the drive is.
        max_distance: Submaps whose middle (the laser's mean place) is farther off a node are not matched [m].
        placed_within: A submap to which the way over nodes and submaps is no longer counts as well placed: a match
            suffices [m].
        kernel_width: Of INTER constraints, in standard deviations.
        odometry_share: Share of its information with which odometry ties a node to the one before.
        reject_beyond: INTER constraints that the adjusted graph contradicts by more standard deviations are dropped.
        converged: A match that the adjusted graph meets as well as this is not made anew [m, rad].
        nearest: A node is matched with at most so many known submaps; in the end with twice as many.
        search_every: One global search for each so many metres travelled: half the stretch that is searched for [m].
        final_residual: INTER constraints that the finished graph misses by more are dropped [m, rad].
        revisits: When a node is superseded; a submap all of whose nodes are leaves the graph, and with it those nodes.
        threads: Threads that share what is searched for loops, and what `finish` matches and draws; the result does not
            depend on them.
    """

    constraints: ConstraintConfig = field(default_factory=ConstraintConfig)
    adjustment: AdjustmentConfig = field(default_factory=lambda: AdjustmentConfig(iterations=20, tolerance=1e-5))
    adjust_every: int = 40
    adjust_share: Share = 0.02
    max_distance: float = 15.0
    placed_within: float = 12.0
    kernel_width: float = 4.0
    odometry_share: float = 0.02
    reject_beyond: float = 12.0
    final_residual: tuple[float, float] = (0.1, 0.0175)
    converged: tuple[float, float] = (0.05, 0.02)
    nearest: int = 4
    search_every: float = 3.0
    revisits: RevisitConfig = field(default_factory=RevisitConfig)
    threads: Threads = 2

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(
            self, "adjust_every", "max_distance", "placed_within", "kernel_width", "odometry_share", "reject_beyond"
        )
