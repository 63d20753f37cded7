"""The leader known by its body: people who pass, hide and are mistaken for each other, in an open room."""

import numpy as np
import pytest
from body_selector_reference import PlainSelector
from tagalong.perception.leader import body_kernels
from tagalong.perception.leader.body_memory import CLOUD, Company, memory_of, nothing_remembered
from tagalong.perception.leader.body_selector import BodyConfig, BodyLeaderSelector, body_numbers
from tagalong.perception.leader.onset import LeaderConfig
from tagalong.perception.leader.selector import LeaderSelector
from tagalong.perception.tracking.people import People, SeenLegs
from tagalong.slam import InputError, LaserScan

ORIGIN = np.zeros(3)
BEARINGS = np.deg2rad(np.arange(-135.0, 135.1, 0.5))
DT = 0.1


def scan_of(places, time_s, wall=None):
    """A scan from the origin of discs of 0.15 m at `places`, and of a wall at x = `wall[0]` for y in `wall[1:]`."""
    directions = np.stack((np.cos(BEARINGS), np.sin(BEARINGS)), axis=1)
    ranges = np.full(len(BEARINGS), np.inf)
    for place in places:
        along, across = directions @ place, directions @ np.array([-place[1], place[0]])
        hit = (along > 0.0) & (np.abs(across) < 0.15)
        ranges[hit] = np.minimum(ranges[hit], along[hit] - np.sqrt(0.15**2 - across[hit] ** 2))
    if wall is not None:
        with np.errstate(divide="ignore"):
            far = np.where(directions[:, 0] > 0.05, wall[0] / directions[:, 0], np.inf)
        y = far * directions[:, 1]
        ranges = np.where((y > wall[1]) & (y < wall[2]), np.minimum(ranges, far), ranges)
    return LaserScan(ranges, BEARINGS, 0.1, 20.0, time_s=time_s)


class Room:
    """Shows a selector people, given by number, place, velocity and whether they are seen, step by step."""

    def __init__(self, selector):
        self.selector, self.time_s, self.unseen = selector, 0.0, {}

    def show(self, tracked, loose=(), wall=None):
        """Show `tracked` (number, place, velocity, seen) and the places of `loose` bodies without a track."""
        self.time_s += DT
        legs, owner = [], []
        for row, (number, place, _, seen) in enumerate(tracked):
            self.unseen[number] = 0.0 if seen else self.unseen.get(number, 0.0) + DT
            if seen:
                legs += [place + np.array([0.0, 0.1]), place - np.array([0.0, 0.1])]
                owner += [row, row]
        for place in loose:
            legs += [place + np.array([0.0, 0.1]), place - np.array([0.0, 0.1])]
            owner += [-1, -1]
        count = len(tracked)
        people = People(
            time_s=self.time_s,
            ids=np.array([number for number, *_ in tracked], dtype=np.int64),
            positions=np.array([place for _, place, *_ in tracked]).reshape(-1, 2),
            velocities=np.array([velocity for *_, velocity, _ in tracked]).reshape(-1, 2),
            confidence=np.full(count, 0.8),
            legs=np.zeros((count, 2, 2)),
            variance=np.full(count, 0.05),
            unseen_s=np.array([self.unseen[number] for number, *_ in tracked]),
            age_s=np.full(count, self.time_s),
            seen_legs=SeenLegs(np.array(legs).reshape(-1, 2), np.full(len(legs), 0.8), np.array(owner, dtype=np.intp)),
        )
        bodies = [place for _, place, _, seen in tracked if seen] + list(loose)
        return self.selector.update(people, ORIGIN, scan_of(bodies, self.time_s, wall))


def body_selector(seed=0):
    return BodyLeaderSelector(np.random.default_rng(seed))


def passing(selector):
    """The leader walks left, a bystander right; where they meet, their tracks change bodies. The leader at the end."""
    room, speed = Room(selector), np.array([0.0, 0.8])
    for k in range(60):
        leader, other = np.array([1.6, -1.6 + 0.08 * k]), np.array([2.3, 2.4 - 0.08 * k])
        changed = leader[1] > other[1]
        first, second = (other, -speed), (leader, speed)
        if not changed:
            first, second = second, first
        found = room.show([(0, *first, True), (1, *second, True)])
    return found


@pytest.mark.parametrize("seed", range(5))
def test_the_leader_is_the_body_that_walks_on_when_two_tracks_change_bodies(seed):
    found = passing(body_selector(seed))
    assert found.track_id == 1
    assert found.id == 0
    assert found.visible
    assert passing(LeaderSelector()).track_id == 0  # by number alone the bystander is followed


def behind_the_wall(selector, returns):
    """The leader goes behind a wall; a bystander who was there all the time stays in view beyond it."""
    room, wall = Room(selector), (2.0, 0.4, 2.0)
    still = np.zeros(2)
    for k in range(100):
        leader, walks = np.array([2.4, -1.0 + 0.07 * k]), np.array([0.0, 0.7])
        bystander = np.array([2.6, -0.3])
        hidden = 0.5 < leader[1] < 2.2
        ended = leader[1] > 1.2
        tracked = [(1, bystander, still, True)]
        if not ended:
            tracked.append((0, leader, walks, not hidden))
        elif not hidden and returns:
            tracked.append((2, leader, walks, True))
        found = room.show(tracked, wall=wall)
    return found


@pytest.mark.parametrize("seed", range(5))
def test_a_hidden_leader_is_found_where_it_comes_out_and_a_bystander_seen_before_is_not_taken(seed):
    assert behind_the_wall(body_selector(seed), returns=True).track_id == 2
    lost = behind_the_wall(body_selector(seed), returns=False)
    assert lost.track_id == -1
    assert not lost.visible
    assert lost.unseen_s > 3.0


@pytest.mark.parametrize("seed", range(3))
def test_nobody_who_was_seen_beside_the_leader_is_taken_for_it_later_though_never_tracked(seed):
    room, wall, taken = Room(body_selector(seed)), (2.0, 0.4, 2.0), 0
    for k in range(140):
        leader, walks = np.array([2.4, -1.0 + 0.07 * k]), np.array([0.0, 0.7])
        stroll = np.array([0.0, 0.025 * k])  # two others, who stroll on while the leader is hidden for good
        others = [np.array([1.5, -2.6]) + stroll, np.array([1.8, -1.8]) + stroll]
        tracked = [(0, leader, walks, leader[1] < 0.5)] if leader[1] < 1.2 else []
        found = room.show(tracked, loose=others, wall=wall)
        taken += leader[1] > 0.6 and found.visible
    assert taken == 0


def sliding(seed, hidden=0, **body):
    """The leader passes somebody who only stands; its track slides over to who stands. Its place, and the leader.

    `hidden`: for so many scans after that, nothing else is seen of it.
    """
    room = Room(BodyLeaderSelector(np.random.default_rng(seed), BodyConfig(**body)))
    stands = np.array([2.4, 0.0])
    for k in range(50):
        leader, walks = np.array([1.6, -1.5 + 0.06 * k]), np.array([0.0, 0.6])
        if leader[1] < -0.1:
            found = room.show([(0, leader, walks, True)], loose=[stands])
        else:
            found = room.show([(0, stands, np.zeros(2), True)], loose=[leader] if k >= 24 + hidden else [])
    return leader, found


@pytest.mark.parametrize("hidden", [0, 2])
@pytest.mark.parametrize("seed", range(5))
def test_legs_of_somebody_who_stood_there_before_do_not_become_the_leaders_with_its_track(seed, hidden):
    leader, found = sliding(seed, hidden)
    assert found.visible
    assert np.hypot(*(found.position - leader)) < 0.4
    leader, found = sliding(seed, hidden, followed_apart=np.inf)
    assert np.hypot(*(found.position - leader)) > 1.0


def doubled(seed, **body):
    """Each leg of a leader who waits has started a person; when it walks on, one stays with what stands there."""
    room = Room(BodyLeaderSelector(np.random.default_rng(seed), BodyConfig(**body)))
    still, walks = np.zeros(2), np.array([0.0, 1.1])
    for k in range(90):
        leader = np.array([1.6, -1.0 + 0.11 * max(k - 25, 0)])
        if k < 25:
            found = room.show(
                [(0, leader, still, True), (1, leader + np.array([0.2, 0.0]), still, True)][: 1 + (k > 12)]
            )
        else:
            tracks = [(0, np.array([1.6, -1.0]), still, k < 33), (1, leader, walks, True)]
            found = room.show(tracks if k < 38 else tracks[1:])
    return found


def test_a_second_track_of_the_leader_carries_it_on():
    carried = [[doubled(seed, **fields).track_id == 1 for seed in range(6)] for fields in ({}, {"beside": 0.0})]
    assert sum(carried[0]) == 6
    assert sum(carried[1]) <= 2  # somebody else's legs


@pytest.mark.parametrize("seed", range(5))
def test_a_leader_whose_track_was_stolen_is_seen_by_legs_that_are_nobodys(seed):
    room = Room(body_selector(seed))
    for k in range(60):
        leader, other = np.array([1.6, -1.6 + 0.08 * k]), np.array([2.3, 2.4 - 0.08 * k])
        speed = np.array([0.0, 0.8])
        if leader[1] < other[1]:
            found = room.show([(0, leader, speed, True), (1, other, -speed, True)])
        else:  # both tracks go on with the bystander
            both = [(0, other + np.array([0.15, 0.0]), -speed, True), (1, other, -speed, True)]
            found = room.show(both, loose=[leader])
    assert found.visible
    assert found.track_id == -1
    assert np.hypot(*(found.position - leader)) < 0.3


def test_a_leader_alone_is_its_track(monkeypatch):
    room = Room(body_selector())
    monkeypatch.setattr("tagalong.perception.leader.body_selector.cloud_draws", None)  # it needs no cloud
    for k in range(40):
        place = np.array([1.5, -1.0 + 0.05 * k])
        found = room.show([(0, place, np.array([0.0, 0.5]), True), (1, place + 1.6, np.zeros(2), True)])
    assert found.track_id == 0
    assert found.position.tolist() == place.tolist()


def test_the_same_draws_find_the_same_leader():
    first, second = passing(body_selector(3)), passing(body_selector(3))
    assert first.position.tobytes() == second.position.tobytes()


def test_without_a_scan_no_body_is_known():
    room = Room(LeaderSelector())
    room.show([(0, np.array([1.5, 0.0]), np.zeros(2), True)])
    people = People(*([0.0] + [np.zeros(0)] * 8))
    with pytest.raises(InputError, match="only with the scan at hand"):
        body_selector().update(people, ORIGIN)


def test_a_leader_who_vanishes_within_the_first_second_is_not_seen():
    room = Room(body_selector())
    place, still = np.array([1.3, 0.0]), np.zeros(2)
    assert room.show([(0, place, still, True)]).visible
    gone = [room.show([]) for _ in range(6)]
    assert not any(leader.visible for leader in gone)
    assert [leader.track_id for leader in gone] == [-1] * 6
    assert gone[-1].unseen_s == pytest.approx(0.6)
    found = room.show([(0, place, still, True)])
    assert (found.visible, found.track_id, found.id) == (True, 0, 0)


@pytest.mark.parametrize("seed", range(6))
def test_the_leader_is_that_of_plain_numpy_in_any_crowd(seed):
    rng = np.random.default_rng(seed)
    rooms = [Room(kind(np.random.default_rng(seed))) for kind in (BodyLeaderSelector, PlainSelector)]
    places, speeds = rng.uniform(-2.5, 2.5, (6, 2)) + np.array((2.0, 0.0)), rng.normal(0.0, 0.6, (6, 2))
    numbers, lost, changed = np.arange(6), 0, 0
    for k in range(200):
        places += DT * speeds
        speeds = np.where(np.abs(places - [2.0, 0.0]) > 2.5, -np.sign(places - [2.0, 0.0]) * np.abs(speeds), speeds)
        if rng.random() < 0.1:  # two tracks change bodies, or one ends and a new one begins
            numbers[:2] = rng.permutation(numbers[:2])
            numbers[rng.integers(6)] = 10 + k
        seen, tracked = rng.random(6) < 0.8, np.roll(rng.random(6) < 0.9, k // 40)
        shown = [(int(numbers[i]), places[i].copy(), speeds[i], bool(seen[i])) for i in range(6) if tracked[i]]
        loose = [places[i] for i in range(6) if not tracked[i] and seen[i]]
        ours, theirs = (room.show(shown, loose) for room in rooms)
        assert (ours is None) == (theirs is None)
        if ours is not None:
            assert (ours.id, ours.track_id, ours.visible) == (theirs.id, theirs.track_id, theirs.visible)
            for name in ("position", "velocity", "confidence", "unseen_s"):
                assert getattr(ours, name) == pytest.approx(getattr(theirs, name), rel=1e-6, abs=1e-9)
            lost, changed = lost + (ours.track_id < 0), changed + (ours.track_id != ours.id)
    assert lost > 5
    assert changed > lost


@pytest.mark.parametrize(
    ("beside_s", "velocity", "unseen_s", "taken"),
    [
        (5.7, (0.4, 0.3), 0.0, 1),  # beside it 0.2 s before it was lost, and walks
        (5.3, (0.4, 0.3), 0.0, -1),  # longer ago
        (5.7, (0.0, 0.0), 0.0, -1),  # stands
        (5.7, (0.2, 0.1), 0.0, -1),  # hardly moves
        (5.7, (0.4, 0.3), 0.2, -1),  # hidden itself
    ],
)
def test_of_two_who_were_beside_each_other_the_one_that_is_left_and_walks_on_may_be_the_leader(
    beside_s, velocity, unseen_s, taken
):
    memory = memory_of(nothing_remembered(1, 10), 0)
    one, met = memory.leader[0], memory.met
    one["time_s"], one["unseen_s"], one["own"], one["row"], one["met"] = 10.0, 4.1, 0, -1, 2
    one["x"][:] = 2.0, 1.0, 0.5, 0.5
    one["known"], one["doubt"], one["cloud"] = True, CLOUD, True
    memory.bodies[:], memory.weights[:] = (9.0, 9.0, 0.0, 0.0), 0.1  # it has wandered off
    met["number"][:2], met["beside_s"][:2] = (0, 1), (5.8, beside_s)
    x, none = np.array([[1.0, 2.0, *velocity]]), np.zeros((0, 2))
    company = Company(
        np.array([1]), x, np.ones(1), np.array([unseen_s]), none, np.zeros(0), np.zeros(0, dtype=np.int64)
    )
    body_kernels.decide(memory, company, -1.0, body_numbers(BodyConfig(), LeaderConfig()))
    assert one["track_id"] == taken
