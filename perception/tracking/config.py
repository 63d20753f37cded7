"""Every number of the people tracker, as a tree: one node for each stage."""

from dataclasses import dataclass, field, fields
from typing import Annotated

from ...slam.bounds import Share, Within, check_numbers
from ...slam.errors import InputError


def check_positive(config: object, *may_be_zero: str) -> None:
    """Check the numbers of a configuration, a dataclass; each must be positive, or 0 where its name `may_be_zero`.

    Raises:
        InputError: Naming the field, the rule and the value.
    """
    check_numbers(config)
    for each in fields(config):  # pyright: ignore[reportArgumentType]
        value = getattr(config, each.name)
        if isinstance(value, (int, float)) and not (value > 0 or (value == 0 and each.name in may_be_zero)):
            raise InputError(f"`{each.name}` must be positive, got {value}")


def check_below_one(config: object, *names: str) -> None:
    """Raise InputError unless the fields `names` of a configuration are below 1."""
    for name in names:
        if getattr(config, name) >= 1.0:
            raise InputError(f"`{name}` must be below 1, got {getattr(config, name)}")


@dataclass(frozen=True, kw_only=True)
class MotionConfig:
    """Constant-velocity motion, its noise, and how fast a track gains or loses confidence.

    `q` and `confidence_gain` are meant for one scan at `reference_rate_hz` and scale with the time between two scans.

    Attributes:
        q: Process noise, Q = q I per reference period (Table II) [m^2, (m/s)^2].
        r: Measurement noise, R = r I (Table II) [m^2].
        one_leg_variance: Added to `r` where one leg alone measures the centre of a person [m^2].
        initial_variance: P0 = this times I (eq. 5b) [m^2, (m/s)^2].
        reference_rate_hz: Scan rate for which `q` and `confidence_gain` are stated [1/s]. The paper prints none; at
            5 Hz a person survives a full occlusion of one second under Table II's epsilon (at 10 Hz: 0.7 s).
        confidence_gain: Weight of a new detection's confidence (eq. 6, 0.05).
        coast_s: Time constant with which the velocity of somebody whose track has ended is believed to fade [s].
    """

    q: float = 0.05
    r: float = 0.1
    one_leg_variance: float = 0.1
    initial_variance: float = 0.05
    reference_rate_hz: Annotated[float, Within(1e-3, 1e4)] = 5.0
    confidence_gain: Share = 0.05
    coast_s: float = 1.0

    def __post_init__(self) -> None:
        check_positive(self)
        check_below_one(self, "confidence_gain")

    def process_variance(self, dt: float) -> float:
        """Return the diagonal of Q for `dt` seconds: q at the reference rate, proportional to time."""
        return self.q * dt * self.reference_rate_hz

    def confidence_weight(self, dt: float) -> float:
        """Return the gain of eq. 6 for `dt` seconds, so that its memory lasts equally long at any scan rate."""
        return 1.0 - (1.0 - self.confidence_gain) ** (dt * self.reference_rate_hz)


@dataclass(frozen=True, kw_only=True)
class GatingConfig:
    """Data association: how far a detection may be from the track that it belongs to.

    Attributes:
        gate: Largest distance between a leg track and its detection, at a very high scan rate [m].
        gate_speed: How much the gate grows with the time since the leg was last seen: a swinging foot overtakes its
            person [m/s].
        gate_max: The gate grows no larger than this [m].
        anchor_s: For this long after it was seen, a leg is looked for where it was seen as well as where it was
            predicted: feet stop and start between two scans [s].
        reach: Largest distance between a person's predicted centre and one of its legs [m].
    """

    gate: float = 0.35
    gate_speed: float = 2.5
    gate_max: float = 0.8
    anchor_s: float = 0.3
    reach: float = 0.8

    def __post_init__(self) -> None:
        check_positive(self)


@dataclass(frozen=True, kw_only=True)
class PairingConfig:
    """Which two legs belong to one person.

    Attributes:
        distance: Largest distance between the two legs that start a person [m].
        width: Largest distance between them in the mean over `stride_s`, where steps cancel out [m].
        margin: By how much narrower a pair must be for a person to exchange a leg [m].
        stride_s: Time constant of that mean [s].
        offset_s: Time constant with which the believed offset of a hidden leg from its person's centre fades [s].
    """

    distance: float = 0.9
    width: float = 0.5
    margin: float = 0.15
    stride_s: float = 1.0
    offset_s: float = 0.3

    def __post_init__(self) -> None:
        check_positive(self)


@dataclass(frozen=True, kw_only=True)
class MergedLegsConfig:
    """Both legs of a known person seen as one cluster, which is too wide for a leg.

    Attributes:
        width_min: A cluster wider than this can be both legs [m].
        width_max: And narrower than this [m].
        gate: Largest distance between it and the person's predicted centre [m].
        duration_s: Longest time that a person is believed in without seeing a leg apart [s].
    """

    width_min: float = 0.15
    width_max: float = 0.6
    gate: float = 0.3
    duration_s: float = 3.0

    def __post_init__(self) -> None:
        check_positive(self)


@dataclass(frozen=True, kw_only=True)
class ConfirmationConfig:
    """Track confirmation: which tentative leg tracks start a person.

    Attributes:
        delta: Both legs must have moved this far, in the mean of the two, before they start a person (Table II) [m].
        gamma: And their tracks must have at least this confidence, by eq. 6 (Table II), in [0, 1].
        sure_confidence: Two leg tracks of at least this confidence (eq. 6) start a person when they moved `delta` in
            sum: one leg has stepped past the other. Between two things that a forest takes for legs less surely, such
            a step can be a confusion. One such leg alone starts a person when it moved twice `delta`, for both.
        origin_radius: Nothing may stand any more within this distance of where a leg that moved began [m].
        unseen_s: A leg may be unseen for this long when its person starts [s].
    """

    delta: float = 0.5
    gamma: Share = 0.3
    sure_confidence: Share = 0.5
    origin_radius: float = 0.12
    unseen_s: float = 0.3

    def __post_init__(self) -> None:
        check_positive(self)
        check_below_one(self, "gamma", "sure_confidence")


@dataclass(frozen=True, kw_only=True)
class TerminationConfig:
    """Track termination: when a track of a leg or of a person ends.

    Attributes:
        epsilon: When the first element of its covariance exceeds this (Table II) [m^2].
        c_min: When its confidence, by eq. 6, falls below this (Table II), in [0, 1].
    """

    epsilon: float = 0.9
    c_min: Share = 0.1

    def __post_init__(self) -> None:
        check_positive(self)
        check_below_one(self, "c_min")


@dataclass(frozen=True, kw_only=True)
class ReidentificationConfig:
    """Re-identification: people whose track ended get their number back when they are seen again.

    Attributes:
        memory_s: How long somebody whose track ended can be re-identified [s].
        known_s: Whoever was tracked for less than this is not remembered [s].
        distance: Largest distance from the prediction at which somebody is re-identified [m].
        overlap_s: How long the legs of somebody may have been tracked anew before the old track was last seen: tracks
            overlap when one person is taken for two [s].
        near: Legs this close to the prediction are the remembered person's without moving `delta` again [m].
        near_age_s: When they have been tracked for this long [s].
        one_leg_age_s: When only one of its legs is seen, it must have been tracked for this long [s].
        unseen_s: A tracked person of whom no leg was seen for this long may be somebody new nearby: its track may have
            slid off to something else [s].
    """

    memory_s: float = 10.0
    known_s: float = 5.0
    distance: float = 3.0
    overlap_s: float = 0.5
    near: float = 0.8
    near_age_s: float = 0.2
    one_leg_age_s: float = 0.4
    unseen_s: float = 1.0

    def __post_init__(self) -> None:
        check_positive(self)


@dataclass(frozen=True, kw_only=True)
class LocalGridConfig:
    """The local occupancy grid of what is not human.

    Attributes:
        resolution: Side of a cell [m].
        rise_s: Time under non-human points until a cell counts as occupied [s].
        fade_s: How fast a cell that is no longer hit becomes free again [s].
        still_s: A leg track that never moved for this long, and is nobody's leg, marks the grid as not human [s].
        clearance: Points this close to a person, or to what may become one, do not mark the grid [m].
    """

    resolution: Annotated[float, Within(0.01, 100.0)] = 0.05
    rise_s: float = 0.3
    fade_s: float = 3.0
    still_s: float = 3.0
    clearance: float = 0.35

    def __post_init__(self) -> None:
        check_positive(self)


@dataclass(frozen=True, kw_only=True)
class CameraConfig:
    """People that a camera saw, taken into the tracks.

    Attributes:
        gate: Largest distance between a person and where the camera saw it [m].
        r: Measurement noise of the camera, R = r I [m^2].
        sure: From this likelihood on the camera can start a person, in [0, 1].
        frames: After so many frames.
        wait_s: Longest time between two of these frames [s].
    """

    gate: float = 0.6
    r: float = 0.05
    sure: Share = 0.7
    frames: int = 3
    wait_s: float = 1.5

    def __post_init__(self) -> None:
        check_positive(self)
        check_below_one(self, "sure")


@dataclass(frozen=True, kw_only=True)
class TrackerConfig:
    """Numbers of `PeopleTracker`, one node for each of its stages.

    Attributes:
        motion: Prediction and correction.
        gating: Data association.
        pairing: Which two legs belong to one person.
        merged_legs: Both legs seen as one cluster.
        confirmation: When tentative tracks become a person.
        termination: When a track ends.
        reidentification: When somebody new is somebody known.
        grid: Where things stand that are not human.
        camera: What a camera adds.
    """

    motion: MotionConfig = field(default_factory=MotionConfig)
    gating: GatingConfig = field(default_factory=GatingConfig)
    pairing: PairingConfig = field(default_factory=PairingConfig)
    merged_legs: MergedLegsConfig = field(default_factory=MergedLegsConfig)
    confirmation: ConfirmationConfig = field(default_factory=ConfirmationConfig)
    termination: TerminationConfig = field(default_factory=TerminationConfig)
    reidentification: ReidentificationConfig = field(default_factory=ReidentificationConfig)
    grid: LocalGridConfig = field(default_factory=LocalGridConfig)
    camera: CameraConfig = field(default_factory=CameraConfig)
