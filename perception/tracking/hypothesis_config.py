"""Every number of `HypothesisTracker`, one node for each of its parts."""

from dataclasses import dataclass, field

from ...slam.bounds import check_numbers, check_positive
from ..legs.recent_views import RecentViewsConfig


@dataclass(frozen=True, kw_only=True)
class PersonEvidenceConfig:
    """How surely what is seen is a person: log odds, linear in what several looks show.

    The log odds of a hypothesis are `prior` + n / (1 + `alike` (n - 1)) times the mean over its n looks of `base` +
    `vote` L + `second` S + `empty` E: L is the log odds of the forest of its better leg, S that of the other leg above
    `second_from`, E the share of recent scans in which the place was empty. The five weights are a logistic regression
    (`alike` by likelihood from 0.3, 0.6, 0.9) on hypotheses of 48 drawn drives and of the recordings positive_1 to 3,
    negative_2 and demo_stationary, with forests that had not seen them; none of a moving robot among people, and none
    from outdoors. Written for the confidence of the shipped forest for real scans: the fit was to its votes
    before they are weighed by its odds (0.485).

    Attributes:
        prior: Log odds before the first look.
        base: Of a look.
        vote: Weight of the forest's log odds.
        second: Of those of the other leg.
        second_from: Log odds of the forest from which another leg speaks for a person.
        empty: Weight of the share of recent scans in which the place was empty.
        alike: Intraclass correlation of looks at one thing: a thing looks like itself again.
        most_looks: No more are remembered.
        look: Motion relative to the laser that gives a new look: what stands before a standing robot shows nothing new,
            however often [m].
        jitter: Less motion than this is noise [m].
        hidden_rate: Log odds lost a second while unseen [1/s].
        missing_rate: The same where the laser sees that nobody is there [1/s].
    """

    prior: float = -7.07
    base: float = 6.15
    vote: float = 0.67
    second: float = 2.02
    second_from: float = -2.2
    empty: float = 3.28
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
        start: Log odds from which a hypothesis is a person (4.5 to 1).
        sure: And has moved `least_way`, unless its log odds are as high as this (20 to 1).
        stop: Log odds below which a person is none any more (evens).
        least_way: As far as a leg must move in Table II (delta) [m].
        clutter: Things that could be legs, a square metre.
        stride: Farthest that two legs of one person are apart [m].
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
    start: float = 1.5
    sure: float = 3.0
    stop: float = 0.0
    least_way: float = 0.5
    clutter: float = 0.2
    stride: float = 0.9
    merge: float = 0.35
    own: float = 0.6
    near: float = 0.2
    indifferent: float = 4.5
    affinity: tuple[float, float] = (-3.0, 2.0)
    begin: float = -1.0
    tentative_s: float = 0.5

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "least_way", "clutter", "stride", "merge", "own", "near", "tentative_s")
