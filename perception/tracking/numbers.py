"""Numbers of `TrackerConfig` as kernels take them: one row of floats with names."""

from typing import NamedTuple

from ...slam.view_kernel import as_record, inner_kernel
from .config import TrackerConfig


class Numbers(NamedTuple):
    """See `TrackerConfig`: each is named after its node there and its field."""

    motion_q: float
    motion_r: float
    motion_one_leg_variance: float
    motion_initial_variance: float
    motion_reference_rate_hz: float
    motion_confidence_gain: float
    motion_coast_s: float
    gating_gate: float
    gating_gate_speed: float
    gating_gate_max: float
    gating_anchor_s: float
    gating_reach: float
    pairing_distance: float
    pairing_width: float
    pairing_margin: float
    pairing_stride_s: float
    pairing_offset_s: float
    merged_legs_width_min: float
    merged_legs_width_max: float
    merged_legs_gate: float
    merged_legs_duration_s: float
    confirmation_delta: float
    confirmation_gamma: float
    confirmation_sure_confidence: float
    confirmation_origin_radius: float
    confirmation_unseen_s: float
    termination_epsilon: float
    termination_c_min: float
    reidentification_max_age_s: float
    reidentification_known_s: float
    reidentification_distance: float
    reidentification_overlap_s: float
    reidentification_near: float
    reidentification_near_age_s: float
    reidentification_one_leg_age_s: float
    reidentification_unseen_s: float
    grid_resolution: float
    grid_rise_s: float
    grid_fade_s: float
    grid_still_s: float
    grid_clearance: float


_NODES = "motion", "gating", "pairing", "merged_legs", "confirmation", "termination", "reidentification", "grid"


def numbers_of(config: TrackerConfig) -> Numbers:
    """Return the numbers of `config`."""
    named = {f"{node}_{name}": value for node in _NODES for name, value in vars(getattr(config, node)).items()}
    return as_record(Numbers(**{name: float(named[name]) for name in Numbers._fields}))


@inner_kernel
def process_variance(c, dt):
    """Return the diagonal of Q for `dt` seconds, as `MotionConfig.process_variance`."""
    return c.motion_q * dt * c.motion_reference_rate_hz


@inner_kernel
def confidence_weight(c, dt):
    """Return the gain of eq. 6 for `dt` seconds, as `MotionConfig.confidence_weight`."""
    return 1.0 - (1.0 - c.motion_confidence_gain) ** (dt * c.motion_reference_rate_hz)
