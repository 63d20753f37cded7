"""How commands end when the world outside does not do what they want: in one line, with an exit status."""

import os
import subprocess
import sys

import pytest
from tagalong.scripts.cli import main
from tagalong.scripts.console.last_words import exit_status
from tagalong.slam import InputError
from tagalong.slam.errors import MissingExtraError


def ends(error: BaseException):
    def run() -> int:
        raise error

    return exit_status(run)


@pytest.mark.parametrize(
    ("error", "line"),
    [
        (InputError("a.log:3: cut"), "tagalong: a.log:3: cut\n"),
        (InputError("two\nlines \x1b[31m"), "tagalong: two lines \\x1b[31m\n"),
        (MissingExtraError("figures", "viz"), 'tagalong: figures need the extra "viz": pip install "tagalong[viz]"\n'),
        (OSError(28, "No space left on device"), "tagalong: cannot be written (No space left on device)\n"),
        (PermissionError(13, "Permission denied", "out/a"), "tagalong: out/a: Permission denied\n"),
        (MemoryError("Unable to allocate 9 GiB"), "tagalong: there is not enough memory for this (Unable to allo"),
        (RecursionError("maximum recursion depth exceeded"), "tagalong: something in what was given is nested too"),
        (OverflowError("int too large"), "tagalong: a number in what was given is too large (int too large)\n"),
        (BrokenPipeError(32, "Broken pipe"), "tagalong: Broken pipe\n"),
    ],
)
def test_what_is_wrong_outside_is_told_in_one_line(error, line, capsys):
    assert ends(error) == 2
    said = capsys.readouterr().err
    assert said.startswith(line)
    assert said.count("\n") == 1


def test_a_message_of_thousands_of_characters_keeps_its_ends(capsys):
    assert ends(InputError("begin " + "x" * 5000 + " end")) == 2
    said = capsys.readouterr().err
    assert len(said) < 520
    assert said.startswith("tagalong: begin xx")
    assert said.endswith("xx end\n")


def test_an_error_of_the_program_itself_comes_out_as_it_is():
    with pytest.raises(KeyError):
        ends(KeyError("mistake"))


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize(
    ("words", "sink", "status", "line"),
    [
        ("print('x' * 100)", "/dev/full", 2, "tagalong: cannot be written (No space left on device)\n"),
        ("print('x' * 100_000)", "/dev/full", 2, "tagalong: cannot be written (No space left on device)\n"),
        ("print('x' * 100_000)", "closed pipe", 141, ""),
    ],
)
def test_output_that_is_not_taken_ends_without_a_traceback(words, sink, status, line, unbuffered):
    if sink == "/dev/full" and not os.path.exists(sink):
        pytest.skip("this system has no /dev/full")
    door = "from tagalong.scripts.console.last_words import exit_status"
    code = f"import sys; {door}; sys.exit(exit_status(lambda: {words} or 0))"
    if sink == "closed pipe":
        read, out = os.pipe()
        os.close(read)
    else:
        out = os.open(sink, os.O_WRONLY)
    environment = {**os.environ, "PYTHONUNBUFFERED": unbuffered}
    try:
        ended = subprocess.run(
            [sys.executable, "-c", code], stdout=out, stderr=subprocess.PIPE, text=True, timeout=60, env=environment
        )
    finally:
        os.close(out)
    assert (ended.returncode, ended.stderr) == (status, line)


@pytest.mark.parametrize("log", ["/dev/zero", "pipe", ".", "n" * 5000])
def test_a_log_that_is_no_file_is_refused_at_once(log, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe")
    for words in (
        f"slam {log} --out out",
        f"perceive {log} --out out",
        f"localize log --map {log} --out out",
        f"score {log} {log}",
        f"teleop --replay {log}",
        f"results --readme {log} --out out",
    ):
        assert main(words.split()) == 2
        said = capsys.readouterr().err
        assert said.startswith("tagalong: ")
        assert said.count("\n") == 1
        assert len(said) < 600


def test_an_option_of_thousands_of_digits_is_not_repeated_whole(capsys):
    assert main(["slam", "a.log", "--out", "out", "--seed", "9" * 5000]) == 2
    said = capsys.readouterr().err
    assert len(said) < 600
    assert said.count("\n") == 1
    assert said.endswith("(see tagalong slam --help)\n")
