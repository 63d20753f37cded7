"""How the planner draws plans and what it minds; every number with its unit and its reason."""

from dataclasses import dataclass, field

from ...slam.bounds import check_positive
from ...slam.errors import InputError
from ..learned.steering import SteeringConfig
from ..scripted.leader_memory import MemoryConfig


@dataclass(frozen=True, kw_only=True)
class PriceConfig:
    """What a plan costs. Who stays 1 m too far from the leader all the time pays 1; all others are measured by that.

    The weights were chosen on drives of hard cells with seeds below those of the suites; the page of the method tells
    what each of them mends.

    Attributes:
        keep: Way kept to the leader, centre to centre [m]; a little less than the wanted 1.3 m, since a leader who
            walks is always some tenths ahead of its prediction, and who leaves a gap in a crowd is cut off.
        way: Weight of a way that is too long or, half as much again, too short; mean over the plan [1/m].
        end: The same at the end of the plan [1/m]: what is beyond it goes on from there.
        facing: Of looking away from the leader, mean over the plan: 0 ahead, 1 behind. Behind, the laser is blind.
        sight: Of a leader who is hidden at one of three moments.
        tight: Of having no gap to things.
        comfort: Gap to things beyond which they cost nothing [m]; a door of 0.9 m leaves a Dingo 0.19 m on each side.
        people: Of a contact that is certain and at the robot's charge; more than a plan can gain by any way, 3.9 m
            shorter at most.
        space: Of touching somebody's personal space (0.45 m, as in the reward), squared.
        person_radius: Radius of a body [m].
        spread: Deviation of where a person is said to be [m]; that of tracks of walkers in a crowd.
        spread_rate: By how much it grows with the time ahead [m/s]: people change their velocity by so much in the
            second or two that are planned.
        touch: Of touching a thing; as `people`.
        still: For so long people are taken to be where the laser met them, too [s]: tracks lag behind who turns.
        effort: Of jerk, mean square [s^6/m^2]; 2.5 m/s^3 RMS, PID's, costs 0.25.
        turning: Of the jerk of turning against that [m^2]; 0.5 m, about the robot's size, to the square.
        back: Of backing over what was never seen [1/m].
        unseen: What it is worth to bring much new ground into sight of the laser; 0 for a follower who knows no map.
    """

    keep: float = 1.2
    way: float = 1.0
    end: float = 0.5
    facing: float = 0.6
    sight: float = 0.7
    tight: float = 0.8
    comfort: float = 0.25
    people: float = 10.0
    space: float = 0.3
    person_radius: float = 0.22
    spread: float = 0.1
    spread_rate: float = 0.2
    touch: float = 10.0
    still: float = 0.4
    effort: float = 0.04
    turning: float = 0.3
    back: float = 10.0
    unseen: float = 0.0

    def __post_init__(self) -> None:
        check_positive(self, "keep", "comfort", "person_radius", "spread")
        for name, value in self.__dict__.items():
            if not value >= 0.0:
                raise InputError(f"`{name}` of the plan's prices must not be negative, got {value}")


@dataclass(frozen=True, kw_only=True)
class MPPIConfig:
    """How plans are drawn, driven and weighed.

    Attributes:
        horizon_s: How far ahead is planned [s]: at 1.3 m/s the way that the laser sees between people in a crowd.
        knots: Wishes of a plan, in straight lines between them: one every 0.5 s, about what the steering can follow.
        samples: Plans drawn around the last one in each step.
        speed_noise: Deviation of the drawn wishes [m/s].
        turn_noise: Likewise [rad/s].
        temperature: A plan that costs so much more than the best counts 1/e of it (lambda of Williams et al.).
        evaluations: At so many moments of a plan its place is judged, every 0.2 s.
        reach: Things farther away than this do not matter [m]: the horizon's way.
        remembered_s: For how long things are remembered that are not in sight [s]: odometry drifts.
        walking: Who is faster than this walks and is no thing [m/s]; tracks of who stands move by up to 0.2 m/s.
        body: Returns nearer to a person who walks are that person [m]: a body and half a step.
        seed: Of the draws.
        prices: What plans cost.
        steering: How wishes are driven: as the learned follower's, but that speed settles in 0.5 s, so that what is
            drawn anew in each step does not reach the wheels.
        memory: What it does when the leader is lost.
    """

    horizon_s: float = 3.0
    knots: int = 7
    samples: int = 256
    speed_noise: float = 0.3
    turn_noise: float = 0.4
    temperature: float = 0.05
    evaluations: int = 15
    reach: float = 4.0
    remembered_s: float = 10.0
    walking: float = 0.25
    body: float = 0.4
    seed: int = 0
    prices: PriceConfig = field(default_factory=PriceConfig)
    steering: SteeringConfig = field(default_factory=lambda: SteeringConfig(settle_s=0.5))
    memory: MemoryConfig = field(default_factory=lambda: MemoryConfig(predicted=True))

    def __post_init__(self) -> None:
        check_positive(self, "horizon_s", "samples", "temperature", "reach", "remembered_s", "body")
        if not (self.knots >= 2 and 5 <= self.evaluations <= 100 and self.samples <= 10_000):
            got = f"{self.knots}, {self.evaluations}, {self.samples}"
            raise InputError(f"a plan needs 2 `knots`, 5 to 100 `evaluations` and at most 10000 `samples`, got {got}")


MAPPING = MPPIConfig(prices=PriceConfig(unseen=2.0))
"""Of the follower "mapper", which brings home more of the building."""
