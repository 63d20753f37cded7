import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.logs.scans_npz import read_scans_npz

GOOD = {
    "ranges": np.arange(1.0, 13.0).reshape(3, 4),
    "angle_min": -0.2,
    "angle_increment": 0.1,
    "range_min": 0.5,
    "range_max": 10.0,
    "bag_time": np.array([7.0, 7.1, 7.3]),
}


def test_scans_have_their_bearings_limits_and_times_from_the_first_on(tmp_path):
    np.savez(tmp_path / "s.npz", **GOOD)
    scans = read_scans_npz(tmp_path / "s.npz")
    assert [scan.ranges.tolist() for scan in scans] == GOOD["ranges"].tolist()
    np.testing.assert_allclose(scans[2].bearings, [-0.2, -0.1, 0.0, 0.1], atol=1e-12)
    np.testing.assert_allclose([scan.time_s for scan in scans], [0.0, 0.1, 0.3])
    assert (scans[0].range_min, scans[0].range_max) == (0.5, 10.0)
    assert scans[2].is_return.tolist() == [True, True, False, False]


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("angle_min", [0.0, 1.0], "`angle_min` must be one finite number"),
        ("angle_min", np.nan, "`angle_min` must be one finite number"),
        ("angle_increment", -0.1, r"`angle_increment` must be positive \[rad\]"),
        ("range_max", np.inf, "`range_max` must be one finite number"),
        ("ranges", np.ones(4), r"`ranges` must have shape \(scans, beams\)"),
        ("bag_time", np.zeros(2), r"times must have shape \(3,\)"),
    ],
)
def test_what_makes_no_sense_is_named(tmp_path, name, value, message):
    np.savez(tmp_path / "s.npz", **{**GOOD, name: value})
    with pytest.raises(InputError, match=message):
        read_scans_npz(tmp_path / "s.npz")


def test_a_missing_array_and_another_kind_of_file_are_named(tmp_path):
    np.savez(tmp_path / "s.npz", **{name: value for name, value in GOOD.items() if name != "range_max"})
    with pytest.raises(InputError, match="missing: range_max"):
        read_scans_npz(tmp_path / "s.npz")
    (tmp_path / "s.npz").write_text("no archive")
    with pytest.raises(InputError, match=r"no \.npz file of scans"):
        read_scans_npz(tmp_path / "s.npz")
