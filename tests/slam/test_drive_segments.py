"""A drive is cut where the robot got lost: what is known of each segment, and of the scans between nodes."""

import numpy as np
from tagalong.slam.geometry import between, compose
from tagalong.slam.graph.loops.between_nodes import between_nodes
from tagalong.slam.graph.loops.drive_record import DriveRecord
from tagalong.slam.graph.loops.drive_segments import DriveSegments
from tagalong.slam.graph.loops.trimming import Renumbering
from tagalong.slam.scan import LaserScan

SCAN = LaserScan(np.ones(3), np.arange(3.0), 0.0, 2.0)


def segments():
    """Return three nodes and two submaps, the last node taken back, and then a segment of two nodes and one submap."""
    made = DriveSegments()
    for _ in range(2):
        made.add_submap()
    for _ in range(3):
        made.add_node()
    made.begin(nodes=2, submaps=2)
    made.add_submap()
    for _ in range(2):
        made.add_node()
    return made


def test_nodes_of_a_new_segment_have_no_place_until_it_is_placed():
    made = segments()
    assert made.placed_nodes.tolist() == [True, True, False, False]
    assert made.placed_submaps.tolist() == [True, True, False]
    made.place_current()
    assert made.placed_nodes.all()
    assert (made.current_nodes(), made.current_submaps()) == ([2, 3], [2])


def test_a_node_is_related_to_the_submaps_of_its_segment_and_once_that_is_placed_to_all():
    made = segments()
    assert made.related(0).tolist() == [True, True, False]
    assert made.related(3).tolist() == [False, False, True]
    made.place_current()
    assert made.related(0).all()
    assert made.related(3).all()


def test_segments_forget_what_has_left_the_graph():
    made = segments()
    made.renumber(Renumbering(np.array([False, True, True, True]), np.array([False, True, True])))
    assert made.placed_nodes.tolist() == [True, False, False]
    assert (made.current_nodes(), made.current_submaps()) == ([1, 2], [1])


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


def test_a_record_takes_scans_back_and_begins_a_segment():
    record = DriveRecord()
    for k in range(6):
        if k % 2 == 0:
            record.add_node(SCAN)
        record.append(np.array([float(k), 0.0, 0.0]))
    assert record.nodes == [0, 2, 4]
    record.rewind(3)
    assert (len(record), record.nodes, len(record.scans)) == (3, [0, 2], 2)
    record.add_node(SCAN)
    record.append(np.array([9.0, 0.0, 0.0]))
    assert record.nodes == [0, 2, 3]
    nodes = np.array([[0.0, 0.0, 0.0], [2.5, 0.0, 0.0], [50.0, 0.0, 0.0]])
    np.testing.assert_allclose(record.trajectory(nodes, np.zeros((0, 3)))[:, 0], [0.0, 1.25, 2.5, 50.0])
