"""Parameters of GMapping."""

from dataclasses import dataclass, field, fields
from typing import Annotated

from ..bounds import Cell, Reach, Share, Threads, Within, check_numbers
from ..errors import InputError


@dataclass(frozen=True, kw_only=True)
class MatcherConfig:
    """Parameters of the alignment of a scan with a particle's map.

    The alignment runs through stages from coarse to fine; the tuples have one entry a stage. It begins where the robot
    is expected, with the finest stage; only where the map speaks against the pose that this leads to is another start
    looked for, from which all stages lead on.

    Attributes:
        weight: Log-likelihood between a scan whose points all contradict the map and one with none that does; as many
            points are worth it, fewer are worth their number.
        unseen: What a point counts where the map knows nothing, as a share of a contradiction: so much that a scan of
            which nothing is known, just after one that was, makes the odometry suspicious.
        suspicion: Minus the log-likelihood of a match above which a better start is looked for. Of 0.75, 1.5 and 3, ten
            runs each, with the largest FHW comes out worse than where samples are always searched (0.27 m for 0.21 m),
            with this one no log does (FHW 0.21, ACES 0.25 for 0.29, Belgioioso 0.070 for 0.076 m).
        samples: Poses drawn from the odometry's error, among which the best other start is looked for.
        sample_points: About this many points of the scan judge a sample.
        windows: Half size of the window searched for the nearest occupied cell [cells].
        strides: Every how many-th point is used.
        iterations: Most Gauss-Newton steps.
        scales: Distance at which a point counts a quarter (Geman-McClure) [cells].
        thinning: At most one point of a scan in a square of this side [cells].
        straightness: Mean hit points around a cell form a line where their variance across is below this share of
            that along.
        sigma: Standard deviation of one point's distance from the map [m].
        independent_points: At most this many points count as independent of each other, so that a thousand beams
            on one wall do not pretend to a certainty they have not.
    """

    weight: float = 30.0
    unseen: Share = 0.4
    suspicion: float = 0.75
    samples: Annotated[int, Within(1, 10_000)] = 128
    sample_points: Annotated[int, Within(1, 10_000)] = 60
    windows: Annotated[tuple[int, ...], Within(1, 15)] = (4, 3)
    strides: Annotated[tuple[int, ...], Within(1, 1000)] = (2, 1)
    iterations: Annotated[tuple[int, ...], Within(1, 1000)] = (4, 8)
    scales: Annotated[tuple[float, ...], Within(1e-3, 1e3)] = (3.0, 2.0)
    thinning: Annotated[float, Within(0.1, 1e3)] = 1.0
    straightness: Share = 0.15
    sigma: Annotated[float, Within(1e-4, 10.0)] = 0.03
    independent_points: float = 150.0

    def __post_init__(self) -> None:
        check_numbers(self)
        stages = {len(self.windows), len(self.strides), len(self.iterations), len(self.scales)}
        if len(stages) != 1 or 0 in stages:
            raise InputError("`windows`, `strides`, `iterations` and `scales` must be equally long and not empty")
        _check_positive(self, but=("unseen",))


@dataclass(frozen=True, kw_only=True)
class TrackingConfig:
    """Parameters of the pose between matched scans, and of the doubt about the odometry.

    Attributes:
        lie: Minus the log of the probability that the odometry lies about an increment: once in 3000.
        lost: A scan leaves it open where the robot is if more than this share of its points contradicts the map, or if
            it was found without the odometry and its log-likelihood is below minus `misfit`.
        misfit: See `lost`. With 0.75 for 3, GMapping was not sure of 55 for 5 of the 1,988 scans of the CSAIL log.
        spread: Nor is it known where the particles' positions have a larger standard deviation than this [m].
        memory: Over so many scans is remembered how far the robot went from one to the next, and over so many matched
            ones how good the odometry is.
        least_way: The robot may always have moved so far between two scans [m] ...
        least_turn: ... and turned so far [rad] ...
        agility: ... and further by this many times the largest motion of late.
        window_turn: Step between the headings of the search without odometry [rad].
    """

    lie: float = 8.0
    lost: Share = 0.4
    misfit: float = 3.0
    spread: float = 1.0
    memory: Annotated[float, Within(1.0, 1e6)] = 30.0
    least_way: Annotated[float, Within(0.01, 100.0)] = 0.3
    least_turn: Annotated[float, Within(0.01, 10.0)] = 0.3
    agility: Annotated[float, Within(0.1, 100.0)] = 1.5
    window_turn: Annotated[float, Within(1e-3, 1.0)] = 0.04

    def __post_init__(self) -> None:
        check_numbers(self)
        _check_positive(self)


@dataclass(frozen=True, kw_only=True)
class GMappingConfig:
    """Parameters of GMapping, named as those of the ROS wrapper where they mean the same.

    Attributes:
        particles: Number of particles.
        linear_update: A scan is matched and mapped after this much motion [m] ...
        angular_update: ... or this much turning [rad].
        delta: Side of a cell [m].
        fullness: A cell is occupied when more than this share of its visits were hits.
        ray_margin: The last share of a ray before a hit visits nothing: else far beams, by their noise, wear away the
            near side of what stands before others, and corridors are drawn too long.
        srr: Odometry's translation error per translation [m/m]; of this and the next three, what is known at first.
        srt: Odometry's rotation error per translation [rad/m].
        str_: Odometry's translation error per rotation [m/rad].
        stt: Odometry's rotation error per rotation [rad/rad].
        max_urange: Longer ranges are cut there: free so far, nothing hit [m].
        observation_gain: How many independent beams a scan counts for in the weight of a particle, at most.
        resample_threshold: Particles are resampled when their effective number falls below this share of them.
        minimum_score: 1 - loss that an alignment must reach; else the pose follows the odometry alone. 0: never.
        threads: Threads that share the particles; the result does not depend on them.
        matcher: Parameters of the alignment.
        tracking: Parameters of the pose between matched scans.
    """

    particles: Annotated[int, Within(1, 1000)] = 30
    linear_update: float = 0.5
    angular_update: float = 0.3
    delta: Cell = 0.05
    fullness: Share = 0.1
    ray_margin: Share = 0.01
    srr: float = 0.1
    srt: float = 0.2
    str_: float = 0.1
    stt: float = 0.2
    max_urange: Reach = 80.0
    observation_gain: float = 30.0
    resample_threshold: Share = 0.5
    minimum_score: Share = 0.0
    threads: Threads = 2
    matcher: MatcherConfig = field(default_factory=MatcherConfig)
    tracking: TrackingConfig = field(default_factory=TrackingConfig)

    def __post_init__(self) -> None:
        check_numbers(self)
        _check_positive(
            self, but=("srr", "srt", "str_", "stt", "minimum_score", "linear_update", "angular_update", "ray_margin")
        )


def _check_positive(config: object, but: tuple[str, ...] = ()) -> None:
    """Raise InputError unless each number of a dataclass is positive, those named in `but` at least zero."""
    for entry in fields(config):  # pyright: ignore[reportArgumentType]
        value = getattr(config, entry.name)
        for number in value if isinstance(value, tuple) else (value,):
            if not isinstance(number, (int, float)):
                continue
            if not (number > 0 or (number == 0 and entry.name in but)):
                raise InputError(f"`{entry.name}` must be positive, got {value}")
