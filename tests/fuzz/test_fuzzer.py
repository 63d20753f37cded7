"""The suite itself: the same seed sends the same inputs, and what goes wrong is found and named."""

import os
import signal
import time

import numpy as np
import pytest
from borders.areas import AREAS
from fuzzer.border import Border, InsaneError
from fuzzer.codec import decoded, encoded
from fuzzer.supervisor import sent
from fuzzer.worker import Inputs, draws
from tagalong.slam import InputError

BORDERS = [border for area in AREAS.values() for border in area.borders]


def number_of(rng):
    return int(rng.integers(10))


def border(call, **more):
    return Border(name="test.door", make=number_of, call=call, **more)


def refuse(value, folder):
    raise InputError(f"file.txt: got {value}")


def insane(result):
    raise InsaneError("nonsense")


@pytest.mark.parametrize("one", BORDERS, ids=lambda one: one.name)
def test_an_input_is_the_same_whatever_was_drawn_before_and_survives_a_file(one):
    values = [encoded(one.make(draws(one, 3, 5))) for _ in range(2)]
    one.make(draws(one, 3, 6))
    assert repr(values[0]) == repr(values[1]) == repr(encoded(decoded(values[0])))  # a NaN equals no NaN
    assert encoded(one.make(draws(one, 4, 5))) is not None


def test_what_is_refused_in_one_line_that_names_the_file_is_no_finding(tmp_path):
    tally = sent(border(refuse, file="file.txt"), Inputs(1, range(20)), tmp_path)
    assert (tally.inputs, tally.accepted, tally.refused, tally.findings) == (20, 0, 20, [])


def test_what_is_accepted_and_makes_no_sense_is_a_finding(tmp_path):
    tally = sent(border(lambda value, folder: value, sane=insane), Inputs(1, range(3)), tmp_path)
    assert [found["kind"] for found in tally.findings] == ["nonsense accepted"] * 3


@pytest.mark.parametrize(
    ("message", "kind"),
    [("x" * 601, "long message"), ("two\nlines", "message of several lines"), ("no name", "message without the file")],
)
def test_a_refusal_that_is_not_as_promised_is_a_finding(tmp_path, message, kind):
    def call(value, folder):
        raise InputError(message if "name" in message else f"file.txt {message}")

    (found,) = sent(border(call, file="file.txt"), Inputs(1, range(1)), tmp_path).findings
    assert found["kind"].startswith(kind)


def test_a_crash_names_its_input_and_the_others_go_on(tmp_path):
    def call(value, folder):
        if value == 3:
            os.kill(os.getpid(), signal.SIGSEGV)

    numbers = [number_of(draws(border(call), 1, k)) for k in range(30)]
    tally = sent(border(call), Inputs(1, range(30)), tmp_path)
    assert [found["number"] for found in tally.findings] == [k for k, value in enumerate(numbers) if value == 3]
    assert tally.inputs == 30
    assert {found["kind"] for found in tally.findings} == {"crash"}


def test_a_hang_names_its_input(tmp_path, monkeypatch):
    monkeypatch.setattr("fuzzer.supervisor.HANG_S", 0.3)

    def call(value, folder):
        time.sleep(60.0 * (value == number_of(draws(border(refuse), 1, 2))))

    tally = sent(border(call), Inputs(1, range(2, 4)), tmp_path)
    assert [found["kind"] for found in tally.findings if found["number"] == 2] == ["hang"]


def test_memory_above_a_gigabyte_is_a_finding_even_where_the_error_is_caught(tmp_path):
    def call(value, folder):
        try:
            np.ones(2**29)
        except MemoryError as error:
            raise InputError("file.txt is too large") from error

    (found,) = sent(border(call), Inputs(1, range(1)), tmp_path).findings
    assert found["kind"] == "memory"
