from dataclasses import replace

import numpy as np
from tagalong.perception.leader.selector import LeaderSelector, numbered_by_leader

ORIGIN = np.zeros(3)


def leaders_of(selector, history):
    return [selector.update(people, ORIGIN) for people in history]


def test_the_leader_is_the_person_nearest_at_onset(stage):
    selector = LeaderSelector()
    history, truth = stage.walk([[3.0, -1.0], [1.3, -1.0]], [[0.0, 1.0], [0.0, 1.0]], 3.0)
    leader = leaders_of(selector, history)[-1]
    assert leader is not None
    assert np.hypot(*(leader.position - truth[-1][1])) < 0.3
    assert leader.visible


def test_nobody_is_chosen_before_there_is_somebody(stage):
    selector = LeaderSelector()
    assert selector.update(stage.show(np.zeros((0, 2))), ORIGIN) is None


def test_a_lost_leader_is_taken_up_again_under_the_same_identity(stage):
    selector = LeaderSelector()
    history, _ = stage.walk(
        [[1.5, -3.0], [4.0, -3.0]], [[0.0, 0.8], [0.0, 0.8]], 8.0, hidden=lambda who, t: who == 0 and 2.5 < t < 5.0
    )
    leaders = leaders_of(selector, history)
    chosen = leaders[24]
    assert chosen is not None
    lost = [leader for leader in leaders if leader is not None and leader.track_id == -1]
    assert len(lost) > 5
    assert not any(leader.visible for leader in lost)
    speeds = np.array([leader.velocity for leader in lost])
    assert speeds.shape == (len(lost), 2)
    assert np.abs(speeds[:, 0]).max() < 0.15
    assert (np.diff(speeds[:, 1]) < 0.0).all()  # it fades on its way
    assert 0.0 < speeds[-1, 1] < speeds[0, 1] < 0.9
    found = leaders[-1]
    assert found is not None
    assert found.visible
    assert found.id == chosen.id
    assert abs(found.position[0] - 1.5) < 0.3  # not the bystander, who was there all the time


def test_a_leader_found_as_another_track_keeps_its_number_in_the_table(stage):
    people = stage.walk([[1.5, -1.0]], [[0.0, 1.0]], 2.0)[0][-1]
    leader = LeaderSelector().update(people, ORIGIN)
    assert leader is not None
    again = replace(leader, id=7, track_id=int(people.ids[0]))
    assert numbered_by_leader(people, again).ids.tolist() == [7]
    assert numbered_by_leader(people, replace(again, track_id=-1)).ids.tolist() == people.ids.tolist()


def people_at(template, time_s, positions, unseen_s):
    """People numbered 0, 1, ... at `positions` (n, 2), each unseen for `unseen_s` (n,)."""
    count = len(positions)
    return replace(
        template,
        time_s=time_s,
        ids=np.arange(count),
        positions=np.array(positions),
        velocities=np.zeros((count, 2)),
        confidence=np.full(count, 0.8),
        legs=np.repeat(np.array(positions)[:, None], 2, axis=1),
        variance=np.full(count, 0.05),
        unseen_s=np.array(unseen_s),
        age_s=np.full(count, time_s),
    )


def test_who_was_chosen_leads_again_as_soon_as_the_number_is_back(stage):
    template, selector = stage.show(np.zeros((0, 2))), LeaderSelector()
    places = [[1.5, 0.0], [2.0, 0.5]]
    for k in range(15):
        selector.update(people_at(template, 0.1 * k, places, [0.0, 0.0]), ORIGIN)
    alone = people_at(template, 1.5, places, [0.0, 0.0])
    told = []
    for k in range(15, 25):  # of the two only somebody of a new number is left, where the leader was
        age_s = 0.1 if k == 15 else 5.0  # once it is the leader it stays so, however old
        new = replace(alone, time_s=0.1 * k, ids=np.array([1, 7]), age_s=np.array([0.1 * k, age_s]))
        new = replace(new, positions=np.array([[2.0, 0.5], [1.5, 0.1]]))
        leader = selector.update(new, ORIGIN)
        assert leader is not None
        told.append((leader.id, leader.track_id))
    assert set(told) == {(0, 7)}
    both = replace(alone, time_s=2.5, ids=np.array([0, 7]))
    back = selector.update(both, ORIGIN)
    assert back is not None
    assert (back.id, back.track_id) == (0, 0)
    gone = selector.update(replace(both, time_s=2.6, ids=np.array([3, 7])), ORIGIN)
    assert gone is not None
    assert gone.track_id != 7 or gone.id == 0


def test_a_leader_who_vanishes_within_the_first_second_is_lost_and_known_again(stage):
    template, selector = stage.show(np.zeros((0, 2))), LeaderSelector()
    chosen = selector.update(people_at(template, 0.1, [[1.3, 0.0]], [0.0]), ORIGIN)
    assert chosen is not None
    assert chosen.visible
    for k in range(2, 9):
        gone = selector.update(people_at(template, 0.1 * k, np.zeros((0, 2)), []), ORIGIN)
        assert gone is not None
        assert not gone.visible
        assert gone.confidence == 0.0
        assert gone.track_id == -1
        assert np.isclose(gone.unseen_s, 0.1 * (k - 1))
    other = replace(people_at(template, 0.9, [[9.0, 0.0]], [0.0]), ids=np.array([5]))
    far = selector.update(other, ORIGIN)  # nobody to be chosen, nor the leader
    assert far is not None
    assert not far.visible
    again = replace(people_at(template, 1.5, [[1.3, 0.0]], [0.0]), ids=np.array([5]), age_s=np.array([0.2]))
    found = selector.update(again, ORIGIN)
    assert found is not None
    assert found.visible
    assert found.id == chosen.id


def test_a_leader_beyond_the_onset_distance_is_followed_from_the_first_second_on(stage):
    template, selector = stage.show(np.zeros((0, 2))), LeaderSelector()
    places = [[2.0 + 0.5 * k, 0.0] for k in range(8)]
    leaders = [selector.update(people_at(template, 0.1 * k, [p], [0.0]), ORIGIN) for k, p in enumerate(places)]
    assert [leader.position[0] for leader in leaders if leader is not None] == [p[0] for p in places]
