"""Suites, the situations of Follow-Bench, and its figures."""

from dataclasses import replace
from itertools import pairwise

import gymnasium as gym
import numpy as np
import pytest
from tagalong.agents import make_follower
from tagalong.envs.metrics.follow_bench import follow_bench_metrics
from tagalong.envs.recording.rollout import rollout
from tagalong.envs.scenes import SceneRequest, make_scene
from tagalong.envs.suites import SUITES, suite
from tagalong.scripts.cli import main
from tagalong.slam import InputError


@pytest.mark.parametrize("name", sorted(SUITES))
def test_every_scenario_of_a_suite_can_be_driven(name):
    for scenario in {each.env + str(each.arguments): each for each in suite(name)}.values():
        env = gym.make(scenario.env, slam=None, beams=61, **scenario.arguments)
        first, _ = env.reset(seed=1_000_000, options=scenario.options)
        then, _, terminated, truncated, _ = env.step(np.zeros(2))
        assert env.observation_space.contains(first)
        assert env.observation_space.contains(then)
        assert not terminated
        assert not truncated
        asked = scenario.options.get("people", scenario.arguments.get("people_count"))
        people = env.unwrapped.truth.people
        assert asked is None or len(people.positions) >= asked, scenario


def test_the_second_hard_suite_is_the_first_with_people_who_do_not_see_the_robot():
    for one, two in zip(suite("hard-v1"), suite("hard-v2"), strict=True):
        assert two == replace(one, options={**one.options, "heedless": 1.0})


def test_an_unknown_suite_is_answered_with_the_known_ones():
    with pytest.raises(InputError, match="corridor, crowd, floor_plan"):
        suite("ofice")


@pytest.fixture(scope="module")
def episode():
    env = gym.make("tagalong/Office-v0", scene="doorway", people="truth", slam=None, beams=181)
    return rollout(env, make_follower("pid", env.unwrapped.interface), seed=3, steps=80, options={"people": 3})


def test_the_figures_of_follow_bench_are_what_they_say(episode):
    history = episode.history
    figures = follow_bench_metrics(history)
    poses = history.robot_pose[:, :2]
    assert figures["fb_path_m"] == pytest.approx(sum(np.hypot(*(b - a)) for a, b in pairwise(poses)))
    gap = np.hypot(*(history.person_position[:, 0] - poses).T) - history.robot_radius - history.person_radius[0]
    assert figures["fb_personal_s"] == pytest.approx(0.1 * sum(0.45 <= d <= 1.2 for d in gap[1:]))
    assert figures["fb_success"] == 0.0
    still = replace(history, robot_velocity=np.tile([0.5, 0.0, 0.0], (81, 1)), robot_pose=np.zeros((81, 3)))
    constant = follow_bench_metrics(still)
    assert constant["fb_speed_mps"] == pytest.approx(0.5)
    assert constant["fb_acceleration_mps2"] == constant["fb_jerk_mps3"] == constant["fb_path_m"] == 0.0


def test_no_time_has_passed_before_the_first_step(episode):
    history = episode.history
    beside = np.repeat(history.robot_pose[:, None, :2], history.person_position.shape[1], axis=1)
    never = np.zeros(len(history), dtype=bool)
    figures = follow_bench_metrics(replace(history, person_position=beside, leader_visible=never))
    assert figures["fb_private_s"] == pytest.approx(8.0)
    assert figures["fb_search_s"] == pytest.approx(8.0)
    near = beside + np.array((history.robot_radius + history.person_radius[0] + 0.6, 0.0))
    assert follow_bench_metrics(replace(history, person_position=near))["fb_personal_s"] == pytest.approx(8.0)


def test_success_needs_the_tour_no_contact_and_recovered_losses(episode):
    rows = len(episode.history)
    seen, done = np.ones(rows, dtype=bool), np.ones(rows, dtype=bool)
    nothing = np.zeros(rows, dtype=bool)
    fine = replace(episode.history, leader_visible=seen, tour_done=done, contact_person=nothing, contact_static=nothing)
    assert follow_bench_metrics(fine)["fb_success"] == 1.0
    touched = nothing.copy()
    touched[10] = True
    assert follow_bench_metrics(replace(fine, contact_person=touched))["fb_success"] == 0.0
    for lost, success in ((40, 1.0), (60, 0.0)):
        visible = seen.copy()
        visible[10 : 10 + lost] = False
        figures = follow_bench_metrics(replace(fine, leader_visible=visible))
        assert figures["fb_success"] == success
        assert figures["fb_search_s"] == pytest.approx(0.1 * lost)


def test_what_is_about_the_target_is_nan_where_nobody_leads(episode):
    history = episode.history
    led, alone = follow_bench_metrics(history), follow_bench_metrics(replace(history, leader_index=-1))
    about_target = {"fb_success", "fb_search_path_m", "fb_search_s", "fb_personal_s"}
    assert {name for name, value in alone.items() if np.isnan(value)} == about_target
    assert all(alone[name] == led[name] for name in led.keys() - about_target)
    rows = len(history)
    nobody = {"person_position": np.zeros((rows, 0, 2)), "person_velocity": np.zeros((rows, 0, 2))}
    empty = replace(history, leader_index=-1, person_radius=np.zeros(0), **nobody)
    assert follow_bench_metrics(empty)["fb_private_s"] == 0.0


def test_the_command_evaluates_a_suite(tmp_path, capsys):
    words = ["evaluate", "pid", "--suite", "follow-bench", "--episodes", "4", "--perception", "truth", "--beams", "91"]
    assert main([*words, "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    for name in ("narrow_corridor", "doorway", "intersection", "clutter", "fb_private_s"):
        assert name in printed
    assert (tmp_path / "evaluation.json").exists()
    assert main([*words, "--people", "3"]) == 2
    assert "its own numbers" in capsys.readouterr().err


def test_all_doors_of_a_tight_office_are_as_wide_as_a_usual_inner_door():
    for seed in range(3):
        wide, tight = (
            make_scene(name, np.random.default_rng(seed), request=SceneRequest(split="test"))
            for name in ("office", "tight_office")
        )
        assert tight.name == "tight_office"
        walls = [sum(4.0 * s.half_length * s.half_width for s in scene.solids) for scene in (wide, tight)]
        assert walls[1] > walls[0]  # what the doors lost, the walls have
