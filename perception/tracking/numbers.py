"""Numbers of `TrackerConfig` as kernels take them: one row of floats with names."""

from dataclasses import fields
from typing import Any, NamedTuple

from ...slam.view_kernel import as_record, inner_kernel
from .config import TrackerConfig


class Numbers(NamedTuple):
    """See `TrackerConfig`: each is named after its node there and its field."""

    motion_q: float
    motion_r: float
    motion_one_leg_variance: float
    motion_initial_variance: float
    motion_reference_rate_hz: float
    motion_coast_s: float
    association_clutter: float
    association_stride: float
    association_leg: float
    association_pace: float
    association_near: float
    association_indifferent: float
    association_least: float
    association_most: float
    association_offset_s: float
    evidence_prior: float
    evidence_base: float
    evidence_vote: float
    evidence_second: float
    evidence_second_from: float
    evidence_empty: float
    evidence_moved: float
    evidence_alike: float
    evidence_most_looks: float
    evidence_look: float
    evidence_jitter: float
    evidence_hidden_rate: float
    evidence_missing_rate: float
    evidence_body: float
    evidence_unknown: float
    evidence_came: float
    evidence_least_way: float
    evidence_least_pace: float
    views_spacing_s: float
    views_radius: float
    views_margin: float
    frame_points: float
    frame_memory_s: float
    frame_doubt: float
    existence_begin: float
    existence_start: float
    existence_again: float
    existence_stop: float
    existence_stand_s: float
    existence_memory: float
    existence_vague: float
    existence_told: float
    existence_merge: float
    existence_own: float
    existence_tentative_s: float
    reidentification_known_s: float
    reidentification_max_age_s: float
    reidentification_distance: float
    reidentification_step: float
    reidentification_overlap_s: float
    things_resolution: float
    things_still_s: float
    things_forget_s: float
    things_clearance: float
    camera_gate: float
    camera_r: float


def numbers_of(config: TrackerConfig) -> Numbers:
    """Return the numbers of `config`."""
    nodes: list[Any] = [(node.name, getattr(config, node.name)) for node in fields(config)]
    named = {f"{name}_{key}": value for name, node in nodes for key, value in vars(node).items()}
    return as_record(Numbers(**{name: float(named[name]) for name in Numbers._fields}))


@inner_kernel
def process_variance(c, dt):
    """Return the diagonal of Q for `dt` seconds, as `MotionConfig.process_variance`."""
    return c.motion_q * dt * c.motion_reference_rate_hz
