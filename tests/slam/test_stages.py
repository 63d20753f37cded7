"""Work in stages: who takes turns comes to the same end, a stage of each before the next of any."""

import pytest
from tagalong.slam.processes.stages import completed, in_turn


def work(name, stages, diary):
    """Note each of some stages in a diary, pausing between them; return how many there were."""
    for stage in range(stages):
        diary.append((name, stage))
        if stage + 1 < stages:
            yield
    return stages


def test_completed_work_returns_its_result_with_all_stages_done():
    diary = []
    assert completed(work("a", 3, diary)) == 3
    assert diary == [("a", 0), ("a", 1), ("a", 2)]


def test_each_stage_is_done_for_all_before_the_next_stage_of_any():
    diary = []
    assert in_turn([work("a", 2, diary), work("b", 1, diary), work("c", 3, diary)]) == [2, 1, 3]
    assert diary == [("a", 0), ("b", 0), ("c", 0), ("a", 1), ("c", 1), ("c", 2)]


def test_nobody_takes_turns_with_nobody():
    assert in_turn([]) == []


def test_an_error_ends_the_turns():
    def fails():
        yield
        raise ValueError("half way")

    with pytest.raises(ValueError, match="half way"):
        in_turn([work("a", 9, []), fails()])
