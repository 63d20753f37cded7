"""Which submaps are well placed, so that a match suffices, and when those that are not are searched for."""

from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.slam.graph.loops.constraints import Constraint, Kind
from tagalong.slam.graph.loops.search_interval import SearchInterval
from tagalong.slam.graph.loops.submap_links import SubmapLinks
from tagalong.slam.pose_log import PoseLog

# a corridor driven up and down again: node k is k metres on, in submaps of ten nodes each that overlap by half
NODES = [SimpleNamespace(submaps=(k // 5, k // 5 + 1)) for k in range(40)]
POSES = PoseLog.of(np.array([(float(k if k < 20 else 40 - k), 0.0, 0.0) for k in range(40)]))


def within(reach, *constraints, node=39):
    """Return the submaps within `reach` of a node."""
    links = SubmapLinks.of(NODES, constraints)  # pyright: ignore[reportArgumentType]
    return set(links.ways(reach, node, NODES[node].submaps, POSES, range(9)))


def closure(submap, node):
    """Return a loop closure."""
    return Constraint(submap, node, np.zeros(3), np.eye(3), Kind.INTER)


def test_submaps_are_placed_as_far_as_the_way_back_goes():
    assert within(4.0) == {7, 8}
    assert within(5.5) == {6, 7, 8}
    assert within(1e3) == set(range(9))


def test_what_lies_beside_is_not_placed_until_a_closure_ties_it():
    assert 0 not in within(12.0)
    assert {0, 1, 2} <= within(12.0, closure(0, 39))


def test_a_closure_long_ago_places_nothing():
    assert 1 not in within(12.0, closure(1, 25))
    assert 1 in within(16.0, closure(1, 25))


def test_a_constraint_that_is_added_links_its_submaps():
    links = SubmapLinks()
    links.add(3, (0, 5))
    poses = PoseLog.of(np.zeros((4, 3)))
    assert links.ways(1.0, 3, (5,), poses, (0, 5, 7)) == {0: 0.0, 5: 0.0}


def test_only_what_is_wanted_is_looked_for():
    links = SubmapLinks.of(NODES, ())  # pyright: ignore[reportArgumentType]
    assert links.ways(1e3, 39, (7, 8), POSES, (6,)) == {6: 5.0}
    assert links.ways(1e3, 39, (7, 8), POSES, ()) == {}


def test_submaps_are_linked_by_the_newest_node_that_stands_in_both():
    older, newer = closure(0, 24), closure(0, 26)  # both link submap 5
    for constraints in ((older, newer), (newer, older)):
        links = SubmapLinks.of(NODES, constraints)  # pyright: ignore[reportArgumentType]
        assert links._links[5][0] == links._links[0][5] == 26


@pytest.mark.parametrize(("way", "over"), [(0.4, [False, True, False, True]), (0.2, [True] * 4)])
def test_searches_are_due_by_the_way(way, over):
    interval = SearchInterval(way)
    assert [interval.is_over(0.25) for _ in range(4)] == over
