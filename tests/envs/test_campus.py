"""Drawn campus corridors that look alike."""

import numpy as np
from tagalong.envs.simulation2d.campus import draw_campus_drive


def test_a_campus_is_the_same_for_one_seed_and_its_drive_stays_in_the_corridors():
    drive, again = draw_campus_drive(120.0, 300.0, 3), draw_campus_drive(120.0, 300.0, 3)
    assert drive.truth.tobytes() == again.truth.tobytes()
    assert drive.odometry.tobytes() == again.odometry.tobytes()
    steps = np.hypot(*np.diff(drive.truth[:, :2], axis=0).T)
    assert steps.sum() > 290.0
    nearest, count = np.inf, 0
    for scan, other in zip(drive.scans(), again.scans(), strict=True):
        assert scan.ranges.tobytes() == other.ranges.tobytes()
        nearest, count = min(nearest, scan.ranges.min()), count + 1
        if count == 400:
            break
    assert nearest > 0.3
    assert len(drive) > 2000


def test_corridors_of_a_campus_are_closed_and_all_of_them_can_be_reached():
    for seed in range(4):
        campus = draw_campus_drive(200.0, 50.0, seed).campus
        reached, ahead = set(), {0}
        while ahead:
            reached |= ahead
            ahead = {int(b) for pair in (*campus.links, *campus.links[:, ::-1]) for a, b in [pair] if a in ahead}
            ahead -= reached
        assert reached == set(range(len(campus.junctions)))
        ends = np.round(campus.outlines.arrays()[1][:, :4].reshape(-1, 2), 6)
        assert (np.unique(ends, axis=0, return_counts=True)[1] >= 2).all()  # no wall ends in the open
