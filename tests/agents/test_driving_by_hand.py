"""Keys and gamepads as sticks, drives recorded with them, and the shipped logs."""

import numpy as np
import pytest
from tagalong.agents.teleop.gamepad import AXIS, BUTTON, EVENT, FULL, GamepadStick, gamepad_events
from tagalong.agents.teleop.joystick import MODEL, SHIPPED, read_joystick_log
from tagalong.agents.teleop.joystick_drive import record_drive, replay_drive
from tagalong.agents.teleop.keyboard import KeyboardStick
from tagalong.agents.teleop.operator_model import OperatorConfig, OperatorView
from tagalong.envs import FollowEnv

SIGHT = OperatorView(np.zeros(3), 0.0, np.empty((0, 2)))
KWARGS = {"leader": False, "people_count": 1, "slam": None, "beams": 181, "max_episode_steps": 60}


def stick_of(*typed):
    pieces = iter(typed)
    return KeyboardStick(lambda: next(pieces, ""), 0.0)


def test_keys_move_the_stick_by_notches_and_space_lets_go():
    stick, config = stick_of("w", "ww\x1b[D", "", "wwwwww", " "), OperatorConfig()
    seen = [stick.act(SIGHT) / (config.full_speed, config.full_turn) * config.levels for _ in range(5)]
    assert np.allclose(seen, [(1, 0), (3, 1), (3, 1), (4, 1), (0, 0)])


@pytest.mark.parametrize("while_stepping", [False, True])
def test_ctrl_c_ends_a_drive_by_hand_and_keeps_its_log(while_stepping, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    def keys():
        typed.append("w")
        if len(typed) == 8:
            monkeypatch.setattr(FollowEnv, "step", interrupt) if while_stepping else interrupt()
        return "w"

    typed = []
    hand = {"operator": lambda env, seed: KeyboardStick(keys, 0.0), "made_by": "keyboard"}
    log = record_drive("tagalong/Corridor-v0", KWARGS, 1, **hand, by_hand=True)
    assert len(log.actions) == 7
    typed.clear()
    with pytest.raises(KeyboardInterrupt):  # an experiment that is interrupted has no drive
        record_drive("tagalong/Corridor-v0", KWARGS, 1, **hand)


def test_a_gamepad_drives_and_its_start_button_ends(tmp_path):
    config = OperatorConfig()
    events = [(0, -FULL, AXIS, 1), (0, FULL, AXIS, 0), (0, 9, AXIS, 4)], [(0, 900, AXIS, 0)], [(0, 1, BUTTON, 7)]
    pieces = iter([b"".join(EVENT.pack(*event) for event in part) for part in events])
    stick = GamepadStick(lambda: next(pieces), 0.0, config)
    assert stick.act(SIGHT) == pytest.approx((config.full_speed, -config.full_turn))
    assert stick.act(SIGHT) == pytest.approx((config.full_speed, 0.0))
    with pytest.raises(EOFError):
        stick.act(SIGHT)


def test_a_gamepad_is_read_as_a_device(tmp_path):
    (tmp_path / "js0").write_bytes(EVENT.pack(5, -FULL, AXIS | 128, 1))
    with gamepad_events(tmp_path / "js0") as events:
        assert EVENT.unpack(events()) == (5, -FULL, AXIS | 128, 1)
        with pytest.raises(EOFError):
            events()


def test_recording_without_slam_changes_nothing_and_the_header_keeps_it():
    kwargs = {**KWARGS, "slam": "gmapping", "max_episode_steps": 12}
    log = record_drive("tagalong/Corridor-v0", kwargs, 3)
    plain = record_drive("tagalong/Corridor-v0", {**kwargs, "slam": None}, 3)
    assert log.kwargs["slam"] == "gmapping"
    assert log.actions.tobytes() == plain.actions.tobytes()


def test_shipped_logs_say_that_a_model_made_them():
    logs = {path.stem: read_joystick_log(path.stem) for path in SHIPPED.glob("*.txt")}
    assert set(logs) == {"corridor", "meeting_room", "office"}
    assert {log.made_by for log in logs.values()} == {MODEL}


def test_a_shipped_log_replays_until_the_whole_floor_was_seen():
    log = read_joystick_log("meeting_room")
    episode = replay_drive(log)
    assert episode.ending == "covered"
    assert len(episode.history) == len(log.actions) + 1
