"""Which of the places that a search finds closes a loop."""

import time
from collections import defaultdict
from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.slam.graph.loops.constraints import Constraint, ConstraintBuilder, ConstraintConfig, Kind, Place
from tagalong.slam.graph.loops.global_config import GlobalSlamConfig
from tagalong.slam.graph.loops.global_slam import GlobalSlam
from tagalong.slam.graph.loops.loop_search import LoopSearch
from tagalong.slam.graph.loops.node_matching import NodeMatching
from tagalong.slam.graph.loops.pieces import Pieces
from tagalong.slam.graph.loops.slack import Slack
from tagalong.slam.graph.loops.stretch import stretch
from tagalong.slam.graph.loops.submap_links import SubmapLinks
from tagalong.slam.local.submap import Submap, SubmapConfig
from tagalong.slam.pose_log import PoseLog
from tagalong.slam.processes.threads import Workers

SCAN = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])
LOOSE = Slack(2.0, 0.2)


def graph(nodes=4, begins=()):
    """Return a graph of nodes a metre apart, with pieces that begin at some of them and at submaps of that number."""
    pieces = Pieces()
    for k in begins:
        pieces.begin(k, k, LOOSE)
    poses = [np.array([float(k), 0.0, 0.0]) for k in range(nodes)]
    seen = [SCAN + np.array([0.0, 5.0 * k]) for k in range(nodes)]
    return SimpleNamespace(
        nodes=[SimpleNamespace(pose_local=pose, points=p, submaps=(7,)) for pose, p in zip(poses, seen, strict=True)],
        node_poses=poses, pieces=pieces, links=SubmapLinks(), constraints=[], submaps=range(nodes),
        submap_poses=[np.zeros(3)] * nodes, guess=lambda _submap, _node: np.zeros(3), ways=lambda *_: {},
    )  # fmt: skip


def closure(*places, seen=None, begins=(), threads=1):
    """Return where node 3 is tied to submap 0 or 1, of `places` (submap, x, lead) that a search finds; None: nowhere.

    `seen`: how many points a search must have to find them; None: any.
    """

    def found(submap, points, *_):
        time.sleep(0.02 * (threads - 1) * (1 - submap))  # with threads, the first is done last
        fits = seen is None or len(points) == seen
        return [Place(np.array([x, 0.0, 0.0]), lead) for s, x, lead in places if s == submap and fits]

    def tie(index, _submap, node, _points, pose):
        return Constraint(index, node, pose, np.eye(3), Kind.INTER, searched=True)

    builder = SimpleNamespace(places=found, closure=tie, longest_way=80.0)
    made = LoopSearch(graph(begins=begins), builder, 15.0, Workers(threads)).search([0, 1], 3)  # pyright: ignore[reportArgumentType]
    return None if made is None else (made.submap, made.pose[0])


def test_the_likeliest_place_counts():
    assert closure((0, 1.0, 9.0), (1, 5.0, 20.0)) == (1, 5.0)


def test_of_equals_the_first_counts_whichever_thread_is_first():
    places = (0, 1.0, 20.0), (1, 1.0, 20.0)
    assert closure(*places, threads=3) == closure(*places) == (0, 1.0)


def test_two_places_that_are_about_as_likely_close_no_loop_also_on_two_submaps():
    assert closure((0, 1.0, 19.0), (1, 5.0, 20.0)) is None
    assert closure((0, 4.6, 19.0), (1, 5.0, 20.0)) == (1, 5.0)  # the same place


def test_a_place_must_be_likelier_than_that_it_was_never_seen():
    assert closure((0, 1.0, 2.0)) is None


def test_where_the_stretch_is_nowhere_its_last_scan_is_searched_for():
    assert closure((0, 1.0, 9.0), seen=len(SCAN)) == (0, 1.0)


def test_what_only_odometry_ties_is_searched_for_by_the_whole_stretch():
    assert closure((0, 1.0, 9.0), seen=len(SCAN), begins=(2,)) is None


def test_a_stretch_ends_where_its_piece_begins():
    assert len(stretch(graph(), 3)) == 4 * len(SCAN)  # pyright: ignore[reportArgumentType]
    assert len(stretch(graph(begins=(2,)), 3)) == 2 * len(SCAN)  # pyright: ignore[reportArgumentType]


def test_a_constraint_that_is_added_joins_its_pieces():
    made = graph(begins=(2,))
    matching = NodeMatching(made, ConstraintBuilder(ConstraintConfig()))  # pyright: ignore[reportArgumentType]
    matching.add([Constraint(0, 3, np.zeros(3), np.eye(3), Kind.INTER)])
    assert made.pieces.are_joined(0, 3)


@pytest.mark.parametrize("searched", [False, True])
def test_a_closure_that_was_searched_makes_no_way_before_the_graph_is_adjusted_to_it(searched):
    made = graph()
    matching = NodeMatching(made, ConstraintBuilder(ConstraintConfig()))  # pyright: ignore[reportArgumentType]
    matching.add([Constraint(0, 3, np.zeros(3), np.eye(3), Kind.INTER, searched=searched)])
    ways = made.links.ways(99.0, 3, (7,), PoseLog.of(np.array(made.node_poses)), (0,))
    assert ways == ({} if searched else {0: 0.0})


def test_pieces_come_apart_when_the_graph_drops_their_closure(monkeypatch):
    made = GlobalSlam(GlobalSlamConfig(), [], lambda scan: scan)  # pyright: ignore[reportArgumentType]
    made.graph.pieces.begin(2, 2, LOOSE)
    made.graph.pieces.join([Constraint(0, 3, np.zeros(3), np.eye(3), Kind.INTER)])
    done = SimpleNamespace(rejected=1, poses=None, pattern=None)
    monkeypatch.setattr("tagalong.slam.graph.loops.global_slam.optimise", lambda *_: done)
    made.optimise()
    assert not made.graph.pieces.are_joined(0, 3)


@pytest.mark.parametrize(
    ("slack", "way", "linear"),
    [(0.0, 0.0, 1.5), (0.0, 50.0, 3.0), (0.0, np.inf, 4.0), (5.0, np.inf, 19.0), (500.0, np.inf, 40.0)],
)
def test_the_window_is_as_wide_as_drift_and_odometry_leave_open_but_no_wider_than_can_be_searched(
    monkeypatch, slack, way, linear
):
    asked = []

    def search(_pyramid, _points, _centre, window, **_):
        asked.append(window.linear)
        return SimpleNamespace(maxima=())

    monkeypatch.setattr("tagalong.slam.graph.loops.constraints.branch_and_bound", search)
    builder = ConstraintBuilder(ConstraintConfig())
    monkeypatch.setattr(builder, "_pyramids", defaultdict(lambda: None))
    submap = Submap(SubmapConfig(), np.zeros(3))
    builder.places(submap, SCAN, np.zeros(3), Slack(slack, 0.1 if slack else 0.0), way)
    assert asked == [pytest.approx(linear)]


def test_each_submap_is_searched_as_wide_as_the_way_to_it_is_long(monkeypatch):
    slam = GlobalSlam(GlobalSlamConfig(), [], lambda scan: scan)  # pyright: ignore[reportArgumentType]
    asked = []
    monkeypatch.setattr(slam.graph, "ways", lambda *_: {4: 7.0})
    monkeypatch.setattr(slam.graph, "guess", lambda *_: np.zeros(3))
    slam.graph.nodes.append(SimpleNamespace(pose_local=np.zeros(3)))  # pyright: ignore[reportArgumentType]
    slam.graph.submaps.extend(range(5))  # pyright: ignore[reportArgumentType]
    builder = slam._loops._builder
    monkeypatch.setattr(builder, "places", lambda submap, *asks: asked.append((submap, asks[-1])) or [])
    assert slam._loops._places([3, 4], 0, [SCAN]) == [[]]
    assert asked == [(3, np.inf), (4, 7.0)]


def test_a_submap_where_a_match_is_missed_is_searched_for_once(monkeypatch):
    slam = GlobalSlam(GlobalSlamConfig(search_every=1.0), [], lambda scan: scan)  # pyright: ignore[reportArgumentType]
    node = SimpleNamespace(submaps=(7,), pose_local=np.zeros(3))
    asked = []
    slam.graph.nodes.extend([node, node])  # pyright: ignore[reportArgumentType]
    monkeypatch.setattr(slam.graph, "near", lambda *_: [[3, 4]])
    monkeypatch.setattr(slam.graph, "ways", lambda *_: {3: 0.0, 4: 0.0})
    monkeypatch.setattr(slam._matching, "track", lambda submap, _: submap == 3)
    monkeypatch.setattr(slam, "_is_loose", lambda *_: False)
    monkeypatch.setattr(slam._near_search, "is_over", lambda _: True)
    monkeypatch.setattr(slam._loops, "search", lambda submaps, _: asked.append(submaps))
    slam.close_loops()
    assert asked == [[4]]
    assert slam._missed == set()
