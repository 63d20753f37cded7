"""People by laser, camera and both, by the environment's own onboard stack."""

import pytest
from tagalong.scripts.benchmarks import people_by_sensor


def test_laser_and_camera_together_know_those_who_never_move():
    judges = people_by_sensor.drive(101, 3.0)
    rows = {name: people_by_sensor.figures([judge]) for name, judge in judges.items()}
    assert rows["both"]["mota_in_view"].mean >= max(rows["laser"]["mota_in_view"].mean, 0.5)
    assert rows["camera"]["mota_in_view"].mean > 0.5
    assert judges["both"].in_view.truths == judges["laser"].in_view.truths > 10


def test_a_row_adds_up_the_drives_and_its_interval_is_theirs():
    drives = [people_by_sensor.SensorJudge() for _ in range(2)]
    for judge, (of, removed) in zip(drives, ((100, 50), (300, 300)), strict=True):
        judge.people[:] = of, removed
    row = people_by_sensor.figures(drives)
    assert row["removed_people"].mean == pytest.approx(350 / 400)
    assert row["removed_people"].n == 2
    half = 12.706 * 0.25  # Student's quantile with one degree of freedom, standard error of 0.5 and 1
    assert row["removed_people"].high - row["removed_people"].mean == pytest.approx(half, rel=1e-3)
