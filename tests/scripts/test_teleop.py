"""`tagalong teleop`: recording, replaying, keys."""

import numpy as np
import pytest
from tagalong.agents.joystick import JoystickLog, read_joystick_log, write_joystick_log
from tagalong.agents.operator_model import OperatorConfig, Sight
from tagalong.scripts.cli import main
from tagalong.scripts.experiments.joystick_drive import record_drive
from tagalong.scripts.experiments.keyboard import KeyboardStick

SIGHT = Sight(np.zeros(3), 0.0, np.empty((0, 2)))
KWARGS = {"leader": False, "people_count": 1, "slam": None, "beams": 181, "max_episode_steps": 60}


def stick_of(*typed):
    pieces = iter(typed)
    return KeyboardStick(lambda: next(pieces, ""), 0.0)


def test_keys_move_the_stick_by_notches_and_space_lets_go():
    stick, config = stick_of("w", "ww\x1b[D", "", "wwwwww", " "), OperatorConfig()
    seen = [stick.act(SIGHT) / (config.full_speed, config.full_turn) * config.levels for _ in range(5)]
    assert np.allclose(seen, [(1, 0), (3, 1), (3, 1), (4, 1), (0, 0)])


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


def test_the_model_records_a_log_that_says_so(tmp_path, monkeypatch, capsys):
    made = JoystickLog("operator model, not a human", "tagalong/Corridor-v0", KWARGS, 2, np.ones((3, 2), np.float32))
    monkeypatch.setattr("tagalong.scripts.experiments.joystick_drive.record_drive", lambda *a, **k: made)
    assert main(["teleop", "--operator", "model", "--seed", "2", "--out", str(tmp_path / "log.txt")]) == 0
    assert read_joystick_log(tmp_path / "log.txt").made_by == "operator model, not a human"
    assert "not a human" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "named"),
    [([], "--out"), (["--replay", "nowhere.txt"], "nowhere"), (["--out", "log.txt"], "terminal")],
)
def test_what_cannot_be_done_is_said(words, named, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.stdin", open("/dev/null"))  # noqa: SIM115
    assert main(["teleop", *words]) == 2
    assert named in capsys.readouterr().err
