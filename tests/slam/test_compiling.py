"""At the first use several processes compile, while the one that asked for a kernel waits for them."""

import os
import time
from importlib import import_module

import pytest
from numba import njit
from tagalong.slam.errors import InputError
from tagalong.slam.first_use import compiling
from tagalong.slam.first_use.compiling import COMPILERS, compile_parts, compiled_together, most_compilers

PARTS = """
import os, time
from pathlib import Path

def note(name, text="", here=Path(__file__).parent):
    with open(here / name, "a") as file:
        file.write(text + "\\n")

def first():
    note("first", os.environ["TAGALONG_COMPILERS"])

def second():
    note("second")

def failing():
    note("failing")
    os._exit(1)

def endless():
    note("endless", str(os.getpid()))
    time.sleep(600.0)

def brief():
    note("times", f"{time.monotonic()}")
    time.sleep(0.5)
    note("times", f"{time.monotonic()}")
"""


@pytest.fixture
def parts(tmp_path, monkeypatch):
    name = f"parts_of_{tmp_path.name.replace('-', '_')}"
    (tmp_path / f"{name}.py").write_text(PARTS)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv(COMPILERS, "2")
    return import_module(name)


def written(tmp_path, name):
    path = tmp_path / name
    return path.read_text().split() if path.exists() else None


def compile_something():
    njit(lambda x: x + 1)(1)


def is_alive(number):
    try:
        os.kill(number, 0)
    except OSError:
        return False
    return True


def test_the_first_kernel_waits_until_all_parts_are_compiled(parts, tmp_path):
    with compiled_together(parts.first, parts.second):
        assert written(tmp_path, "first") is None
        compile_something()
        assert written(tmp_path, "first") == ["1"]  # who helps has no helpers
        assert written(tmp_path, "second") == []
        compile_something()
    compile_something()
    assert written(tmp_path, "first") == ["1"]


def test_it_is_said(parts, caplog):
    with compiled_together(parts.first, parts.second):
        compile_something()
    assert caplog.messages == ["compiling by 2 processes: once on this machine, about a minute"]


def test_where_nothing_is_compiled_nothing_happens(parts, tmp_path):
    function = njit(lambda x: x + 1)
    function(1)
    with compiled_together(parts.first, parts.second):
        function(1)
    assert written(tmp_path, "first") is None


@pytest.mark.parametrize("how", ["one core", "one part", "a worker"])
def test_who_has_nobody_to_share_with_compiles_alone(parts, tmp_path, monkeypatch, how):
    if how == "one core":
        monkeypatch.setenv(COMPILERS, "1")
    if how == "a worker":
        monkeypatch.setattr(compiling, "parent_process", lambda: "another")
    with compiled_together(parts.first, *([] if how == "one part" else [parts.second])):
        compile_something()
    assert written(tmp_path, "first") is None


def test_a_part_that_fails_keeps_nobody(parts, tmp_path):
    with compiled_together(parts.failing, parts.second):
        compile_something()
    assert written(tmp_path, "failing") == []
    assert written(tmp_path, "second") == []


def test_no_process_to_be_had_keeps_nobody(parts, tmp_path, monkeypatch):
    monkeypatch.setattr(compiling.sys, "executable", str(tmp_path / "no python"))
    with compiled_together(parts.first, parts.second):
        compile_something()
    assert written(tmp_path, "first") is None


def test_a_part_that_takes_for_ever_is_given_up(parts, tmp_path, monkeypatch):
    monkeypatch.setattr(compiling, "PATIENCE_S", 3.0)
    compile_parts([parts.endless, parts.second], 2)
    assert written(tmp_path, "second") == []
    assert not is_alive(int(written(tmp_path, "endless")[0]))


def test_an_interrupt_ends_the_processes(parts, tmp_path, monkeypatch):
    def interrupt_when_it_runs(_):
        time.sleep(0.05)
        if written(tmp_path, "endless"):
            raise KeyboardInterrupt

    monkeypatch.setattr(compiling, "sleep", interrupt_when_it_runs)
    with pytest.raises(KeyboardInterrupt):
        compile_parts([parts.endless], 2)
    assert not is_alive(int(written(tmp_path, "endless")[0]))


def test_no_more_processes_run_than_were_asked_for(parts, tmp_path):
    compile_parts([parts.brief] * 3, 1)
    times = [float(text) for text in written(tmp_path, "times")]
    assert len(times) == 6
    assert times == sorted(times)
    assert all(end - begin >= 0.4 for begin, end in zip(times[::2], times[1::2], strict=True))


def test_a_core_each_unless_the_variable_says_otherwise(monkeypatch):
    monkeypatch.delenv(COMPILERS, raising=False)
    assert 1 <= most_compilers() <= (os.cpu_count() or 1)
    monkeypatch.setenv(COMPILERS, "7")
    assert most_compilers() == 7
    for wrong in ("0", "-1", "two", "", "1.5"):
        monkeypatch.setenv(COMPILERS, wrong)
        with pytest.raises(InputError, match=f"{COMPILERS} must be a whole number from 1 on, got '{wrong}'"):
            most_compilers()
