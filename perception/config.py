"""Every number of the perception, in one frozen configuration: the paper's Table II and what the paper leaves open."""

from dataclasses import dataclass, fields
from typing import Annotated

from ..slam.bounds import Share, Within, check_numbers
from ..slam.errors import InputError, unknown_name
from .legs.detector import LegDetectorConfig


@dataclass(frozen=True, kw_only=True)
class PerceptionConfig:
    """Numbers of clusters, leg detector, tracker and people filter.

    The first block is Table II of Ye 2021; `q` and the gain of eq. 6 are meant for one scan at `reference_rate_hz` and
    scale with the time between two scans. The second block is ours: what the paper needs and does not print.

    Attributes:
        alpha: Largest gap between neighbouring points of one cluster [m].
        beta: Fewest points of a cluster.
        far_width: Where a leg of this width gets fewer than `beta` beams, as many as it gets are enough, but at least
            2; 0 asks for `beta` at any distance, as the paper does [m].
        gamma: A cluster is a leg detection from this forest confidence on, and a leg track starts a person only from
            this confidence (eq. 6) on, in [0, 1].
        delta: Both legs must have moved this far, in the mean of the two, before they start a person [m].
        epsilon: A track ends when the first element of its covariance exceeds this [m^2].
        zeta: The filter drops points this close to a person or one of its legs [m].
        suspect_radius: So does the environment with points this close to what looks like a leg and may be that of
            somebody who has not moved delta yet; 0 writes them into the map, as the paper does [m].
        suspect_confidence: From this confidence a cluster looks like a leg for that.
        c_min: A track ends when its confidence falls below this, in [0, 1].
        q: Process noise, Q = q I per reference period [m^2, (m/s)^2].
        r: Measurement noise, R = r I [m^2].
        reference_rate_hz: Scan rate for which `q` and `confidence_gain` are stated [1/s]. The paper prints none; at
            5 Hz a person survives a full occlusion of one second under Table II's epsilon (at 10 Hz: 0.7 s).
        initial_variance: P0 = this times I (eq. 5b) [m^2, (m/s)^2].
        confidence_gain: Weight of a new detection's confidence (eq. 6, 0.05).
        gate: Largest distance between a leg track and its detection, at a very high scan rate [m].
        gate_speed: How much the gate grows with the time since the leg was last seen: a swinging foot overtakes its
            person [m/s].
        gate_most: It grows no larger than this [m].
        gate_anchor_s: For this long after it was seen, a leg is looked for where it was seen as well as where it was
            predicted: feet stop and start between two scans [s].
        reach: Largest distance between a person's predicted centre and one of its legs [m].
        left_behind: Nothing may stand any more within this distance of where a leg that moved began [m].
        one_leg_variance: Added to `r` where one leg measures the centre [m^2].
        sure_confidence: Two leg tracks of at least this confidence (eq. 6) start a person when they moved `delta` in
            sum: one leg has stepped past the other. Between two things that a forest takes for legs less surely, such
            a step can be a confusion. One such leg alone starts a person when it moved twice `delta`, for both.
        start_unseen_s: A leg may be unseen for this long when its person starts [s].
        both_legs_from: A cluster wider than this can be both legs of a person known to be there [m].
        both_legs_to: And narrower than this [m].
        both_legs_gate: Largest distance between it and the person's predicted centre [m].
        both_legs_s: Longest time that a person is believed in without seeing a leg apart [s].
        pair_distance: Largest distance between the two legs that start a person [m].
        pair_width: Largest distance between them in the mean over `stride_time_s`, where steps cancel out [m].
        pair_margin: By how much narrower a pair must be for a person to exchange a leg [m].
        stride_time_s: How long that mean remembers [s].
        offset_time_s: How fast the believed offset of a hidden leg from its person's centre fades [s].
        coast_s: How fast the velocity of a lost person is believed to fade [s].
        memory_s: How long a lost person can be recognised [s].
        memory_least_s: Whoever was tracked for less than this is forgotten at once [s].
        memory_distance: Largest distance from the prediction at which a lost person is recognised [m].
        memory_overlap_s: How long the legs of a lost person may have been tracked anew before the old track was last
            seen: tracks overlap when a person is taken for two [s].
        meet_distance: Legs this close to where a lost person must be are its own without moving `delta` again [m].
        meet_age_s: When they have been tracked for this long [s].
        meet_alone_s: When only one leg of the lost person is seen, it must have been tracked for this long [s].
        doubt_s: A person of whom no leg was seen for this long may be the newcomer nearby [s].
        grid_resolution: Side of a cell of the local occupancy grid [m].
        grid_rise_s: Time under non-human points until a cell counts as occupied [s].
        grid_fade_s: How fast a cell that is no longer hit becomes free again [s].
        camera_gate: Largest distance between a person and where the camera saw it [m].
        camera_r: Measurement noise of the camera, R = camera_r I [m^2].
        camera_sure: From this likelihood on the camera can start a person, in [0, 1].
        camera_frames: After so many frames.
        camera_wait_s: Longest time between two of these frames [s].
        still_time_s: A leg track that never moved for this long, and is nobody's leg, marks the grid as not human [s].
    """

    alpha: float = 0.13
    beta: int = 3
    far_width: float = 0.0
    gamma: Share = 0.3
    delta: float = 0.5
    epsilon: float = 0.9
    zeta: float = 0.35
    suspect_radius: float = 0.1
    suspect_confidence: float = 0.5
    c_min: Share = 0.1
    q: float = 0.05
    r: float = 0.1

    reference_rate_hz: Annotated[float, Within(1e-3, 1e4)] = 5.0
    initial_variance: float = 0.05
    confidence_gain: Share = 0.05
    gate: float = 0.35
    gate_speed: float = 2.5
    gate_most: float = 0.8
    gate_anchor_s: float = 0.3
    reach: float = 0.8
    left_behind: float = 0.12
    one_leg_variance: float = 0.1
    sure_confidence: Share = 0.5
    start_unseen_s: float = 0.3
    both_legs_from: float = 0.15
    both_legs_to: float = 0.6
    both_legs_gate: float = 0.3
    both_legs_s: float = 3.0
    pair_distance: float = 0.9
    pair_width: float = 0.5
    pair_margin: float = 0.15
    stride_time_s: float = 1.0
    offset_time_s: float = 0.3
    coast_s: float = 1.0
    memory_s: float = 10.0
    memory_least_s: float = 5.0
    memory_distance: float = 3.0
    memory_overlap_s: float = 0.5
    meet_distance: float = 0.8
    meet_age_s: float = 0.2
    meet_alone_s: float = 0.4
    doubt_s: float = 1.0
    grid_resolution: Annotated[float, Within(0.01, 100.0)] = 0.05
    grid_rise_s: float = 0.3
    grid_fade_s: float = 3.0
    still_time_s: float = 3.0
    camera_gate: float = 0.6
    camera_r: float = 0.05
    camera_sure: Share = 0.7
    camera_frames: int = 3
    camera_wait_s: float = 1.5

    def __post_init__(self) -> None:
        check_numbers(self)
        for field in fields(self):
            value = getattr(self, field.name)
            if not (value > 0 or (field.name in ("far_width", "suspect_radius") and value == 0)):
                raise InputError(f"`{field.name}` must be positive, got {value}")
        for name in ("gamma", "c_min", "confidence_gain", "sure_confidence", "camera_sure"):
            if getattr(self, name) >= 1.0:
                raise InputError(f"`{name}` must be below 1, got {getattr(self, name)}")

    def detector(self) -> LegDetectorConfig:
        """Return the numbers of the leg detector among these."""
        return LegDetectorConfig(alpha=self.alpha, beta=self.beta, gamma=self.gamma, far_width=self.far_width)

    def process_variance(self, dt: float) -> float:
        """Return the diagonal of Q for `dt` seconds: q at the reference rate, proportional to time."""
        return self.q * dt * self.reference_rate_hz

    def confidence_weight(self, dt: float) -> float:
        """Return the gain of eq. 6 for `dt` seconds, so that its memory lasts equally long at any scan rate."""
        return 1.0 - (1.0 - self.confidence_gain) ** (dt * self.reference_rate_hz)


PRESETS: dict[str, PerceptionConfig] = {
    "table2": PerceptionConfig(),
    "outdoor": PerceptionConfig(gamma=0.35, epsilon=2.0, memory_s=60.0, memory_distance=6.0),
}
"""Named configurations.

`table2`: the paper's numbers.
`outdoor`: a robot without odometry that follows one person. Its frame moves with it, so that what stands moves too, and
more confidence is asked of a leg (`gamma`); a turn of the robot throws the person across the view (`memory_distance`)
and out of it (`memory_s`); thin legs in coarse beams are missed for longer (`epsilon`).
"""


def perception_preset(name: str) -> PerceptionConfig:
    """Return the configuration called `name`.

    Raises:
        InputError: If there is no such preset.
    """
    if name not in PRESETS:
        raise unknown_name("preset", name, tuple(PRESETS))
    return PRESETS[name]
