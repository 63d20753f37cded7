"""Worker processes: none outlives its parent, and a parent waits for none that is lost."""

import math
import operator
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress

import pytest
from tagalong.slam.errors import InputError, WorkerError
from tagalong.slam.processes.crew import Crew, caller, most_workers, require_workers
from tagalong.slam.processes.supervised import Worker, end_all

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals")
PARENT = """
import os, sys, time
from tagalong.slam.processes.supervised import Worker
from tagalong.slam.processes.crew import caller
if __name__ == "__main__":
    workers = [Worker(f"worker {k}", caller, context=sys.argv[1]) for k in range(2)]
    for worker in workers:
        worker.ask((os.getpid, ()))
        worker.answer()
    workers[0].ask((sum, (range(10**12),)))  # a call that lets no other thread run
    print(*(worker.process.pid for worker in workers), flush=True)
    time.sleep(100)
"""


class Importing:
    """Is read from the pipe as a module is imported whose code in C turns any exception into an ImportError."""

    def __reduce__(self):
        return import_for_long, ()


def import_for_long():
    try:
        time.sleep(60.0)
    except SystemExit:
        raise ImportError("initialization failed") from None


class ImportedSlowly:
    """Takes longer to arrive in a process that is not forked than a sign of life may take."""

    def __reduce__(self):
        return time.sleep, (3.5,)


def caller_after(_):
    return caller()


def alive(pid):
    """Whether a process runs; one that has ended may wait for whoever inherited it."""
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def gone(pids, seconds=5.0):
    """Whether all processes end in time."""
    deadline = time.monotonic() + seconds
    while any(alive(pid) for pid in pids) and time.monotonic() < deadline:
        time.sleep(0.05)
    return not any(alive(pid) for pid in pids)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="/proc")
@pytest.mark.parametrize("context", ["fork", "spawn", "forkserver"])
@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGTERM])
def test_workers_end_with_their_parent_idle_busy_or_stopped(tmp_path, context, end):
    script = tmp_path / "parent.py"
    script.write_text(PARENT)
    parent = subprocess.Popen([sys.executable, script, context], stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    pids = [int(word) for word in parent.stdout.readline().split()]
    try:
        assert all(alive(pid) for pid in pids)
        os.kill(pids[1], signal.SIGSTOP)
        parent.send_signal(end)
        parent.wait()
        assert gone(pids)
    finally:
        for pid in pids:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)


@pytest.fixture
def worker():
    one = Worker("worker 1", caller, context="fork", silent_s=2.0)
    yield one
    one.close()


def asked(worker, function, *arguments):
    worker.ask((function, arguments))
    return worker.answer()


def test_a_worker_answers(worker):
    assert asked(worker, operator.mul, 6, 7) == (42, None)
    result, error = asked(worker, operator.truediv, 1, 0)
    assert result is None
    assert isinstance(error, ZeroDivisionError)
    assert "in answered" in "".join(error.__notes__)
    _, error = asked(worker, require_workers, 0, "--jobs")
    assert isinstance(error, InputError)
    assert not hasattr(error, "__notes__")  # such an error says all by itself


def test_what_no_pipe_takes_is_said_and_the_worker_goes_on(worker):
    _, error = asked(worker, operator.attrgetter, "x")
    assert error is None
    _, error = asked(worker, memoryview, b"")
    assert isinstance(error, RuntimeError)
    assert asked(worker, operator.mul, 6, 7) == (42, None)


def test_where_its_beginning_fails_every_question_is_answered_by_the_error():
    broken = Worker("worker 1", math.sqrt, (-1.0,), context="fork")
    for _ in range(2):
        assert isinstance(asked(broken, len, "")[1], ValueError)
    broken.close()
    with pytest.raises(WorkerError, match="has ended with exit code 0"):
        broken.ask(None)


@pytest.mark.parametrize(("end", "said"), [(signal.SIGKILL, "SIGKILL"), (signal.SIGTERM, "SIGTERM")])
def test_a_worker_that_is_killed_is_named_with_what_ended_it(worker, end, said):
    worker.ask((time.sleep, (60.0,)))
    os.kill(worker.process.pid, end)
    with pytest.raises(WorkerError, match=rf"worker 1 \(process {worker.process.pid}\) was ended by {said}"):
        worker.answer()
    with pytest.raises(WorkerError, match=said):
        worker.ask((len, ("",)))


def test_a_worker_that_is_stopped_is_lost_after_a_while_and_closes(worker):
    assert asked(worker, time.sleep, 3.0) == (None, None)  # one that works may take long
    os.kill(worker.process.pid, signal.SIGSTOP)
    worker.ask((len, ("",)))
    began = time.monotonic()
    with pytest.raises(WorkerError, match="no sign of life for 2 s"):
        worker.answer()
    worker.close()
    assert time.monotonic() - began < 10.0
    assert not worker.process.is_alive()


def test_a_worker_may_start_for_longer_than_it_may_be_silent_later():
    slow = Worker("worker 1", caller_after, (ImportedSlowly(),), context="forkserver", silent_s=2.0)
    assert asked(slow, len, "x") == (1, None)
    slow.close()


def test_a_sign_of_life_says_that_a_worker_has_started(worker):
    worker.ask((time.sleep, (60.0,)))
    time.sleep(1.5)
    worker.listen()
    os.kill(worker.process.pid, signal.SIGSTOP)
    with pytest.raises(WorkerError, match="no sign of life for 2 s"):
        worker.answer()


def test_a_large_question_does_not_wait_for_ever_for_a_stopped_worker(worker):
    assert asked(worker, len, "") == (0, None)
    os.kill(worker.process.pid, signal.SIGSTOP)
    with pytest.raises(WorkerError, match="no sign of life for 2 s"):
        worker.ask((len, ("x" * 10**7,)))


def test_a_worker_that_is_busy_closes():
    busy = Worker("worker 1", caller, context="fork")
    busy.ask((time.sleep, (60.0,)))
    began = time.monotonic()
    end_all([busy], at_once=True)
    assert time.monotonic() - began < 1.5
    assert busy.process.exitcode == 143  # it was unwound


@pytest.mark.parametrize("task", [Importing(), (import_for_long, ())], ids=["while it reads", "while it works"])
def test_a_worker_that_is_ended_says_nothing_whatever_its_exit_is_turned_into(capfd, task):
    importing = Worker("worker 1", caller, context="fork")
    assert asked(importing, len, "") == (0, None)
    importing.ask(task)
    time.sleep(0.3)
    began = time.monotonic()
    end_all([importing], at_once=True)
    assert time.monotonic() - began < 1.5
    assert importing.process.exitcode == 143
    assert capfd.readouterr().err == ""


def test_ctrl_c_is_for_the_parent_alone(worker):
    worker.ask((time.sleep, (0.5,)))
    os.kill(worker.process.pid, signal.SIGINT)
    assert worker.answer() == (None, None)


def test_an_answer_to_an_interrupted_question_is_not_taken_for_the_next(worker):
    worker.ask((operator.add, (1, 1)))
    assert asked(worker, operator.mul, 6, 7) == (42, None)


def test_a_crew_gives_results_as_they_end_and_starts_no_more_than_it_needs():
    with Crew(4) as crew:
        assert [index for index, _ in crew.results(time.sleep, [(1.0,), (0.0,)])] == [1, 0]
        assert dict(crew.results(operator.mul, [(k, k) for k in range(20)])) == {k: k * k for k in range(20)}
        assert len(crew._workers) == 4
        workers = list(crew._workers)
    assert not any(worker.process.is_alive() for worker in workers)


def test_an_error_of_a_call_comes_through_and_ends_the_others():
    def run():
        with Crew(2) as crew:
            assert list(crew.results(operator.add, [(1, 2), (3, 4)]))
            workers.extend(crew._workers)
            list(crew.results(time.sleep, [(60.0,), ("x",)]))

    workers, began = [], time.monotonic()
    with pytest.raises(TypeError):
        run()
    assert time.monotonic() - began < 30.0
    assert len(workers) == 2
    assert not any(worker.process.is_alive() for worker in workers)


def test_a_crew_names_the_worker_that_it_lost():
    with Crew(2) as crew:
        calls = crew.results(time.sleep, [(0.5,), (60.0,), (0.0,)])
        assert next(calls) == (0, None)
        os.kill(crew._workers[1].process.pid, signal.SIGKILL)
        with pytest.raises(WorkerError, match=r"worker 2 of 2 .* was ended by SIGKILL"):
            list(calls)


def test_no_more_workers_are_started_than_the_machine_has_use_for():
    require_workers(most_workers(), "--jobs")
    with pytest.raises(InputError, match=r"--jobs must not exceed .*4 a core.*, got 100000"):
        require_workers(100_000, "--jobs")
    with pytest.raises(InputError, match="--jobs must be at least 1, got 0"):
        require_workers(0, "--jobs")
