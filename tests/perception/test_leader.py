from dataclasses import replace

import numpy as np
from tagalong.perception.tracking.leader import LeaderSelector, numbered_by_leader

ORIGIN = np.zeros(3)


def leaders_of(selector, history):
    return [selector.update(people, ORIGIN) for people in history]


def test_the_leader_is_the_person_nearest_at_onset(stage):
    selector = LeaderSelector(stage.config)
    history, truth = stage.walk([[3.0, -1.0], [1.3, -1.0]], [[0.0, 1.0], [0.0, 1.0]], 3.0)
    leader = leaders_of(selector, history)[-1]
    assert leader is not None
    assert np.hypot(*(leader.position - truth[-1][1])) < 0.3
    assert leader.visible


def test_nobody_is_chosen_before_there_is_somebody(stage):
    selector = LeaderSelector(stage.config)
    assert selector.update(stage.show(np.zeros((0, 2))), ORIGIN) is None


def test_a_lost_leader_is_taken_up_again_under_the_same_identity(stage):
    selector = LeaderSelector(stage.config)
    history, _ = stage.walk(
        [[1.5, -3.0], [4.0, -3.0]], [[0.0, 0.8], [0.0, 0.8]], 8.0, hidden=lambda who, t: who == 0 and 2.5 < t < 5.0
    )
    leaders = leaders_of(selector, history)
    chosen = leaders[24]
    assert chosen is not None
    lost = [leader for leader in leaders if leader is not None and leader.track_id == -1]
    assert len(lost) > 5
    assert not any(leader.visible for leader in lost)
    found = leaders[-1]
    assert found is not None
    assert found.visible
    assert found.id == chosen.id
    assert abs(found.position[0] - 1.5) < 0.3  # not the bystander, who was there all the time


def test_a_leader_found_as_another_track_keeps_its_number_in_the_table(stage):
    people = stage.walk([[1.5, -1.0]], [[0.0, 1.0]], 2.0)[0][-1]
    leader = LeaderSelector(stage.config).update(people, ORIGIN)
    assert leader is not None
    again = replace(leader, id=7, track_id=int(people.ids[0]))
    assert numbered_by_leader(people, again).ids.tolist() == [7]
    assert numbered_by_leader(people, replace(again, track_id=-1)).ids.tolist() == people.ids.tolist()
