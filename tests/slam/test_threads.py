"""Work that is shared among threads."""

import copy
import os
import signal
import threading
import time

import numpy as np
import pytest
from tagalong.slam.processes.threads import Workers, slices
from tagalong.slam.processes.turns import next_slice, turns
from tagalong.slam.view_kernel import kernel


@kernel
def count_up(shared, done, times):
    """Add one to each piece of `done`, `times` over so that the threads meet; return how many slices were taken."""
    taken = 0
    first, end = next_slice(shared)
    while first < end:
        taken += 1
        for _ in range(times):
            for piece in range(first, end):
                done[piece] += 1
        first, end = next_slice(shared)
    return taken


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("count", [0, 1, 2, 100])
def test_each_piece_is_done_once(threads, count):
    done = list[int]()
    Workers(threads).run(lambda start, stop: done.extend(range(start, stop)), count)
    assert sorted(done) == list(range(count))


@pytest.mark.parametrize("threads", [2, 3, 16])
def test_slices_get_shorter_and_the_last_is_a_small_part_of_a_share(threads):
    lengths = [stop - start for start, stop in slices(4800, threads)]
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[0] < 4800 / threads
    assert max(lengths[-threads:]) <= 4800 / threads / 8
    assert len(lengths) < 12 * threads


@pytest.mark.parametrize("threads", [1, 2, 3, 16])
@pytest.mark.parametrize("count", [0, 1, 2, 100, 5000])
def test_threads_take_each_turn_once_inside_a_kernel(threads, count):
    shared, done, taken = turns(count, threads), np.zeros(count, np.int64), list[int]()
    Workers(threads).together(lambda: taken.append(count_up(shared, done, 100)))
    assert (done == 100).all()
    assert len(taken) == threads
    assert sum(taken) == (len(slices(count, threads)) if threads > 1 else count > 0)


def test_two_threads_both_take_turns():
    done, both = np.zeros(5000, np.int64), threading.Barrier(2)

    def shared_out() -> list[int]:
        shared, taken = turns(5000, 2), list[int]()

        def work() -> None:
            both.wait(20)
            taken.append(count_up(shared, done, 2000))

        Workers(2).together(work)
        return taken

    count_up(turns(0), done, 1)  # compiled before
    # one thread may be done before the system lets the other run; never again and again, unless they cannot run at once
    assert any(min(shared_out()) > 0 for _ in range(100))


def test_an_error_in_a_thread_reaches_the_caller():
    def fail(start: int, _: int) -> None:
        if start:
            raise KeyError("piece")

    with pytest.raises(KeyError, match="piece"):
        Workers(2).run(fail, 50)


def test_the_caller_takes_a_share_of_the_work():
    idents, both = set[int](), threading.Barrier(2)

    def meet(_: int, __: int) -> None:
        both.wait(20)
        idents.add(threading.get_ident())

    Workers(2).run(meet, 2)
    assert threading.get_ident() in idents


def test_the_others_have_ended_when_an_error_of_the_caller_comes_out():
    caller, both, done = threading.get_ident(), threading.Barrier(2), list[int]()

    def fail(start: int, stop: int) -> None:
        if len(done) == 0:
            both.wait(20)
        if threading.get_ident() == caller:
            raise KeyError("piece")
        time.sleep(0.01)
        done.extend(range(start, stop))

    with pytest.raises(KeyError, match="piece"):
        Workers(2).run(fail, 8)
    assert len(done) == 8 - slices(8, 2)[0][1]


def test_a_copy_starts_threads_of_its_own():
    workers, done = Workers(2), list[int]()
    workers.run(lambda start, _: done.append(start), 20)
    copy.deepcopy(workers).run(lambda start, _: done.append(start), 20)
    assert len(done) == 2 * len(slices(20, 2))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_forked_process_does_not_wait_for_threads_that_it_lacks():
    workers, done = Workers(2), list[int]()
    workers.run(lambda start, _: done.append(start), 20)
    child = os.fork()
    if child == 0:
        signal.alarm(20)  # ends the process if it waits for ever
        workers.run(lambda start, _: done.append(start), 20)
        os._exit(0 if len(done) == 2 * len(slices(20, 2)) else 1)
    assert os.waitpid(child, 0)[1] == 0
