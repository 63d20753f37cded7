"""Figures of episodes with known answers."""

import numpy as np
import pytest
from tagalong.envs.metrics import episode_metrics
from tagalong.envs.metrics.following import leader_is_right, steady_steps
from tagalong.envs.metrics.history import History, run_lengths
from tagalong.envs.metrics.safety import time_to_collision
from tagalong.envs.metrics.smoothness import WINDOW_S, ldlj, sparc


def straight_drive(seconds=20.0, gap=1.3, rate=10.0, **changes):
    """A leader walks along x at 1 m/s, the robot `gap` behind; a bystander stands 2 m beside the start."""
    time = np.arange(0.0, seconds + 1e-9, 1.0 / rate)
    n = len(time)
    robot = np.stack((time, np.zeros(n), np.zeros(n)), axis=1)
    leader = np.stack((time + gap, np.zeros(n)), axis=1)
    bystander = np.tile([0.0, 2.0], (n, 1))
    no = np.zeros(n, dtype=bool)
    fields = {
        "time_s": time,
        "robot_pose": robot,
        "robot_velocity": np.tile([1.0, 0.0, 0.0], (n, 1)),
        "action": np.zeros((n, 2)),
        "reward": np.zeros(n),
        "reward_terms": {},
        "person_position": np.stack((leader, bystander), axis=1),
        "person_velocity": np.tile([[1.0, 0.0], [0.0, 0.0]], (n, 1, 1)),
        "leader_walking": ~no,
        "contact_person": no,
        "contact_static": no,
        "odometry": robot,
        "estimated_pose": robot,
        "leader_visible": ~no,
        "leader_id": np.zeros(n, dtype=np.int64),
        "leader_estimate": leader,
        "tracked_people": np.full(n, 2),
        "tour_done": no,
        "person_radius": np.full(2, 0.25),
        "robot_radius": 0.35,
        "leader_index": 0,
        "static_clearance": np.full(n, 1.0),
    }
    return History(**{**fields, **changes})


def test_a_constant_offset_is_the_distance_error():
    metrics = episode_metrics(straight_drive(gap=1.5))
    assert metrics["distance_error_rms_m"] == pytest.approx(0.2)
    assert metrics["distance_error_mean_m"] == pytest.approx(0.2)
    assert metrics["bearing_error_rms_rad"] == 0.0
    assert metrics["band_1_2_m_share"] == 1.0


def test_steps_before_three_seconds_and_steps_of_a_standing_leader_do_not_count():
    drive = straight_drive()
    far = drive.person_position.copy()
    walking = drive.leader_walking.copy()
    far[:30, 0, 0] += 5.0
    far[100:120, 0, 0] += 5.0
    walking[100:120] = False
    metrics = episode_metrics(straight_drive(person_position=far, leader_walking=walking))
    assert metrics["distance_error_rms_m"] == pytest.approx(0.0, abs=1e-12)


def test_times_that_differ_by_rounding_are_the_same():
    drive = straight_drive()
    for start in range(20, 170):
        ids = np.full(201, -1)
        ids[start : start + 11] = 7  # taken for a second, not for longer
        assert episode_metrics(straight_drive(leader_id=ids))["leader_choices"] == 0.0
    for first in range(170):
        walking = drive.leader_walking.copy()
        walking[:first] = False
        assert np.flatnonzero(steady_steps(straight_drive(leader_walking=walking)))[0] == first + 30


def test_a_leader_who_never_walks_has_no_distance_error():
    drive = straight_drive()
    assert np.isnan(episode_metrics(straight_drive(leader_walking=~drive.leader_walking))["distance_error_rms_m"])


def test_losses_are_gaps_longer_than_a_second():
    visible = np.ones(201, dtype=bool)
    visible[:10] = False
    visible[50:55] = False
    visible[100:120] = False
    visible[190:] = False
    metrics = episode_metrics(straight_drive(leader_visible=visible))
    assert (metrics["losses"], metrics["reacquired"]) == (2.0, 1.0)
    assert metrics["reacquire_s"] == pytest.approx(2.0)
    assert metrics["leader_visible_share"] == pytest.approx((191 - 5 - 20 - 11) / 191)


def test_taking_the_bystander_for_the_leader_is_a_wrong_choice():
    drive = straight_drive()
    ids = np.zeros(201, dtype=np.int64)
    ids[100:] = 7
    estimate = drive.leader_estimate.copy()
    estimate[100:] = [0.0, 2.0]
    wrong = straight_drive(leader_id=ids, leader_estimate=estimate)
    metrics = episode_metrics(wrong)
    assert (metrics["leader_choices"], metrics["leader_choices_right"]) == (2.0, 1.0)
    assert metrics["leader_right_share"] == pytest.approx(100 / 201)
    assert leader_is_right(wrong).sum() == 100


def test_distances_are_between_surfaces():
    metrics = episode_metrics(straight_drive())
    assert metrics["min_distance_leader_m"] == pytest.approx(1.3 - 0.6)
    assert metrics["min_distance_bystander_m"] == pytest.approx(2.0 - 0.6)
    assert metrics["min_distance_static_m"] == pytest.approx(0.65)
    assert metrics["personal_space_compliance"] == 1.0
    assert metrics["collision_free"] == 1.0


def test_contacts_count_as_intervals():
    touch = np.zeros(201, dtype=bool)
    touch[[5, 6, 7, 50]] = True
    metrics = episode_metrics(straight_drive(contact_static=touch))
    assert (metrics["contacts_static"], metrics["contacts_people"], metrics["collision_free"]) == (2.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("offset", "velocity", "expected"),
    [
        ([3.0, 0.0], [-1.0, 0.0], 2.0),
        ([3.0, 0.0], [1.0, 0.0], np.inf),
        ([3.0, 1.5], [-1.0, 0.0], np.inf),
        ([0.5, 0.0], [0.0, 0.0], 0.0),
        ([3.0, 0.0], [0.0, 0.0], np.inf),
    ],
)
def test_time_to_collision_of_two_circles(offset, velocity, expected):
    assert time_to_collision(np.array(offset), np.array(velocity), np.array(1.0)) == pytest.approx(expected)


@pytest.mark.parametrize("heading", [0.0, 2.0])
@pytest.mark.parametrize(("comes", "least", "below_2"), [(0.0, 1.45, 6 / 201), (1.0, 0.725, 26 / 201)])
def test_time_to_collision_counts_from_surface_to_surface_in_the_frame_of_the_world(heading, comes, least, below_2):
    drive = straight_drive()
    cos, sin = np.cos(heading), np.sin(heading)
    turn = np.array([[cos, sin], [-sin, cos]])
    pose = np.column_stack((drive.robot_pose[:, :2] @ turn, np.full(201, heading)))
    people, velocity = drive.person_position.copy(), drive.person_velocity.copy()
    people[:, 1], velocity[:, 1] = [22.05, 0.0], [-comes, 0.0]
    metrics = episode_metrics(
        straight_drive(robot_pose=pose, person_position=people @ turn, person_velocity=velocity @ turn)
    )
    assert metrics["min_ttc_s"] == pytest.approx(least)
    assert metrics["ttc_below_2s_share"] == pytest.approx(below_2)
    assert metrics["ttc_below_1s_share"] == pytest.approx(0.0 if comes == 0.0 else 6 / 201)


def test_smoothness_is_judged_on_whole_windows_only():
    drive = straight_drive(seconds=25.0)
    wavy = 1.0 + 0.1 * np.sin(2.0 * drive.time_s)
    velocity = np.column_stack((wavy, np.zeros((len(wavy), 2))))
    jerky = velocity.copy()
    jerky[-40:-10:2, 0] += 0.5
    windows = [episode_metrics(straight_drive(seconds=25.0, robot_velocity=v)) for v in (velocity, jerky)]
    cut = round(WINDOW_S * 10.0) * (len(wavy) // round(WINDOW_S * 10.0))
    assert cut <= len(wavy) - 40, "the rest of the drive is longer than what is jerky"
    for name in ("sparc", "ldlj"):
        assert windows[0][name] == windows[1][name]
    assert windows[0]["jerk_rms_mps3"] < windows[1]["jerk_rms_mps3"]


def test_sparc_and_ldlj_of_a_gaussian_speed_are_the_published_values():
    speed = np.exp(-5.0 * np.arange(-1.0, 1.0, 0.01) ** 2)
    assert sparc(speed, 100.0) == pytest.approx(-1.41403, abs=1e-5)
    assert ldlj(speed, 100.0) == pytest.approx(-5.81636, abs=1e-5)


def test_a_steady_drive_has_no_jerk_and_a_shaken_one_has_that_of_its_sine():
    still = episode_metrics(straight_drive())
    assert still["jerk_rms_mps3"] == pytest.approx(0.0, abs=1e-9)
    assert still["stops"] == 0.0
    assert still["path_length_m"] == pytest.approx(20.0)
    time = straight_drive().time_s
    shaken = np.zeros((201, 3))
    shaken[:, 0] = 1.0 + 0.1 * np.sin(2 * np.pi * 0.5 * time)
    expected = 0.1 * np.pi**2 / np.sqrt(2)
    assert episode_metrics(straight_drive(robot_velocity=shaken))["jerk_rms_mps3"] == pytest.approx(expected, rel=0.05)


def test_run_lengths_are_the_maximal_runs():
    assert run_lengths(np.array([1, 1, 0, 1, 0, 0, 1], dtype=bool)) == [(0, 2), (3, 4), (6, 7)]
    assert run_lengths(np.zeros(3, dtype=bool)) == []


def test_a_history_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        straight_drive().robot_pose[0] = 1.0
