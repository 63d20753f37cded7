"""People in recordings: known from when they were first seen, not from when they were first believed in."""

import numpy as np
import pytest
from halls import BeforeWall, scan_of, wall_from
from tagalong.perception import HindsightFilter, PeopleFilter, PeopleFilterConfig
from tagalong.perception.filtered_logs.log import LaserLine, _LineRemoval
from tagalong.perception.filtered_logs.scan_filter import FilterCounts
from tagalong.slam import InputError

RATE_HZ = 10.0
ODOMETRY = np.zeros(3)


@pytest.fixture
def past(scripted_detector, step):
    """Take a filter past somebody who comes into sight after a second, beside a post; return what it tells."""

    def take(people_filter_of, legs=False):
        detector = scripted_detector()
        people_filter = people_filter_of(BeforeWall(detector))
        told = []
        for k in range(40):
            centre = np.array([2.0, -2.0 + 0.1 * k])
            somebody = step(centre, (0.0, 1.0), k / RATE_HZ) if legs else centre[None]
            places = np.concatenate(([[1.5, 1.5]], somebody[: len(somebody) * (k >= 10)]))
            detector.positions, detector.confidence = (
                places,
                np.array([0.05, *[0.9 if legs else 0.3] * len(places[1:])]),
            )
            filtered = people_filter.update(scan_of(places, k / RATE_HZ, wall=wall_from(ODOMETRY)), ODOMETRY)
            told += filtered if isinstance(filtered, list) else [filtered]
        return told + (people_filter.finish() if isinstance(people_filter, HindsightFilter) else [])

    return take


def counts_of(told):
    return [len(filtered.people) for filtered in told]


def test_who_is_believed_in_later_was_there_from_the_first_scan_on(past):
    live = past(lambda detector: PeopleFilter(detector=detector))
    late = past(lambda detector: HindsightFilter(detector=detector))
    assert counts_of(live)[10:13] == [0, 0, 0]
    assert counts_of(late) == [0] * 10 + [1] * 30
    assert [filtered.scan.time_s for filtered in late] == [filtered.scan.time_s for filtered in live]
    assert {int(number) for filtered in late for number in filtered.people.ids} == {0}
    assert late[10].people.positions[0] == pytest.approx([2.0, -1.0], abs=0.3)
    assert late[10].people.confidence[0] > 0.9
    legs = np.hypot(*(late[10].scan.beam_points - [2.0, -1.0]).T) < 0.2
    assert legs.any()
    assert late[10].removed[legs].all()
    for before, after in zip(live[20:], late[20:], strict=True):  # who is known stays as it was
        assert before.people.positions.tobytes() == after.people.positions.tobytes()
        assert (before.removed == after.removed).all()


def test_who_is_gone_again_before_the_lag_is_over_was_there_all_the_same(scripted_detector):
    detector = scripted_detector()
    people_filter, told = HindsightFilter(detector=BeforeWall(detector), lag_s=3.0), []
    for k in range(60):
        places = np.array([[2.0, -1.0 + 0.15 * k]])[: k < 12]
        detector.positions, detector.confidence = places, np.full(len(places), 0.3)
        told += people_filter.update(scan_of(places, k / RATE_HZ, wall=wall_from(ODOMETRY)), ODOMETRY)
    told += people_filter.finish()
    assert counts_of(told)[:12] == [1] * 12
    assert counts_of(told)[20:] == [0] * 40


def test_without_a_lag_nothing_changes(past):
    live = past(lambda detector: PeopleFilter(detector=detector))
    late = past(lambda detector: HindsightFilter(detector=detector, lag_s=0.0))
    for before, after in zip(live, late, strict=True):
        assert before.people.ids.tolist() == after.people.ids.tolist()
        assert before.people.legs.tobytes() == after.people.legs.tobytes()
        assert before.people.seen_legs.confidence.tobytes() == after.people.seen_legs.confidence.tobytes()


def test_a_short_lag_knows_only_what_was_known_by_then(past):
    live, late = (past(lambda detector, lag=lag: HindsightFilter(detector=detector, lag_s=lag)) for lag in (0.0, 0.2))
    first = counts_of(live).index(1)
    assert counts_of(late).index(1) == first - 2


def test_scans_come_out_when_their_time_has_come_and_the_rest_at_the_end(scripted_detector):
    people_filter = HindsightFilter(detector=scripted_detector(), lag_s=0.5)
    due = [people_filter.update(scan_of((), 0.1 * k), ODOMETRY) for k in range(8)]
    assert [[round(10 * one.scan.time_s) for one in some] for some in due] == [[], [], [], [], [], [0], [1], [2]]
    assert [round(10 * one.scan.time_s) for one in people_filter.finish()] == [3, 4, 5, 6, 7]
    assert people_filter.finish() == []


def test_the_papers_tracker_has_no_hindsight(past):
    config = PeopleFilterConfig(method="ye2021")
    live = past(lambda detector: PeopleFilter(config, detector), legs=True)
    late = past(lambda detector: HindsightFilter(config, detector), legs=True)
    assert max(counts_of(live)) == 1
    assert counts_of(late) == counts_of(live)


@pytest.mark.parametrize("lag_s", [-0.1, np.nan, np.inf])
def test_a_lag_that_is_none_is_refused(lag_s):
    with pytest.raises(InputError, match="`lag_s` must be 0 or more"):
        HindsightFilter(lag_s=lag_s)


def test_a_laser_that_falls_silent_does_not_hold_up_the_lines_of_another():
    removal = _LineRemoval(PeopleFilterConfig(), FilterCounts())
    lines = [
        LaserLine(b"", "FLASER" if k else "ROBOTLASER1", scan_of((), 0.1 * k), ODOMETRY, np.arange(768), 768)
        for k in range(1100)
    ]
    for line in lines:
        removal.take(line)
    assert all(line.removed is not None for line in lines[:1080])
    assert lines[-1].removed is None
    removal.rest()
    assert all(line.removed is not None for line in lines)
