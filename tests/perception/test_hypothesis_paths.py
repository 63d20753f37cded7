"""What a hypothesis has moved is told by places that were empty before it came there, or are left empty behind it."""

import numpy as np
import pytest
from tagalong.perception.tracking.hypotheses import HYPOTHESIS, PATH, note_path


@pytest.mark.parametrize(("new", "way"), [(True, 0.4), (False, 0.0)])
def test_who_came_to_places_where_nothing_was_has_moved_though_nothing_is_seen_of_what_is_left(new, way):
    rows = np.zeros(1, HYPOTHESIS)
    rows["clusters"] = (0, -1)
    left, hidden = np.zeros((1, PATH), dtype=np.bool_), np.zeros(1, dtype=np.bool_)
    for k in range(3):
        place = np.array([[2.0 + 0.4 * k, 0.0]])
        rows["age_s"] = 1.0 + k
        note_path(rows, place, place, left, np.array([new]), hidden, 0.5)
    assert rows["places"][0] == 3
    assert rows["way"][0] == pytest.approx(way)  # the nearer of the two farthest places
