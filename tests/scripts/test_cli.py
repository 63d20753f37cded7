"""What every command promises: bad input is told in one line before any work is done, with exit status 2."""

import json

import pytest
from tagalong.scripts.cli import main, make_parser
from tagalong.slam import InputError
from tagalong.slam.engine import ENGINES


def test_an_output_folder_that_cannot_be_is_told_before_the_work(tmp_path, capsys, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setattr("tagalong.scripts.commands.bench.run", lambda options: pytest.fail("it began to work"))
    assert main(["bench", "speed", "--out", str(tmp_path / "file" / "deep" / "out")]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"tagalong: {tmp_path}/file/deep/out: cannot be written ({tmp_path}/file: ")
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        ("demo --out FILE", "is a file, where a folder has to be written"),
        ("demo --method slow", "unknown SLAM engine 'slow'"),
        ("demo --set hight=3", "hight"),
        ("demo --set slam=ekf", "--set: the demo sets `slam` itself, by --method"),
        ("evaluate pid --out FILE", "is a file, where a folder has to be written"),
        ("evaluate ..FILE:A", "named as module:class"),
        ("evaluate damaged:A", "named as module:class, got 'damaged:A' (invalid syntax (damaged.py, line 1))"),
        ("teleop --operator model --out FOLDER", "is a folder, where a file has to be written"),
        ("teleop --operator gamepad --out new --gamepad FOLDER", "no gamepad at"),
        (
            "bench speed --steps 0",
            "argument --steps: must be a whole number of at least 1, got '0' (see tag",
        ),
        ("score FILE FILE --json FOLDER", "is a folder, where a file has to be written"),
        ("reproduce all --out new --pages FILE", "is a file, where a folder has to be written"),
        ("results --readme FILE", "needs the marks"),
        ("evaluate random --people 0", "argument --people: must be a whole number of at least 1"),
        ("perceive FILE --out new --min-confidence nan", "--min-confidence: must be a number within 0 .. 1, got 'nan'"),
        ("perceive FILE --out new --min-confidence 2", "--min-confidence: must be a number within 0 .. 1, got '2'"),
        ("results --readme nowhere", "nowhere: cannot be read"),
    ],
)
def test_what_cannot_end_well_does_not_begin(words, complaint, tmp_path, capsys, monkeypatch):
    (tmp_path / "FILE").write_text("no table")
    (tmp_path / "damaged.py").write_text("def f(:")
    (tmp_path / "FOLDER").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("TAGALONG_DATA", raising=False)
    assert main(words.split()) == 2
    printed = capsys.readouterr()
    assert complaint in printed.err
    assert printed.err.count("\n") == 1
    assert "following the leader" not in printed.out


def test_the_demo_hands_settings_to_its_environment(capsys, monkeypatch):
    seen = []

    def run_demo(tour, mapping, watch, settings, record, live):
        seen.append(settings)
        raise InputError("enough")

    monkeypatch.setattr("tagalong.scripts.runs.demo_run.run_demo", run_demo)
    assert main(["demo", "--set", "robot=pioneer", "--set", "lidar.height=0.3"]) == 2
    assert capsys.readouterr().err == "tagalong: enough\n"
    assert seen == [{"robot": "pioneer", "lidar.height": 0.3}]


def test_a_suite_is_an_environment_of_its_own(capsys):
    assert main(["evaluate", "pid", "--suite", "corridor", "--env", "tagalong/Office-v0"]) == 2
    assert "not allowed with argument" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("who", "complaint"),
    [
        ("nobody", "unknown follower 'nobody'"),
        ("FOLDER", "a policy is a shipped one"),
        ("a:b", "named as module:class"),
        ("json:loads", "json:loads is made without arguments, or with `interface` alone"),
        ("json:JSONDecoder", "a follower has `reset()` and `act(observation)`"),
    ],
)
def test_who_does_not_exist_is_told_before_any_drive(who, complaint, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("tagalong.scripts.commands.evaluate.rollout", lambda *_, **__: pytest.fail("it drove"))
    assert main(["evaluate", str(tmp_path) if who == "FOLDER" else who, "--beams", "181"]) == 2
    error = capsys.readouterr().err
    assert complaint in error
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    ("setting", "complaint"),
    [
        ("robot=tank", "unknown robot 'tank'; robots: dingo-d, dingo-o, pioneer"),
        ("perception.removal.zeta=wide", "`zeta` must be a number, got 'wide'"),
        ("robot", "--set needs NAME=VALUE, got 'robot'"),
    ],
)
def test_settings_of_the_environment_that_make_no_sense_are_told_before_any_drive(setting, complaint, capsys):
    assert main(["evaluate", "pid", "--set", setting]) == 2
    assert complaint in capsys.readouterr().err


def test_a_follower_is_evaluated_in_the_environment_that_settings_describe(tmp_path):
    settings = ["--set", "robot=pioneer", "--set", "lidar.range_max=1.0", "--set", "lost_limit_s=0.3"]
    assert main(["evaluate", "pid", "--episodes", "1", *settings, "--out", str(tmp_path)]) == 0
    told = json.loads((tmp_path / "evaluation.json").read_text())
    assert told["options"]["settings"] == settings[1::2]
    assert told["episodes"][0]["duration_s"] < 2.0


@pytest.mark.parametrize("command", ["slam", "demo"])
def test_the_engines_of_slam_are_named_in_the_help(command, capsys):
    with pytest.raises(SystemExit):
        main([command, "--help"])
    assert " ".join(capsys.readouterr().out.split()).count(f"SLAM engine: {', '.join(ENGINES)}") == 1


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        ("--seconds 99999999999999999999", "--seconds: must be a positive number of at most 86400"),
        ("--seeds 99999999999999999999", "--seeds: must be at most 1000000"),
        ("--first-seed 4294967296", "--first-seed: must be at most 4294967295"),
    ],
)
def test_a_count_that_nobody_lives_to_see_the_end_of_is_told(words, complaint):
    with pytest.raises(InputError, match=complaint):
        make_parser().parse_args(["bench", "people", *words.split()])


@pytest.mark.parametrize(
    "words",
    [
        "clustering --worlds", "following --repeats", "guidance --repeats", "immobile --seeds", "immobile --first-seed",
        "scan-matching --trials",
    ],
)  # fmt: skip
@pytest.mark.parametrize("count", ["-1", "9" * 40])
def test_no_experiment_begins_to_list_more_cells_than_anybody_waits_for(words, count):
    with pytest.raises(InputError, match=f"argument {words.split()[1]}: must be"):
        make_parser().parse_args(["reproduce", *words.split(), count])


def test_a_log_that_is_a_link_to_itself_is_told_by_its_name(tmp_path, capsys):
    (tmp_path / "loop.log").symlink_to("loop.log")
    words = ["--log", str(tmp_path / "loop.log"), "--steps", "0", "--laps", "2", "--out", str(tmp_path / "out")]
    assert main(["bench", "soak", *words]) == 2
    assert "loop.log" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "command"), [("perceive a.log --quite", "perceive"), ("bench people b", "bench people")]
)
def test_words_that_a_command_does_not_know_point_to_its_own_help(words, command, tmp_path):
    with pytest.raises(InputError, match=rf"unrecognized arguments: \S+ \(see tagalong {command} --help\)"):
        make_parser().parse_args([*words.split(), "--out", str(tmp_path)])
