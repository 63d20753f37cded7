"""A log of poses is a list of them, whatever its blocks."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tagalong.slam.pose_log import BLOCK, PoseLog


@given(st.lists(st.tuples(st.sampled_from(["append", "extend", "cut", "set"]), st.integers(0, 2 * BLOCK)), max_size=12))
def test_whatever_is_done_to_a_log_it_holds_what_a_list_would(calls):
    log, poses, number = PoseLog(), np.zeros((0, 3)), 0.0
    for verb, count in calls:
        new = number + np.arange(3.0 * count).reshape(-1, 3)
        number += 3.0 * count
        if verb == "extend":
            log.extend(new)
            poses = np.concatenate((poses, new))
        elif verb == "append":
            log.append((number, 1, 2))
            poses = np.concatenate((poses, [(number, 1.0, 2.0)]))
        elif verb == "cut" and len(poses):
            start = count % len(poses)
            stop = min(start + 2 * count, len(poses))
            log.cut(start, stop)
            poses = np.delete(poses, slice(start, stop), axis=0)
        elif verb == "set" and len(poses):
            log[count % len(poses)] = (-1.0, 0.0, 1.0)
            poses[count % len(poses)] = (-1.0, 0.0, 1.0)
    assert len(log) == len(poses)
    np.testing.assert_array_equal(log.array(), poses)
    chosen = np.arange(len(poses))[::-7]
    np.testing.assert_array_equal(log.take(chosen), poses[chosen])
    assert [log.place(k) for k in chosen.tolist()] == [(x, y) for x, y, _ in poses[chosen].tolist()]
    np.testing.assert_array_equal(PoseLog.of(poses).array(), poses)
    if len(poses):
        np.testing.assert_array_equal(log[-1], poses[-1])
        with pytest.raises(IndexError):
            log.take(np.array([len(poses)]))
        with pytest.raises(IndexError):
            _ = log[len(poses)]


def test_poses_that_are_there_stay_where_they_are_as_a_log_grows():
    log = PoseLog()
    log.append((1.0, 2.0, 3.0))
    first = log._blocks[0]
    log.extend(np.zeros((10 * BLOCK, 3)))
    assert log._blocks[0] is first
    first[0] = 4.0
    np.testing.assert_array_equal(log[0], [4.0, 4.0, 4.0])
