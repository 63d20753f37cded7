"""`tagalong teleop`: recording, replaying, keys."""

import pytest
from tagalong.agents.teleop import (
    KeyboardStick,
    read_joystick_log,
    record_drive,
    write_joystick_log,
)
from tagalong.scripts.cli import main

KWARGS = {"leader": False, "people_count": 1, "slam": None, "beams": 181, "max_episode_steps": 60}


def test_a_drive_by_keys_is_recorded_until_q_and_replayed(tmp_path, capsys):
    keys = iter(["ww", *[""] * 20, "q"])
    log = record_drive(
        "tagalong/Corridor-v0", KWARGS, 1, lambda env, seed: KeyboardStick(lambda: next(keys), 0.0), "keyboard"
    )
    assert len(log.actions) == 21
    assert len(log.changes) == 1
    write_joystick_log(tmp_path / "log.txt", log)
    assert main(["teleop", "--replay", str(tmp_path / "log.txt")]) == 0
    printed = capsys.readouterr().out
    assert "made by: keyboard" in printed
    assert "operator active [s]" in printed


def test_the_model_records_a_log_that_says_so(tmp_path, capsys):
    short = ["--set", "max_episode_steps=12", "--set", "beams=181"]
    assert main(["teleop", "--operator", "model", "--seed", "2", *short, "--out", str(tmp_path / "log.txt")]) == 0
    log = read_joystick_log(tmp_path / "log.txt")
    assert (log.made_by, len(log.actions)) == ("operator model, not a human", 12)
    assert "not a human" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "named"),
    [
        ([], "--out"),
        (["--replay", "nowhere.txt"], "nowhere"),
        (["--out", "log.txt"], "terminal"),
        (["--out", "x", "--operator", "gamepad", "--gamepad", "no"], "gamepad"),
    ],
)
def test_what_cannot_be_done_is_said(words, named, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.stdin", open("/dev/null"))  # noqa: SIM115
    assert main(["teleop", *words]) == 2
    assert named in capsys.readouterr().err
