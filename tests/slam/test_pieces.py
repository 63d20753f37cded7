"""Pieces of a drive that only odometry ties to each other: how loosely they hang, and what joins them."""

import numpy as np
import pytest
from tagalong.slam.graph.loops.constraints import Constraint, Kind
from tagalong.slam.graph.loops.pieces import Pieces
from tagalong.slam.graph.loops.slack import Slack
from tagalong.slam.graph.loops.trimming import Renumbering


def tie(submap, node, kind=Kind.INTER):
    return Constraint(submap, node, np.zeros(3), np.eye(3), kind)


@pytest.fixture
def pieces():
    """Return three: nodes from 0, 10 and 20, submaps from 0, 3 and 5."""
    made = Pieces()
    made.begin(10, 3, Slack(2.0, 0.1))
    made.begin(20, 5, Slack(0.5, 0.2))
    return made


def test_a_drive_begins_as_one_piece():
    made = Pieces()
    made.begin(0, 0, Slack(2.0, 0.1))
    assert made.loosest == Slack()
    assert made.are_joined(0, 99)


def test_what_odometry_leaves_open_is_that_at_the_begin_of_a_piece(pieces):
    assert pieces.slack(2, 12) == Slack(2.0, 0.1)
    assert pieces.slack(4, 5) == pieces.slack(2, 12)  # seen from either side


def test_what_lies_between_adds_up_over_the_pieces(pieces):
    far, (one, other) = pieces.slack(0, 25), (pieces.slack(2, 12), pieces.slack(4, 25))
    assert far.linear == pytest.approx(np.hypot(one.linear, other.linear))
    assert far.angular == pytest.approx(np.hypot(0.1, 0.2))
    assert far == pieces.loosest


def test_pieces_begin_with_their_first_node_and_submap(pieces):
    assert [pieces.first_node(k) for k in (9, 10, 19, 20)] == [0, 10, 10, 20]
    assert [pieces.are_joined(s, 15) for s in (2, 3, 4, 5)] == [False, True, True, False]


def test_a_loop_closure_joins_two_pieces_and_what_they_are_joined_with(pieces):
    pieces.join([tie(0, 20)])
    assert pieces.are_joined(2, 25)
    assert not pieces.are_joined(2, 15)
    pieces.join([tie(4, 20)])
    assert pieces.are_joined(2, 15)
    assert pieces.slack(2, 15) == Slack()


def test_a_node_in_its_own_submap_joins_nothing(pieces):
    pieces.join([tie(0, 20, Kind.INTRA)])
    assert not pieces.are_joined(0, 20)


def test_a_closure_that_was_dropped_joins_no_more(pieces):
    pieces.join([tie(0, 20), tie(4, 20)])
    pieces.rejoin([tie(4, 20)])
    assert pieces.are_joined(4, 20)
    assert not pieces.are_joined(0, 20)


def test_a_piece_that_is_taken_back_is_forgotten(pieces):
    pieces.rewind(20, 5, [])
    assert pieces.first_node(25) == 10
    assert [pieces.are_joined(s, 15) for s in (2, 3, 5)] == [False, True, True]


def test_pieces_keep_their_nodes_when_others_leave(pieces):
    stay, submaps = np.ones(30, dtype=np.bool_), np.ones(6, dtype=np.bool_)
    stay[[1, 2, 12]], submaps[1] = False, False
    pieces.renumber(Renumbering(stay, submaps))
    assert [pieces.first_node(k) for k in (7, 8, 16, 17)] == [0, 8, 8, 17]
    assert [pieces.are_joined(s, 17) for s in (1, 2, 3, 4)] == [False, False, False, True]
    assert [pieces.are_joined(s, 8) for s in (1, 2, 3, 4)] == [False, True, True, False]


def test_odometry_that_told_nothing_true_costs_no_more_than_its_odds():
    slack = Slack(0.1, 0.02)
    near, far, farther = (slack.cost(np.array([x, 0.0, 0.0])) for x in (0.0, 3.0, 30.0))
    assert near == pytest.approx(0.0)
    assert far == pytest.approx(-np.log(1e-6))
    assert farther == pytest.approx(far)
    assert Slack().cost(np.array([3.0, 0.0, 1.0])) == 0.0
