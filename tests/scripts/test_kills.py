"""Commands that are killed: no process, no half file, the promised status. `tests/kill_all.py` does it at length."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from kill_plans import PLANS, TAGALONG, room_drive
from kills import Killed, files, kill_once, start
from tagalong.scripts import cli
from tagalong.scripts.console.interruption import interruptible
from tagalong.scripts.console.only_writer import only_writer
from tagalong.scripts.reproduce.experiment import EXPERIMENTS
from tagalong.slam import InputError
from tagalong.slam.logs import write_carmen

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="/proc")
SIGNALS = [signal.SIGKILL, signal.SIGTERM, signal.SIGINT]
CELLS = """
import operator, sys, time
from pathlib import Path
from tagalong.scripts.console.last_words import told
from tagalong.scripts.lab.cells import Cell, run_cells

def slow(value):
    time.sleep(value)
    return {"value": value}

def run():
    run_cells([Cell(name=f"c{v}", function=slow, arguments={"value": v}) for v in (0.2, 30, 40)], "out", jobs=2)

if __name__ == "__main__":
    sys.exit(told(run))
"""
FINALIZER = """
import sys, time
from tagalong.scripts.console.last_words import told

class Slow:
    def __del__(self):
        print("ready", flush=True)
        time.sleep(1.0)

def run():
    Slow()
    time.sleep(30.0)

sys.exit(told(run))
"""
NAMED_TUPLES = """
import sys
from typing import NamedTuple

import numba
from tagalong.scripts.console.last_words import told

class Pair(NamedTuple):
    a: int
    b: int

@numba.njit
def pair(a):
    return Pair(a, a)

def run():
    pair(1)
    print("ready", flush=True)
    while True:
        pair(1)

sys.exit(told(run))
"""
KERNEL = """
import sys, numba
from tagalong.scripts.console.last_words import told

@numba.njit
def kernel(n):
    total = 0
    for i in range(n):
        total = (total * 31 + i) % 1000003
    return total

def run():
    kernel(1)
    print("ready", flush=True)
    for _ in range(1000):
        kernel(100_000_000)

sys.exit(told(run))
"""


@pytest.mark.parametrize("end", SIGNALS)
def test_a_killed_command_leaves_no_process_and_no_half_file(tmp_path, end):
    write_carmen(tmp_path / "room.log.gz", room_drive(1000))
    seen, words = Killed(), ["slam", "room.log.gz", "--out", "out", "--method", "gmapping", "--set", "particles=400"]
    kill_once([*TAGALONG, *words, "--set", "linear_update=0.01"], tmp_path, end, 1.0, seen)
    assert (seen.kills, seen.late, seen.faults) == (1, 0, [])
    assert [path.name for path in files(tmp_path)] == ["room.log.gz"]


@pytest.mark.parametrize("end", SIGNALS)
def test_a_killed_experiment_ends_with_its_workers_and_keeps_finished_cells(tmp_path, end):
    (tmp_path / "cells.py").write_text(CELLS)
    seen, began = Killed(), time.monotonic()
    kill_once(["cells.py"], tmp_path, end, 3.0, seen)
    assert (seen.kills, seen.late, seen.faults) == (1, 0, [])
    assert time.monotonic() - began < 25.0
    assert {path.name for path in files(tmp_path)} <= {"cells.py", "c0.2.json"}


@pytest.mark.parametrize(
    ("program", "times"), [(FINALIZER, 1), (KERNEL, 1), (NAMED_TUPLES, 6)], ids=["finalizer", "kernel", "named tuples"]
)
def test_ctrl_c_is_one_line_wherever_it_comes(tmp_path, program, times):
    (tmp_path / "program.py").write_text(program)
    for _ in range(times):
        process = subprocess.Popen(
            [sys.executable, "program.py"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        )  # fmt: skip
        assert process.stdout is not None
        process.stdout.readline()
        time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
        assert (process.returncode, said) == (130, "tagalong: interrupted\n")


def test_a_command_may_finish_what_it_has_when_it_is_interrupted():
    def run():
        try:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(1.0)
        except KeyboardInterrupt:
            return 0
        return 1

    shells = signal.signal(signal.SIGINT, signal.default_int_handler)  # in the background, shells have it ignored
    try:
        assert interruptible(run, is_program=False) == 0
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, shells)


def test_an_error_that_comes_of_a_signal_is_not_told_as_bad_input(tmp_path):
    program = """
import os, signal, sys
from tagalong.scripts.console.last_words import told
from tagalong.slam.errors import MissingExtraError

class Crashes:
    def __del__(self):
        os.abort()

def run():
    try:
        os.kill(os.getpid(), signal.SIGTERM)
        signal.pause()
    except KeyboardInterrupt:
        global kept
        kept = Crashes()  # as modules of C are that a signal has left half made
        raise MissingExtraError("plots", "viz") from None

sys.exit(told(run))
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (143, "tagalong: terminated\n")


def test_a_signal_lets_an_import_end_before_it_ends_the_program(tmp_path):
    (tmp_path / "module_of_c.py").write_text("""
import os, signal, time

try:
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(0.3)
except BaseException:
    os.abort()  # as modules of C may whose initialisation is cut off
print("imported", flush=True)
""")
    program = """
import sys, time
from tagalong.scripts.console.last_words import told

def run():
    import module_of_c
    time.sleep(10.0)
    print("not ended")

sys.exit(told(run))
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (143, "imported\n", "tagalong: terminated\n")


def test_what_a_signal_left_half_made_says_nothing_as_the_program_ends(tmp_path):
    program = """
import os, signal, sys
from tagalong.scripts.console.last_words import told

class HalfMade:
    def __del__(self):
        raise AttributeError("never set")

kept = HalfMade()

def run():
    HalfMade()
    if sys.argv[1] == "killed":
        os.kill(os.getpid(), signal.SIGTERM)
    return 0

status = told(run)
HalfMade()
sys.exit(status)
"""
    for how, status, complaints in (("killed", 143, 1), ("whole", 0, 3)):
        done = subprocess.run([sys.executable, "-c", program, how], capture_output=True, text=True)
        assert done.returncode == status
        assert done.stderr.count("Exception ignored") == complaints
        assert done.stderr.count("tagalong: terminated\n") == (how == "killed")


def test_a_folder_has_one_writer_at_a_time(tmp_path):
    write_carmen(tmp_path / "room.log.gz", room_drive(1000))
    words = [
        "slam",
        str(tmp_path / "room.log.gz"),
        "--out",
        str(tmp_path / "out"),
        "--method",
        "gmapping",
        "--set",
        "particles=400",
    ]
    first = start([*TAGALONG, *words, "--set", "linear_update=0.01"], tmp_path)
    try:
        while not (tmp_path / "out").exists() and first.poll() is None:
            time.sleep(0.02)
        time.sleep(0.1)
        second = start([*TAGALONG, *words], tmp_path)
        _, said = second.communicate(timeout=60)
        assert first.poll() is None
        assert second.returncode == 2
        assert said.count("\n") == 1
        assert "another command is writing there" in said
    finally:
        first.kill()
        first.communicate()


def test_who_was_refused_leaves_no_folder_behind(tmp_path):
    with pytest.raises(InputError, match="wrong"), only_writer(tmp_path / "a" / "b"):
        raise InputError("wrong")
    assert list(tmp_path.iterdir()) == []
    with only_writer(tmp_path / "a"):
        assert cli.main([*_score(tmp_path), "--json", str(tmp_path / "a" / "scores.json")]) == 2  # a file needs no lock
    with only_writer(tmp_path / "a"):  # the lock went with the block
        pass


def _score(folder):
    np.savetxt(folder / "bad.tum", np.zeros((0, 8)))
    return ["score", str(folder / "bad.tum"), str(folder / "bad.tum")]


def test_the_plans_kill_every_command_that_writes():
    told = {plan.words[2] for plan in PLANS.values() if plan.words[:2] == TAGALONG}
    assert told | {"doctor", "ros"} == set(cli.COMMANDS)  # these write no files
    parts = {tuple(plan.words[2:4]) for plan in PLANS.values()}
    for model in ("legs", "people", "tracker-errors"):  # that of followers is made by scripts
        assert ("train", model) in parts
    for experiment in EXPERIMENTS:
        assert ("reproduce", experiment) in parts


@pytest.mark.parametrize("command", ["reproduce clustering --out o", "results --out o"])
def test_more_processes_than_the_machine_has_use_for_are_refused(tmp_path, monkeypatch, capsys, command):
    monkeypatch.chdir(tmp_path)
    assert cli.main([*command.split(), "--jobs", "100000"]) == 2
    assert "--jobs must not exceed" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
