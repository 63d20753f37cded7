"""Every number of the people tracker, as a tree: one node for each of its stages."""

from dataclasses import dataclass, field
from typing import Annotated

from ...slam.bounds import Share, Within, check_numbers, check_positive
from ..legs.recent_views import RecentViewsConfig
from .still_frame import StillFrameConfig


@dataclass(frozen=True, kw_only=True)
class MotionConfig:
    """Constant-velocity motion and its noise.

    `q` is meant for one scan at `reference_rate_hz` and scales with the time between two scans.

    Attributes:
        q: Process noise, Q = q I per reference period (Table II of Ye 2021) [m^2, (m/s)^2].
        r: Measurement noise, R = r I (Table II). With 0.03 people who pass each other exchange their tracks more
            seldom in simulation (of 1600 tours of PID in drawn buildings 91 lose their leader, 120 with 0.1), but of
            people around a real robot that drives fewer are found (0.42, 0.53) [m^2].
        one_leg_variance: Added to `r` where one leg alone measures the centre of a person [m^2].
        initial_variance: P0 = this times I (eq. 5b), four times as much of the velocity: nobody begins at rest
            [m^2, (m/s)^2].
        reference_rate_hz: Scan rate for which `q` is stated [1/s]. The paper prints none.
        coast_s: Time constant with which the velocity of somebody whose track has ended is believed to fade [s].
    """

    q: float = 0.05
    r: float = 0.1
    one_leg_variance: float = 0.1
    initial_variance: float = 0.05
    reference_rate_hz: Annotated[float, Within(1e-3, 1e4)] = 5.0
    coast_s: float = 1.0

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self)

    def process_variance(self, dt: float) -> float:
        """Return the diagonal of Q for `dt` seconds: q at the reference rate, proportional to time."""
        return self.q * dt * self.reference_rate_hz


@dataclass(frozen=True, kw_only=True)
class AssociationConfig:
    """Data association: which clusters are the legs of whom, by likelihood.

    Attributes:
        clutter: Things that could be legs, a square metre.
        stride: Farthest that two legs of one person are apart [m].
        leg: Standard deviation with which a leg is seen where it is, as one with the other or apart: half the distance
            between the two [m].
        pace: How fast a leg swings past its person: as fast as people walk; 1.5 and 2 do alike, 1 loses legs [m/s].
        near: Nothing nearer to the laser is a person; many robots see themselves there [m].
        indifferent: Evidence of a look that says nothing when legs and people are matched: few legs show less.
        least: What it says otherwise is no less than this: where a leg is says more than its look.
        most: And no more.
        offset_s: Time constant with which the believed offset of a hidden leg from its person's centre fades [s].
    """

    clutter: float = 0.2
    stride: float = 0.9
    leg: float = 0.1
    pace: float = 1.5
    near: float = 0.2
    indifferent: float = 4.5
    least: float = -3.0
    most: float = 2.0
    offset_s: float = 0.3

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "clutter", "stride", "leg", "pace", "near", "offset_s")


@dataclass(frozen=True, kw_only=True)
class EvidenceConfig:
    """How surely what is seen is a person: log odds, linear in what several looks show.

    The log odds of a hypothesis are `prior` + n / (1 + `alike` (n - 1)) times the mean over its n looks of `base` +
    `vote` L + `second` S + `empty` E: L is the log odds of the forest of its better leg, S that of the other leg above
    `second_from`, E the share of recent scans in which the place was empty, of those that tell, as far as the frame
    stands still. The weights but `empty` and `moved` are a logistic regression (`alike` by likelihood from 0.3, 0.6,
    0.9) on hypotheses of 48 drawn drives and of the recordings positive_1 to 3, negative_2 and demo_stationary,
    with forests that had not seen them; none of a moving robot among people, and none from outdoors. `empty`, with
    `came` and `unknown`, is from a grid of a dozen: most found in positive_1 to 3 (0.895, 1, 0.981; 0.886, 1, 0.945
    with 3.3 and 1.5) where nobody is seen in negative_2 (somebody from 6 on). Written for the confidence of the shipped
    forest for real scans: the fit was to its votes before they are weighed by its odds (0.485).

    A camera's look is one, too, with L the log odds of what it saw; it need not have moved.

    Attributes:
        prior: Log odds before the first look.
        base: Of a look.
        vote: Weight of the forest's log odds.
        second: Of those of the other leg.
        second_from: Log odds of the forest from which another leg speaks for a person.
        empty: Weight of the share of recent scans in which the place was empty.
        moved: Log odds of what has gone a `least_way`; each further one tells as another look does. 85 % of walkers in
            simulated drives have, 0.3 % of the things there and 1.2 % of those in negative_2. That tells more (4), but
            what was taken for two things in turn is believed in for seconds: with 2.5 somebody is seen in negative_2
            (0.21 a scan), with 2 nobody.
        alike: Intraclass correlation of looks at one thing: a thing looks like itself again.
        most_looks: No more are remembered.
        look: Motion relative to the laser, or in a frame that stands still, that gives a new look: what stands before a
            standing robot shows nothing new, however often; who walks ahead of one shows other steps [m].
        jitter: Less motion than this is noise [m].
        hidden_rate: Log odds lost a second while unseen [1/s].
        missing_rate: The same where the laser sees that nobody is there [1/s].
        body: A person is missing only if all beams pass that go within this distance of its centre: a leg is there [m].
        unknown: Added to the share of recent scans that tell of a place: one of which little is known says little.
        came: Nothing was at a place a moment ago if it was empty in this share of the recent scans.
        least_way: As far as a leg must move in Table II (delta) [m].
        least_pace: And it still moves as fast: slower than anybody strolls, faster than what is taken for something
            else now and then [m/s].
    """

    prior: float = -7.07
    base: float = 6.15
    vote: float = 0.67
    second: float = 2.02
    second_from: float = -2.2
    empty: float = 4.5
    moved: float = 2.0
    alike: float = 0.6
    most_looks: float = 10.0
    look: float = 0.3
    jitter: float = 0.1
    hidden_rate: float = 4.0
    missing_rate: float = 12.0
    body: float = 0.16
    unknown: float = 0.3
    came: float = 0.4
    least_way: float = 0.5
    least_pace: float = 0.4

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "most_looks", "look", "jitter", "body", "unknown", "least_way", "least_pace")


@dataclass(frozen=True, kw_only=True)
class ExistenceConfig:
    """Where hypotheses begin, when they are people, and when they end.

    Attributes:
        begin: What a cluster says must be at least this where a hypothesis begins.
        start: Log odds from which a hypothesis is a person (55 to 1). Where something has stood still, or may do so for
            all that is known yet, they count for less, by twice `memory`. With 3.5 somebody is seen in negative_2 (0.04
            a scan), with 4.5 fewer are found among simulated people.
        again: Log odds by which who may be somebody lost is likelier a person than who was never seen: so much denser
            is somebody within a few metres of where they were lost (0.1 a square metre) than people in a building
            (0.01 a square metre). From 1 to 3 tried on simulated drives; from 3 on, furniture is taken for the lost.
        stop: Log odds below which a person is none any more (evens).
        stand_s: Who is believed in but does not move, and whatever is where something has stood, loses one of the log
            odds in this time: things stand for ever. With 5, 7 and 10 furniture is 0.014, 0.029 and 0.053 of what is
            seen of walkers in thirty simulated offices; what is found of people is the same. After so long it is as
            if it had never moved, and the place is marked: of chair legs that were taken for one leg that steps, the
            simulated meeting room had whole drives full. And what has stood for so long is a thing until it moves: it
            is no hypothesis, which would take the legs of who passes for its own and keep their number (of 46 offices
            furniture is 0.019 for 0.025, and 0.058 of the walkers are missed for 0.061; of 8 never tried before 0.040
            for 0.016, all in one drive, and 0.036 for 0.045) [s].
        gamma: What is told of legs has at least this confidence (Table II), in [0, 1].
        memory: Log odds by which a leg where something has stood still is less sure in what is told of legs, and surer
            elsewhere: half the weight of it beside the forest's log odds in a logistic regression (1.7; 1.3 to 2.1 with
            one of positive_1 to 3 left out, where as many legs are found); gamma keeps its meaning, 0.5 false legs a
            people-free scan. The whole weight counts where a hypothesis becomes a person; for the first
            `things.still_s` of what nobody saw come it is not known yet whether it stands, and it counts, too.
        vague: Who is hidden is given up when the variance of the place exceeds this: the standard deviation is 0.7 m
            then, and others are as likely there. Somebody seen there later is found `again` [m^2].
        told: Who is hidden is told of while the variance of the place is at most this: a standard deviation of half a
            metre, as far as two people are apart who stand together. Of 0.18 to 0.5 (told till the end) the smaller,
            the fewer false people, in each of the simulated scenes and recordings alike; below 0.2 a laser of 5 Hz
            does without whom a single scan missed [m^2].
        merge: Two hypotheses so near are one [m].
        own: Nobody new begins so near to a person: half a stride and a leg [m].
        tentative_s: A hypothesis that is nobody yet ends when it was unseen for so long [s].
    """

    begin: float = -1.0
    start: float = 4.0
    again: float = 2.5
    stop: float = 0.0
    stand_s: float = 5.0
    gamma: Share = 0.3
    memory: float = 0.85
    vague: float = 0.5
    told: float = 0.25
    merge: float = 0.35
    own: float = 0.6
    tentative_s: float = 0.5

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "stand_s", "vague", "told", "merge", "own", "tentative_s")


@dataclass(frozen=True, kw_only=True)
class ThingsConfig:
    """The local occupancy grid of what stands still.

    Attributes:
        resolution: Side of a cell [m].
        still_s: What was hit for so long is a thing, no person, until it moves [s].
        forget_s: And it is forgotten where nothing was hit for so long: from 1 to 3.5 s thirty simulated offices are
            the same, and with 1 s fewer labelled legs are found [s].
        clearance: Points this close to somebody who came do not mark the grid (zeta of Table II) [m].
    """

    resolution: Annotated[float, Within(0.01, 100.0)] = 0.05
    still_s: float = 0.5
    forget_s: float = 3.0
    clearance: float = 0.35

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self)


@dataclass(frozen=True, kw_only=True)
class ReidentificationConfig:
    """Re-identification: people whose track ended get their number back when they are seen again.

    Attributes:
        known_s: Who was tracked for less is not remembered: a step of each leg [s].
        max_age_s: How long somebody whose track ended can be re-identified [s].
        distance: Largest distance from the prediction at which somebody is re-identified [m].
        step: And it is no larger than this and what somebody walks, a metre a second [m].
        overlap_s: How long the legs of somebody may have been tracked anew before the old track was last seen: tracks
            overlap when one person is taken for two [s].
    """

    known_s: float = 1.0
    max_age_s: float = 10.0
    distance: float = 3.0
    step: float = 0.5
    overlap_s: float = 0.5

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self)


@dataclass(frozen=True, kw_only=True)
class CameraConfig:
    """People that a camera saw, taken into the tracks.

    Attributes:
        gate: Largest distance between a person and where the camera saw it [m].
        r: Measurement noise of the camera, R = r I [m^2].
    """

    gate: float = 0.6
    r: float = 0.05

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self)


@dataclass(frozen=True, kw_only=True)
class TrackerConfig:
    """Numbers of `PeopleTracker`, one node for each of its stages.

    Attributes:
        motion: Prediction and correction.
        association: Which clusters are the legs of whom.
        evidence: How surely what is seen is a person.
        views: What stood at a place a moment ago.
        frame: How far memory of places is to be believed.
        existence: Where hypotheses begin, when they are people, and when they end.
        reidentification: When somebody new is somebody known.
        things: Where things stand that are not human.
        camera: What a camera adds.
    """

    motion: MotionConfig = field(default_factory=MotionConfig)
    association: AssociationConfig = field(default_factory=AssociationConfig)
    evidence: EvidenceConfig = field(default_factory=EvidenceConfig)
    views: RecentViewsConfig = field(default_factory=RecentViewsConfig)
    frame: StillFrameConfig = field(default_factory=StillFrameConfig)
    existence: ExistenceConfig = field(default_factory=ExistenceConfig)
    reidentification: ReidentificationConfig = field(default_factory=ReidentificationConfig)
    things: ThingsConfig = field(default_factory=ThingsConfig)
    camera: CameraConfig = field(default_factory=CameraConfig)
