"""A drive is cut where the robot got lost: what is known of each segment, and of the scans between nodes."""

import numpy as np
import pytest
from tagalong.slam.geometry import between, compose
from tagalong.slam.graph.local.local_slam import LocalResult
from tagalong.slam.graph.loops.between_nodes import between_nodes
from tagalong.slam.graph.loops.constraints import Constraint, Kind
from tagalong.slam.graph.loops.drive_record import DriveRecord
from tagalong.slam.graph.loops.drive_segments import DriveSegments
from tagalong.slam.graph.loops.global_config import GlobalSlamConfig
from tagalong.slam.graph.loops.loop_schedule import LoopSchedule
from tagalong.slam.graph.loops.trimming import Renumbering
from tagalong.slam.scan import LaserScan
from tagalong.slam.scan_to_grid.scan_matcher import GridMatch

SCAN = LaserScan(np.ones(3), np.arange(3.0), 0.0, 2.0)


def segments(kidnapped):
    """Return three nodes and two submaps, then a segment of the last node and two more, with one submap."""
    made = DriveSegments()
    for _ in range(2):
        made.add_submap()
    for _ in range(3):
        made.add_node()
    made.begin(disowned=1, kidnapped=kidnapped)
    made.add_submap()
    for _ in range(2):
        made.add_node()
    return made


@pytest.mark.parametrize("kidnapped", [False, True])
def test_nodes_of_a_new_segment_have_no_place_until_it_is_placed(kidnapped):
    made = segments(kidnapped)
    assert made.placed_nodes.tolist() == [True, True, False, False, False]
    assert made.placed_submaps.tolist() == [True, True, False]
    made.place_current()
    assert made.placed_nodes.tolist() == [True, True, False, True, True]  # the disowned one stays apart
    assert (made.current_nodes(), made.current_submaps()) == ([3, 4], [2])


def test_after_a_gap_nodes_are_mapped_where_the_odometry_has_them_and_after_a_kidnapping_not():
    assert segments(kidnapped=False).mappable_nodes.all()
    assert segments(kidnapped=True).mappable_nodes.tolist() == [True, True, False, False, False]


def test_a_node_is_related_to_the_submaps_of_its_segment_and_once_that_is_placed_to_all():
    made = segments(kidnapped=True)
    assert made.related(0).tolist() == [True, True, False]
    assert made.related(4).tolist() == [False, False, True]
    made.place_current()
    assert made.related(0).all()
    assert made.related(4).all()


def test_segments_forget_what_has_left_the_graph():
    made = segments(kidnapped=True)
    made.renumber(Renumbering(np.array([False, True, True, True, True]), np.array([False, True, True])))
    assert made.placed_nodes.tolist() == [True, False, False, False]
    assert (made.current_nodes(), made.current_submaps()) == ([2, 3], [1])


def test_scans_between_nodes_are_interpolated_but_not_across_the_begin_of_a_segment():
    local = np.stack((np.arange(9.0), np.zeros(9), np.zeros(9)), axis=-1)
    nodes, poses = np.array([0, 4, 8]), np.array([[0.0, 0.0, 0.0], [4.4, 0.0, 0.0], [108.0, 0.0, 0.0]])
    path = between_nodes(local, nodes, poses, [6])
    np.testing.assert_allclose(path[:, 0], [0.0, 1.1, 2.2, 3.3, 4.4, 5.4, 106.0, 107.0, 108.0])
    np.testing.assert_array_equal(path[nodes], poses)


def test_local_motion_is_kept_between_nodes():
    local = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.5), (1.5, 0.5, 1.0)])
    turned = compose(np.array([3.0, -2.0, 2.0]), local)
    path = between_nodes(local, np.array([0, 2]), turned[[0, 2]], [])
    np.testing.assert_allclose(between(turned, path), 0.0, atol=1e-12)


def result(x, inconsistent=False, matched=0.0):
    match = GridMatch(np.array([matched, 0.0, 0.0]), np.eye(3), 0.5, False)
    return LocalResult(np.array([x, 0.0, 0.0]), match, None, inconsistent, np.ones(2) if inconsistent else None)


def test_inconsistent_scans_stand_where_they_were_matched_once_scans_are_consistent_again():
    for new_segment, expected in ((False, [0.0, 1.5, 2.5, 3.0]), (True, [0.0, 1.0, 2.0, 3.0])):
        record = DriveRecord()
        record.append(result(0.0))
        record.append(result(1.0, inconsistent=True, matched=1.5))
        record.append(result(2.0, inconsistent=True, matched=2.5))
        assert record.local_trajectory()[:, 0].tolist() == [0.0, 1.0, 2.0]
        if new_segment:
            record.begin_segment(1)
        record.append(result(3.0))
        assert record.local_trajectory()[:, 0].tolist() == expected


def test_a_record_counts_the_nodes_since_a_scan():
    record = DriveRecord()
    for k in range(6):
        if k % 2 == 0:
            record.add_node(SCAN)
        record.append(result(float(k)))
    assert record.nodes == [0, 2, 4]
    assert [record.nodes_since(first) for first in (0, 1, 2, 3, 5)] == [3, 2, 2, 1, 0]


def test_submaps_that_were_tied_lately_are_tracked_and_the_others_searched_one_after_the_other():
    schedule = LoopSchedule(GlobalSlamConfig(known_for=20, search_every=0.4))
    schedule.note(Constraint(1, 90, np.zeros(3), np.eye(3), Kind.INTER), last_own_node=12)
    tracked, waiting = schedule.split([0, 1, 2, 7], node=100, own_submap=9)
    assert (tracked, waiting) == ([1, 7], [0, 2])
    assert schedule.split([1], node=111, own_submap=9) == ([], [1])
    asked = [schedule.next_search(waiting, node, 0.2) for node in range(100, 105)]
    assert asked == [0, None, 2, None, 0]
    assert schedule.returned_at == 0
    schedule.optimised()
    assert schedule.returned_at == 90
