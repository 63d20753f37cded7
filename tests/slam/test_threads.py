"""Work that is shared among threads."""

import copy
import os
import signal
import threading
import time

import pytest
from tagalong.slam.processes.threads import Workers, slices


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
