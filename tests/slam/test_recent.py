"""What was made last is kept as far as it fits."""

import numpy as np
from tagalong.slam.recent import Recent


def asked(most, least, keys):
    """Return for which of `keys`, asked for one after the other, a value of 10 bytes was made."""
    made = list[int]()

    def make(key: int):
        made.append(key)
        return np.zeros(10, np.uint8)

    recent = Recent[int, np.ndarray](make, lambda value: value.nbytes, most, least)
    for key in keys:
        assert len(recent[key]) == 10
    return made


def test_what_fits_is_made_once():
    assert asked(30, 1, [1, 2, 3, 1, 2, 3]) == [1, 2, 3]


def test_what_was_asked_for_longest_ago_makes_room():
    assert asked(20, 1, [1, 2, 1, 3, 1, 2]) == [1, 2, 3, 2]


def test_so_many_are_kept_however_large_they_are():
    assert asked(5, 2, [1, 2, 1, 2, 3, 1]) == [1, 2, 3, 1]
