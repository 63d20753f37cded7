"""Long runs: what counts as flat, and laps of a log that join without a jump."""

import numpy as np
import pytest
from tagalong.scripts.benchmarks import soak, soak_episodes
from tagalong.scripts.benchmarks.soak_laps import there_and_back
from tagalong.scripts.cli import main
from tagalong.scripts.lab.cells import TIMING, Cell
from tagalong.scripts.lab.memory import memory_mb
from tagalong.scripts.lab.own_process import run_alone
from tagalong.scripts.lab.trend import trend
from tagalong.slam import LaserScan, RecordedDrive


def rows_of(memory, times, reference=1.0):
    pace = np.broadcast_to(reference, len(times))
    parts = enumerate(zip(memory, times, pace, strict=True), 1)
    return [{"memory_mb": mb, "step_ms": ms, "reference_ms": one, "done": 1000 * k} for k, (mb, ms, one) in parts]


def test_what_grows_only_in_the_first_tenth_is_flat():
    went = trend(rows_of([100, 300] + 18 * [301], [9.0, 9.0] + 18 * [1.0]))
    assert went.flat
    assert went.settled_mb == 301
    assert went.memory_growth == 0.0
    assert went.bytes_a_step == pytest.approx(0.0, abs=1e-6)


def test_one_building_that_needs_more_is_no_growth():
    went = trend(rows_of([100] * 30 + [120] + [100] * 9, 40 * [1.0]))
    assert went.flat
    assert went.largest_mb == 120


def test_a_leak_is_told_in_bytes_a_step():
    went = trend(rows_of(np.linspace(100, 119, 20), 20 * [1.0]))
    assert not went.flat
    assert went.bytes_a_step == pytest.approx(1000.0)


def test_steps_that_take_longer_and_longer_are_not_flat():
    assert not trend(rows_of(20 * [100], np.linspace(1, 2, 20))).flat


def test_a_machine_that_slows_down_is_no_growth():
    slower = np.linspace(1, 2, 20)
    went = trend(rows_of(20 * [100], 3.0 * slower, slower))
    assert went.flat
    assert went.time_growth == pytest.approx(0.0)


def test_laps_join_without_a_jump_and_their_clock_goes_on():
    bearings = np.linspace(-1.0, 1.0, 5)
    scans = [LaserScan(np.full(5, 1.0 + k), bearings, 0.1, 30.0, time_s=stamp) for k, stamp in enumerate((3, 4, 4, 7))]
    drive = RecordedDrive(np.arange(12.0).reshape(4, 3), scans, None, "drive")
    steps = [step for lap in there_and_back(drive, 4, 2) for step in lap]
    assert [int(scan.ranges[0]) - 1 for _, scan in steps] == 2 * [0, 1, 2, 3, 2, 1]
    assert all((odometry == drive.odometry[int(scan.ranges[0]) - 1]).all() for odometry, scan in steps)
    gaps = np.diff([scan.time_s for _, scan in steps])
    assert gaps == pytest.approx([1, 0.1, 3, 3, 0.1, 1, 1, 0.1, 3, 3, 0.1])


def held():
    return {"memory_mb": memory_mb()}


def test_a_part_does_not_see_the_memory_of_the_process_that_asks_for_it(tmp_path):
    ballast = np.ones(40_000_000)
    cell = Cell(name="held", function=held, arguments={})
    assert run_alone(cell, tmp_path)["memory_mb"] < memory_mb() - 0.9e-6 * ballast.nbytes + 50


def test_a_part_that_is_finished_is_not_run_again(tmp_path, monkeypatch):
    words = ["bench", "soak", "--steps", "0", "--laps", "2", "--scans", "3", "--engines", "ekf", "--out", str(tmp_path)]
    main(words)
    monkeypatch.setattr("tagalong.scripts.lab.own_process.Crew", None)
    main(words)
    assert len((tmp_path / "laps" / "ekf.json").read_text()) > 100


def test_the_exit_status_says_whether_a_part_grew(tmp_path, monkeypatch, capsys):
    grown = {"scans": 9, TIMING: rows_of([100, 200, 300, 400], 4 * [1.0])}
    monkeypatch.setattr(soak, "run_alone", lambda cell, folder: grown)
    assert main(["bench", "soak", "--engines", "ekf", "--out", str(tmp_path)]) == 1
    assert "GROWS" in capsys.readouterr().out


def test_rounds_go_through_all_environments_and_name_what_they_took(monkeypatch):
    monkeypatch.setattr(soak_episodes, "IDS", {"tagalong/PlainCorridor-v0": {"scene": "plain_corridor"}})
    monkeypatch.setattr(soak_episodes, "VISIT", 3)
    rows = soak_episodes.episodes(None, 6)[TIMING]
    assert [row["done"] for row in rows] == [3, 6]
    assert all(row["step_ms"] > 0.0 and row["memory_mb"] > 1.0 for row in rows)


def test_the_probe_is_the_same_each_time_and_the_episode_goes_on_as_if_there_were_none(monkeypatch):
    monkeypatch.setattr(soak_episodes, "PROBE", 5)
    probed, alone = soak_episodes._Wanderer(None), soak_episodes._Wanderer(None)
    for wanderer in (probed, alone):
        wanderer.go_on(10)
    probe = soak_episodes._Probe(probed)
    alone.go_on(5)
    passed = probed.env.truth.robot_pose.tobytes()
    seen, step = [], probed.env.step

    def watched(action):
        result = step(action)
        seen.append(probed.env.truth.robot_pose.tobytes())
        return result

    monkeypatch.setattr(probed.env, "step", watched)
    for _ in range(2):
        assert probe.drive(soak_episodes.Pace()) > 0.0
        assert probed.env.truth.robot_pose.tobytes() == passed
    assert seen[:5] == seen[5:]
    assert len(set(seen)) == 5
    monkeypatch.undo()
    for wanderer in (probed, alone):
        wanderer.go_on(5)
    assert probed.env.truth.robot_pose.tobytes() == alone.env.truth.robot_pose.tobytes() != passed


def test_one_endless_episode_is_timed_by_its_probe_after_each_stretch(monkeypatch):
    monkeypatch.setattr(soak_episodes, "STRETCH", 6)
    monkeypatch.setattr(soak_episodes, "PROBE", 4)
    rows = soak_episodes.endless_episode(None, 12)[TIMING]
    assert [row["done"] for row in rows] == [6, 12]
    assert all(min(row["step_ms"], row["passing_ms"], row["reference_ms"]) > 0.0 for row in rows)


@pytest.mark.parametrize("words", [["--engines", "magic"], ["--laps", "1"], ["--steps", "100"]])
def test_a_run_without_sense_is_refused(words, tmp_path):
    assert main(["bench", "soak", *words, "--out", str(tmp_path)]) == 2


def test_when_all_of_the_floor_was_seen_the_robot_is_back_where_it_began_in_the_same_building():
    wanderer = soak_episodes._Wanderer(None)
    wanderer.go_on(1)
    world, first = wanderer.env.world, wanderer.env.truth.robot_pose.tobytes()
    wanderer.go_on(20)
    assert wanderer.env.truth.robot_pose.tobytes() != first
    wanderer._ended = True
    wanderer.go_on(1)
    assert wanderer.episodes == 2
    assert wanderer.env.world is world
    assert wanderer.env.world.time_s < 0.3
