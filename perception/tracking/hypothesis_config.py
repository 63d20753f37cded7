"""Every number of `HypothesisTracker`, one node for each of its parts."""

from dataclasses import dataclass, field

from ...slam.bounds import check_numbers, check_positive
from ..legs.recent_views import RecentViewsConfig
from .still_frame import StillFrameConfig


@dataclass(frozen=True, kw_only=True)
class PersonEvidenceConfig:
    """How surely what is seen is a person: log odds, linear in what several looks show.

    The log odds of a hypothesis are `prior` + n / (1 + `alike` (n - 1)) times the mean over its n looks of `base` +
    `vote` L + `second` S + `empty` E: L is the log odds of the forest of its better leg, S that of the other leg above
    `second_from`, E the share of recent scans in which the place was empty, of those that tell, as far as the frame
    stands still. The weights but `empty` and `moved` are a logistic regression (`alike` by likelihood from 0.3, 0.6,
    0.9) on hypotheses of 48 drawn drives and of the recordings positive_1 to 3, negative_2 and demo_stationary,
    with forests that had not seen them; none of a moving robot among people, and none from outdoors. `empty`, with
    `came` and `unknown` of `HypothesisConfig`, is from a grid of a dozen: most found in positive_1 to 3 (0.895, 1,
    0.981; 0.886, 1, 0.945 with 3.3 and 1.5) where nobody is seen in negative_2 (somebody from 6 on). Written for the
    confidence of the shipped forest for real scans: the fit was to its votes before they are weighed by its odds
    (0.485).

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

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "most_looks", "look", "jitter")


@dataclass(frozen=True, kw_only=True)
class HypothesisConfig:
    """Numbers of `HypothesisTracker`; its motion is that of `MotionConfig`.

    Attributes:
        evidence: How surely what is seen is a person.
        views: What stood at a place a moment ago.
        frame: How far memory of places is to be believed.
        unknown: Added to the share of recent scans that tell of a place: one of which little is known says little.
        start: Log odds from which a hypothesis is a person (55 to 1). Where something has stood still, or may do so for
            all that is known yet, they count for less, by twice `memory`. With 3.5 somebody is seen in negative_2 (0.04
            a scan), with 4.5 fewer are found among simulated people.
        again: Log odds by which who may be somebody lost is likelier a person than who was never seen: so much denser
            is somebody within a few metres of where they were lost (0.1 a square metre) than people in a building
            (0.01 a square metre). From 1 to 3 tried on simulated drives; from 3 on, furniture is taken for the lost.
        stop: Log odds below which a person is none any more (evens).
        vague: Who is hidden is given up when the variance of the place exceeds this: the standard deviation is 0.7 m
            then, and others are as likely there. Somebody seen there later is found `again` [m^2].
        told: Who is hidden is told of while the variance of the place is at most this: a standard deviation of half a
            metre, as far as two people are apart who stand together. Of 0.18 to 0.5 (told till the end) the smaller,
            the fewer false people, in each of the simulated scenes and recordings alike; below 0.2 a laser of 5 Hz
            does without whom a single scan missed [m^2].
        least_way: As far as a leg must move in Table II (delta) [m].
        least_pace: And it still moves as fast: slower than anybody strolls, faster than what is taken for something
            else now and then [m/s].
        came: Nothing was at a place a moment ago if it was empty in this share of the recent scans.
        body: A person is missing only if all beams pass that go within this distance of its centre: a leg is there [m].
        still_s: What was hit for so long is a thing, no person, until it moves [s].
        fade_s: How fast that is forgotten where nothing is hit any more [s].
        memory: Log odds by which a leg seen there is less sure in what is told of legs, and surer elsewhere: half the
            weight of it beside the forest's log odds in a logistic regression (1.7; 1.3 to 2.1 with one of positive_1
            to 3 left out, where as many legs are found); gamma keeps its meaning, 0.5 false legs a people-free scan.
            The whole weight counts where a hypothesis becomes a person; for the first `still_s` of what nobody saw
            come it is not known yet whether it stands, and it counts, too.
        stand_s: Who is believed in but does not move loses one of the log odds in this time: things stand for ever. Of
            5 and 10, tried on simulated drives, 5 ends more furniture and no more people. After so long it is as if
            it had never moved, and the place is marked: of chair legs that were taken for one leg that steps, the
            simulated meeting room had whole drives full [s].
        clutter: Things that could be legs, a square metre.
        stride: Farthest that two legs of one person are apart [m].
        leg: Standard deviation with which a leg is seen where it is, as one with the other or apart: half the distance
            between the two [m].
        pace: How fast a leg swings past its person: as fast as people walk; 1.5 and 2 do alike, 1 loses legs [m/s].
        merge: Two hypotheses so near are one [m].
        own: Nobody new begins so near to a person: half a stride and a leg [m].
        near: Nothing nearer to the laser is a person; many robots see themselves there [m].
        indifferent: Evidence of a look that says nothing when legs and people are matched: few legs show less.
        affinity: What it says otherwise is no less and no more than this: where a leg is says more than its look.
        begin: And at least this where a hypothesis begins.
        tentative_s: A hypothesis that is nobody yet ends when it was unseen for so long [s].
    """

    evidence: PersonEvidenceConfig = field(default_factory=PersonEvidenceConfig)
    views: RecentViewsConfig = field(default_factory=RecentViewsConfig)
    frame: StillFrameConfig = field(default_factory=StillFrameConfig)
    unknown: float = 0.3
    start: float = 4.0
    again: float = 2.5
    stop: float = 0.0
    vague: float = 0.5
    told: float = 0.25
    least_way: float = 0.5
    least_pace: float = 0.4
    came: float = 0.4
    body: float = 0.16
    still_s: float = 0.5
    fade_s: float = 5.0
    memory: float = 0.85
    stand_s: float = 5.0
    clutter: float = 0.2
    stride: float = 0.9
    leg: float = 0.1
    pace: float = 1.5
    merge: float = 0.35
    own: float = 0.6
    near: float = 0.2
    indifferent: float = 4.5
    affinity: tuple[float, float] = (-3.0, 2.0)
    begin: float = -1.0
    tentative_s: float = 0.5

    def __post_init__(self) -> None:
        check_numbers(self)
        above_zero = (
            "least_way",
            "least_pace",
            "vague",
            "told",
            "leg",
            "pace",
            "body",
            "clutter",
            "stride",
            "merge",
            "own",
            "near",
            "unknown",
        )
        check_positive(self, *above_zero, "still_s", "fade_s", "tentative_s")
