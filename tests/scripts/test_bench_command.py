"""What `tagalong bench` promises: each has help, and what a user does wrong is told in a line or two, before work."""

import argparse
import json

import pytest
from tagalong.scripts import cli
from tagalong.scripts.benchmarks.benchmark import BENCHMARKS, load_benchmark
from tagalong.scripts.benchmarks.results import write_results
from tagalong.scripts.console.last_words import told
from tagalong.slam import InputError


@pytest.mark.parametrize(
    "words",
    [
        "recall-by-distance --seeds 0",
        "recall-by-distance --seconds nan",
        "people --seeds 0",
        "people --people none",
        "people --seconds 0",
        "people --first-seed -1",
        "people-recorded --scans 0",
        "people-by-sensor --seconds -3",
        "people-by-sensor --first-seed -1",
        "rgbd-people --seeds 0",
        "rgbd-planes --seeds 1.5",
        "simulators --episodes 0",
    ],
)
def test_numbers_that_make_no_sense_are_refused_by_their_option(words, capsys, tmp_path):
    assert cli.main(["bench", *words.split(), "--out", str(tmp_path / "out")]) == 2
    name, option, value = words.split()
    error = capsys.readouterr().err
    assert f"tagalong: argument {option}: must be a" in error
    assert error.endswith(f"got {value!r} (see tagalong bench {name} --help)\n")
    assert not (tmp_path / "out").exists()


def test_what_a_user_did_wrong_is_told_in_one_line(capsys):
    def fails():
        raise InputError("no such thing")

    assert told(fails) == 2
    assert capsys.readouterr().err == "tagalong: no such thing\n"
    assert told(lambda: 1) == 1


def test_a_benchmark_tells_it_so(tmp_path, capsys):
    assert cli.main(["bench", "people", "--preset", "nothing", "--out", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.startswith("tagalong: unknown preset 'nothing'")
    assert error.count("\n") == 1


def test_without_a_name_the_benchmarks_are_listed_with_a_line_each(capsys):
    assert cli.main(["bench"]) == 0
    lines = capsys.readouterr().out.splitlines()[2:]
    assert [line.split()[0] for line in lines] == list(BENCHMARKS)
    assert cli.main(["bench", "nothing"]) == 2
    assert "invalid choice: 'nothing'" in capsys.readouterr().err
    with pytest.raises(InputError, match="unknown benchmark 'nothing'; "):
        load_benchmark("nothing")


@pytest.mark.parametrize("name", BENCHMARKS)
def test_every_benchmark_has_help_with_an_example(name, capsys):
    with pytest.raises(SystemExit) as ended:
        cli.main(["bench", name, "--help"])
    assert ended.value.code == 0
    told_user = capsys.readouterr().out
    assert f"\n  tagalong bench {name} " in told_user
    assert f"(default: out/bench/{name})" in " ".join(told_user.split())


def test_results_hold_what_was_asked_for_and_the_machine(tmp_path):
    options = argparse.Namespace(command="bench", name="people", run=None, out=tmp_path, seeds=3)
    write_results(options, {"figures": {"mota": 0.5}})
    written = json.loads((tmp_path / "results.json").read_text())
    assert written["options"] == {"seeds": 3}
    assert written["figures"] == {"mota": 0.5}
    assert written["machine"]["cores"] >= 1
