"""What a hypothesis has moved: told by its former places, in a frame that stands still, where nothing stands."""

import numpy as np
import pytest
from tagalong.perception.tracking.association import leg_costs
from tagalong.perception.tracking.evidence import log_odds
from tagalong.perception.tracking.motion import correct, note_path, predict, widen
from tagalong.perception.tracking.tracks import HYPOTHESIS


def noted(way, speed=1.0, free=True, known=1.0):
    """A hypothesis that goes `way` [m] in two seconds along x, at the `speed` [m/s] that its state says in the end."""
    rows = np.zeros(1, HYPOTHESIS)
    rows["clusters"], rows["born"] = (0, -1), (2.0, 0.0)
    for k in range(5):
        place = np.array([[2.0 + way * k / 4, 0.0]])
        rows["x"], rows["age_s"] = (*place[0], speed, 0.0), 1.0 + 0.5 * k
        note_path(rows, place, np.array([free]), known, 0.5, 0.5, 0.5, 0.4, 0.1)
    return rows


def test_who_goes_half_a_metre_and_still_goes_on_has_moved_as_far_as_the_frame_stands_still():
    assert noted(0.6)["moved"] == pytest.approx(0.6)
    assert noted(0.6, known=0.7)["moved"] == pytest.approx(0.42)


def test_where_no_wall_tells_a_person_may_have_kept_its_place_before_the_laser():
    rows = np.zeros(2, HYPOTHESIS)
    rows["x"][:, :2], rows["p"][:, 0] = [[2.0, 1.0], [1.0, 1.0]], 0.05
    turned = np.array([1.0, 1.0, 0.5])
    widen(rows, np.array([1.0, 1.0, 0.0]), turned, 1.0)  # the first one stands a metre ahead, the second one is it
    assert rows["p"][:, 0] == pytest.approx([0.05 + 4.0 * np.sin(0.25) ** 2, 0.05])
    widen(rows, turned, turned + np.array([0.3, 0.0, 0.0]), 0.5)
    assert rows["p"][:, 0] == pytest.approx([0.05 + 4.0 * np.sin(0.25) ** 2 + 0.15**2, 0.05 + 0.15**2])
    widen(rows, turned, np.zeros(3), 0.0)
    assert rows["p"][1, 0] == pytest.approx(0.05 + 0.15**2)


def test_each_stride_speaks_for_a_person_but_the_next_ones_less_than_the_first():
    odds = [log_odds(noted(way), -7.0, 0.6, 2.0, 0.5)[0] for way in (0.4, 0.5, 1.0, 4.0)]
    assert odds == pytest.approx([-7.0, -5.0, -4.5, -7.0 + 2.0 * 8 / 5.2])


@pytest.mark.parametrize("otherwise", [{"way": 0.4}, {"speed": 0.1}, {"free": False}])
def test_what_went_less_or_stands_again_or_is_where_something_stood_has_not_moved(otherwise):
    assert noted(**{"way": 0.6, **otherwise})["moved"] == 0.0


def test_places_are_noted_at_their_spacing_and_how_far_it_came_before_the_laser():
    rows = noted(0.6)
    assert rows["places"][0] == 5
    assert rows["path"][0, :5, 0] == pytest.approx([2.0, 2.15, 2.3, 2.45, 2.6])
    assert rows["swing"][0] == pytest.approx(0.6)


def costs_of(z, thing=0.0, unseen_s=0.1):
    """Costs of one cluster at `z` for the legs of a person at (2, 0) whose feet are 0.3 m apart."""
    rows, cost = np.zeros(1, HYPOTHESIS), np.empty((2, 1))
    rows["x"], rows["legs"], rows["leg_unseen_s"] = (2.0, 0.0, 0.0, 0.0), [[0.0, -0.15], [0.0, 0.15]], unseen_s
    leg_costs(rows, np.array([z]), np.zeros(1), np.array([thing]), 0.01, 1.5, 0.45, 0.2, cost)
    return cost[:, 0]


def test_a_cluster_is_the_leg_that_was_nearest_and_none_beyond_half_a_stride():
    first, second = costs_of([2.0, -0.2])
    assert first < second - 1.0
    assert np.isinf(costs_of([2.0, -0.5])).all()


def test_a_leg_seen_a_moment_ago_is_sought_nearer_than_one_long_hidden():
    near, far = [2.0, -0.17], [1.7, -0.3]
    assert costs_of(near)[0] < costs_of(near, unseen_s=1e3)[0]
    assert costs_of(far, unseen_s=0.05)[0] > costs_of(far, unseen_s=1e3)[0]


def test_a_thing_that_has_stood_there_is_no_leg_that_comes_there_but_may_be_one_that_has_been_there():
    assert costs_of([2.0, -0.3], thing=5.0)[0] == pytest.approx(costs_of([2.0, -0.3])[0] + 5.0)
    assert costs_of([2.0, -0.2], thing=5.0)[0] == costs_of([2.0, -0.2])[0]


def test_the_leg_that_is_seen_is_known_and_the_other_one_is_less_so_from_scan_to_scan():
    rows = np.zeros(1, HYPOTHESIS)
    rows["x"], rows["legs"], rows["p"] = (2.0, 0.0, 0.0, 0.0), [[0.0, -0.2], [0.0, 0.2]], (0.05, 0.0, 0.2)
    for _ in range(3):
        predict(rows, 0.1, 0.01)
        rows["clusters"] = (-1, 0)
        correct(rows, np.array([[2.0, 0.2]]), 0.1, 0.2, 0.1, 0.5)
    assert rows["leg_unseen_s"][0] == pytest.approx([0.3, 0.0])
    assert rows["x"][0, :2] + rows["legs"][0, 1] == pytest.approx([2.0, 0.2])
    assert np.abs(rows["legs"][0, 0]).max() == pytest.approx(0.2 * 0.5**3)


def test_one_leg_tells_less_of_the_centre_than_two():
    rows = np.zeros(2, HYPOTHESIS)
    rows["p"], rows["clusters"] = (0.1, 0.0, 0.2), [[0, -1], [0, 1]]
    correct(rows, np.array([[0.1, 0.0], [0.1, 0.0]]), 0.1, 0.2, 0.1, 0.5)
    assert rows["x"][:, 0] == pytest.approx([0.1 / 3, 0.05])
