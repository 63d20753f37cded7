"""Joystick logs and the operator model; no simulator but for one short replay."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tagalong.agents.teleop.joystick import (
    FIRST_LINE,
    MODEL,
    JoystickLog,
    JoystickReplay,
    read_joystick_log,
    write_joystick_log,
)
from tagalong.agents.teleop.joystick_drive import record_drive, replay_drive
from tagalong.agents.teleop.operator_model import OperatorConfig, OperatorModel, OperatorView
from tagalong.slam import InputError

NOBODY = np.empty((0, 2))


def some_log():
    actions = np.zeros((10, 2), dtype=np.float32)
    actions[2:7] = (0.5, 0.0)
    actions[4:6] = (0.5, -0.25)
    return JoystickLog("keyboard", "tagalong/Corridor-v0", {"leader": False, "people_count": 2}, 3, actions)


def test_a_log_is_a_small_text_file_that_reads_back_equal(tmp_path):
    write_joystick_log(tmp_path / "log.txt", some_log())
    text = (tmp_path / "log.txt").read_text()
    assert text.startswith(FIRST_LINE)
    assert len(text.splitlines()) == 8 + 4
    back = read_joystick_log(tmp_path / "log.txt")
    assert np.array_equal(back.actions, some_log().actions)
    assert (back.made_by, back.env, back.kwargs, back.seed) == (
        "keyboard",
        "tagalong/Corridor-v0",
        some_log().kwargs,
        3,
    )


def test_commands_and_active_seconds_are_counted():
    assert some_log().changes.tolist() == [2, 4, 6, 7]
    assert some_log().active_s == pytest.approx(0.5)


def test_replay_acts_as_recorded_and_then_stands_still():
    log = some_log()
    replay = JoystickReplay(log, log.env, log.kwargs, log.seed)
    first = [replay.act(None) for _ in range(12)]
    assert np.array_equal(first[:10], log.actions)
    assert not np.any(first[10:])
    replay.reset()
    assert np.array_equal([replay.act(None) for _ in range(10)], log.actions)


@pytest.mark.parametrize(
    ("env", "kwargs", "seed", "named"),
    [
        ("tagalong/Office-v0", {"leader": False, "people_count": 2}, 3, "environment"),
        ("tagalong/Corridor-v0", {"leader": False, "people_count": 3}, 3, "arguments"),
        ("tagalong/Corridor-v0", {"leader": False, "people_count": 2}, 4, "seed"),
    ],
)
def test_replay_refuses_another_environment_other_arguments_or_another_seed(env, kwargs, seed, named):
    with pytest.raises(InputError, match=named):
        JoystickReplay(some_log(), env, kwargs, seed)


@pytest.mark.parametrize("text", ["", "something else", "x" * 5000, f"{FIRST_LINE}\nseed: x\nstep forward turn\n"])
def test_what_is_no_log_is_refused(tmp_path, text):
    (tmp_path / "log.txt").write_text(text)
    with pytest.raises(InputError, match=r"log\.txt") as error:
        read_joystick_log(tmp_path / "log.txt")
    assert len(str(error.value)) < 400 + len(str(tmp_path))
    with pytest.raises(InputError, match="nowhere"):
        read_joystick_log(tmp_path / "nowhere.txt")


@pytest.mark.parametrize(
    ("was", "now", "said"),
    [
        ("kwargs: {", "kwargs: 3 {", "damaged"),
        ('kwargs: {"leader": false, "people_count": 2}', "kwargs: 3", "names with values"),
        ("step_s: 0.1", "step_s: nan", "time in seconds"),
        ("steps: ", "steps: 99999999999", "steps"),
        ("steps: ", "steps: -", "steps"),
        ("step forward turn", "step forward turn\n-3 0.5 0.0", "not negative"),
        ("step forward turn", "step forward turn\n0 nan 0.0", "the stick"),
        ("step forward turn", "step forward turn\n0 1.5 0.0", "the stick"),
        ("made by: keyboard", "made by: \udcff", "expected a text file"),
        ("seed: 3", "seed: -3", "seed"),
    ],
)
def test_damage_to_a_log_is_named(tmp_path, was, now, said):
    write_joystick_log(tmp_path / "log.txt", some_log())
    text = (tmp_path / "log.txt").read_text()
    assert was in text
    (tmp_path / "log.txt").write_text(text.replace(was, now, 1), errors="surrogateescape")
    with pytest.raises(InputError, match=rf"log\.txt.*{said}"):
        read_joystick_log(tmp_path / "log.txt")


def drive(route, seconds, people=NOBODY, config=None, start=(0.0, 0.0, 0.0)):
    """Let the operator drive an ideal robot; return rows of (x, y, theta, speed, turn)."""
    operator = OperatorModel(np.asarray(route, dtype=float), np.random.default_rng(0), config)
    pose, rows = np.array(start), []
    for _ in range(int(seconds * 10)):
        speed, turn = operator.act(OperatorView(pose.copy(), float(pose[0]), people))
        pose += np.array([speed * math.cos(pose[2]), speed * math.sin(pose[2]), turn]) * 0.1
        rows.append((*pose, speed, turn))
    return np.array(rows)


def test_the_operator_follows_the_way_at_full_stick():
    rows = drive([(0, 0), (30, 0)], 20.0)
    assert rows[-1, 0] > 10.0
    assert np.abs(rows[:, 1]).max() < 0.5
    assert rows[:, 3].max() <= OperatorConfig().full_speed


def test_the_operator_steers_in_steps_of_the_stick_and_too_much():
    rows = drive([(0, 0), (30, 0)], 20.0, start=(0.0, 0.6, 0.4))
    turns = rows[:, 4] / OperatorConfig().full_turn * OperatorConfig().levels
    assert np.allclose(turns, np.round(turns))
    signs = np.sign(turns[turns != 0.0])
    assert np.sum(np.diff(signs) != 0) >= 2, "never corrected back"


def test_the_operator_reacts_late():
    config = OperatorConfig(reaction_s=0.5, hold_s=0.1, stuck_s=100.0)
    operator = OperatorModel(np.array([(0.0, 0.0), (30.0, 0.0)]), np.random.default_rng(0), config)
    for _ in range(30):
        operator.act(OperatorView(np.zeros(3), 0.0, NOBODY))
    turned = [operator.act(OperatorView(np.array([0.0, 0.0, 0.9]), 0.0, NOBODY))[1] for _ in range(12)]
    assert not np.any(turned[:4])
    assert turned[-1] < -0.4


def test_the_operator_stops_for_somebody_in_front():
    rows = drive([(0, 0), (30, 0)], 15.0, people=np.array([[4.0, 0.1]]))
    assert 2.0 < rows[-1, 0] < 3.6
    assert rows[-1, 3] == 0.0


def test_a_drive_recorded_in_the_closed_loop_is_the_same_in_the_open_loop():
    kwargs = {"leader": False, "people_count": 1, "slam": None, "beams": 181, "max_episode_steps": 80}
    poses = []
    log = record_drive("tagalong/Corridor-v0", kwargs, 2, watch=lambda env: poses.append(env.truth.robot_pose))
    assert log.made_by == MODEL
    assert len(log.actions) == 80
    episode = replay_drive(log)
    assert np.array_equal(episode.history.robot_pose[:-1], poses)
    assert episode.metrics["path_length_m"] > 1.0


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"env": "nowhere-v0"}, "unknown environment 'nowhere-v0'"),
        ({"env": "tagalong/Corridor-v9"}, "unknown environment"),
        ({"env": "a:b-v0"}, "unknown environment"),
        ({"env": "CartPole-v1"}, "unknown environment"),
        ({"step_s": 0.2}, r"steps of 0.2 s, its environment 10"),
    ],
)
def test_a_log_of_no_environment_of_ours_is_not_replayed(changes, said):
    with pytest.raises(InputError, match=said):
        replay_drive(replace(some_log(), **changes))


def test_the_operator_backs_out_when_the_robot_is_stuck():
    operator = OperatorModel(np.array([(0.0, 0.0), (30.0, 0.0)]), np.random.default_rng(0))
    speeds = [operator.act(OperatorView(np.zeros(3), 0.0, NOBODY))[0] for _ in range(80)]
    assert max(speeds[:20]) > 0.5
    assert min(speeds) < -0.2


@pytest.mark.parametrize(
    ("was", "now", "said"),
    [
        ("steps: 4", f"steps: {'9' * 5000}", "steps"),
        ("steps: 4", "steps: 9999999", "steps: 0 to 1000000"),
        ("seed: 3", f"seed: {'9' * 5000}", "seed"),
        ("kwargs: {}", "kwargs: " + "[" * 100_000, "nested too deeply"),
        ("kwargs: {}", "kwargs: " + "x" * 5000, "kwargs"),
        ("2 0.5 0.1", "0 0.5 0.1", "ascending"),
        ("2 0.5 0.1", "2 0.5 0.1 7", "ascending"),
        ("2 0.5 0.1", "2 0.5 " + "x" * 5000, "could not convert"),
    ],
)
def test_a_joystick_log_is_held_against_its_header(was, now, said, tmp_path):
    log = "\n".join(
        (
            "tagalong joystick log 1",
            *("made by: me", "env: e", "kwargs: {}", "seed: 3", "step_s: 0.1", "steps: 4"),
            *("step forward turn", "1 1.0 0.0", "2 0.5 0.1", ""),
        )
    )
    (tmp_path / "a.txt").write_text(log)
    assert read_joystick_log(tmp_path / "a.txt").actions[:, 0].tolist() == [0.0, 1.0, 0.5, 0.5]
    (tmp_path / "a.txt").write_text(log.replace(was, now))
    with pytest.raises(InputError, match=rf"a\.txt.*{said}") as error:
        read_joystick_log(tmp_path / "a.txt")
    assert len(str(error.value)) < 400 + len(str(tmp_path))
