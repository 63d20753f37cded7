"""The vector environment: equal to single environments step by step, in every autoreset mode."""

import os
import pickle
import signal
import time

import gymnasium as gym
import numpy as np
import pytest
import tagalong  # noqa: F401 (registers the ids)
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from tagalong.envs.vector.arguments import checked_arguments
from tagalong.envs.vector.worker import WorkerShare
from tagalong.slam import InputError
from tagalong.slam.errors import MissingExtraError, WorkerError

FIELDS = {"beams": 61, "slam": None, "people_count": 3}
COUNT = 3


def native(name="tagalong/Office-v0", **arguments):
    return gym.make_vec(
        name, num_envs=COUNT, vectorization_mode="vector_entry_point", **{"workers": 2, **FIELDS, **arguments}
    )


def one_by_one(mode, steps, name="tagalong/Office-v0"):
    def make():
        return gym.make(name, disable_env_checker=True, max_episode_steps=steps, **FIELDS)

    return SyncVectorEnv([make] * COUNT, autoreset_mode=mode)


def same(first, second):
    """Assert that two nests of dicts and arrays are equal to the byte."""
    assert type(first) is type(second)
    if isinstance(first, dict):
        assert sorted(first) == sorted(second)
        for key in first:
            same(first[key], second[key])
    elif isinstance(first, np.ndarray) and first.dtype != object:
        assert first.dtype == second.dtype
        assert first.tobytes() == second.tobytes()
    elif isinstance(first, tuple | np.ndarray):
        for one, other in zip(first, second, strict=True):
            same(one, other)
    else:
        assert first == second


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_it_is_equal_to_single_environments_step_by_step(mode):
    ours, theirs = native(max_episode_steps=9, autoreset_mode=mode), one_by_one(mode, 9)
    same(ours.reset(seed=5), theirs.reset(seed=5))
    rng = np.random.default_rng(0)
    ended = 0
    for _ in range(24):
        actions = rng.uniform(-1.0, 1.0, (COUNT, 2)).astype(np.float32)
        got, wanted = ours.step(actions), theirs.step(actions)
        for part, other in zip(got, wanted, strict=True):
            same(part, other)
        ended += int((got[2] | got[3]).sum())
    assert ended >= 2 * COUNT
    ours.close()
    theirs.close()


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_it_is_equal_where_episodes_end_at_different_times(mode):
    """A process whose environments all begin anew has infos of another form than the others."""
    ours, theirs = native(max_episode_steps=4, autoreset_mode=mode), one_by_one(mode, 4)
    actions, later = np.zeros((COUNT, 2), dtype=np.float32), np.array([False, False, True])
    for env in (ours, theirs):
        env.reset(seed=5)
        env.step(actions)
    same(ours.reset(seed=8, options={"reset_mask": later}), theirs.reset(seed=8, options={"reset_mask": later}))
    ends = set()
    for _ in range(9):
        got = ours.step(actions)
        for part, other in zip(got, theirs.step(actions), strict=True):
            same(part, other)
        ends.add(tuple(got[3].tolist()))
    assert {(True, True, False), (False, False, True)} <= ends
    ours.close()
    theirs.close()


def test_the_limit_of_steps_is_that_of_the_id_and_the_spaces_are_batched():
    env = native("tagalong/Corridor-v0")
    assert env.spec is not None
    assert env.spec.kwargs["max_episode_steps"] == 3000
    observation, _ = env.reset(seed=0)
    assert env.observation_space.contains(observation)
    assert env.metadata["autoreset_mode"] == AutoresetMode.NEXT_STEP
    env.close()


def test_an_action_that_is_refused_moves_nobody():
    disturbed, undisturbed = native(), native(workers=1)
    same(disturbed.reset(seed=0), undisturbed.reset(seed=0))
    actions, refused = np.zeros((COUNT, 2)), np.zeros((COUNT, 2))
    refused[-1] = np.nan
    for _ in range(20):
        for wrong in (refused, np.zeros((COUNT, 3))):
            with pytest.raises(InputError, match="finite"):
                disturbed.step(wrong)
        for part, other in zip(disturbed.step(actions), undisturbed.step(actions), strict=True):
            same(part, other)
    disturbed.close()
    undisturbed.close()


def test_some_environments_can_be_reset_alone():
    env = native("tagalong/Corridor-v0", autoreset_mode=AutoresetMode.DISABLED, max_episode_steps=2)
    first, _ = env.reset(seed=0)
    for _ in range(2):
        env.step(np.zeros((COUNT, 2)))
    with pytest.raises(InputError, match="reset it first"):
        env.step(np.zeros((COUNT, 2)))
    mask = np.array([True, False, True])
    again, infos = env.reset(seed=0, options={"reset_mask": mask})
    assert np.array_equal(again["scan"][mask], first["scan"][mask])
    assert infos["_time_s"].tolist() == mask.tolist()
    env.close()


def test_what_is_wrong_is_said():
    with pytest.raises(InputError, match="`workers`"):
        native(workers=9)
    with pytest.raises(InputError, match=r"`workers` must not exceed .*4 a core"):
        gym.make_vec("tagalong/Office-v0", num_envs=4096, vectorization_mode="vector_entry_point", workers=4096)
    with pytest.raises(InputError, match="`num_envs` must not exceed 4096"):
        gym.make_vec("tagalong/Office-v0", num_envs=10**6, vectorization_mode="vector_entry_point", workers=1)
    for wrong in (0.0, -1.0, float("nan"), 1e9):
        with pytest.raises(InputError, match="`silent_s` must lie in"):
            native(silent_s=wrong)
    with pytest.raises(InputError, match="unknown argument"):
        native(pepole=3)
    env = native("tagalong/Corridor-v0")
    with pytest.raises(InputError, match="a seed for each"):
        env.reset(seed=[1, 2])
    with pytest.raises(InputError, match="unknown reset option"):
        env.reset(seed=1, options={"peple": 2})
    with pytest.raises(InputError, match="whole at first"):
        env.reset(seed=1, options={"reset_mask": np.array([True, False, True])})
    with pytest.raises(InputError, match="chooses nobody"):
        env.reset(seed=1, options={"reset_mask": np.zeros(COUNT, dtype=bool)})
    env.reset(seed=1)
    with pytest.raises(InputError, match="an action for each"):
        env.step(np.zeros((2, 2)))
    env.close()


def test_errors_come_whole_through_a_pipe():
    error = pickle.loads(pickle.dumps(MissingExtraError("plots", "viz")))
    assert (str(error), error.extra) == (str(MissingExtraError("plots", "viz")), "viz")


@pytest.mark.parametrize("kind", [tuple, np.array])
def test_seeds_come_in_any_sequence(kind):
    env = native("tagalong/Corridor-v0", workers=1)
    first, second = env.reset(seed=[4, 2, 9]), env.reset(seed=kind([4, 2, 9]))
    same(first, second)
    assert not np.array_equal(first[0]["scan"], env.reset(seed=kind([2, 4, 9]))[0]["scan"])
    env.close()


def test_pictures_come_from_all():
    env = native("tagalong/Corridor-v0", render_mode="rgb_array")
    env.reset(seed=0)
    pictures = env.render()
    assert len(pictures) == COUNT
    assert pictures[0].shape[2] == 3
    env.close()


@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGSTOP])
def test_a_process_that_is_lost_is_named_and_the_others_are_ended(end):
    env = native("tagalong/Corridor-v0", workers=3, silent_s=2.0)
    env.reset(seed=0)
    processes = [worker.process for worker in env.unwrapped._workers]
    os.kill(processes[0].pid, end)
    began = time.monotonic()
    with pytest.raises(WorkerError, match="worker 1 of 2"):
        env.step(np.zeros((COUNT, 2)))
    assert not any(process.is_alive() for process in processes)
    with pytest.raises(WorkerError):
        env.reset(seed=0)
    env.close()
    assert time.monotonic() - began < 15.0


def test_after_an_interrupted_step_a_reset_gives_what_it_always_gives(monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    env = native("tagalong/Corridor-v0")
    first = env.reset(seed=0)
    with monkeypatch.context() as patch:
        patch.setattr(WorkerShare, "step", interrupted)
        with pytest.raises(KeyboardInterrupt):
            env.step(np.ones((COUNT, 2)))
    same(env.reset(seed=0), first)
    env.close()


@pytest.mark.parametrize("simulator", ["mujoco", "compiled"])
@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("workers", "x"),
        ("workers", True),
        ("max_episode_steps", -np.inf),
        ("autoreset_mode", 0),
        ("autoreset_mode", "Sometimes"),
    ],
)
def test_an_argument_of_the_whole_that_is_none_is_named_before_anything_is_made(simulator, name, value):
    with pytest.raises(InputError, match=f"`{name}` must be"):
        gym.make_vec("tagalong/Corridor-v0", 2, "vector_entry_point", simulator=simulator, **{name: value})


def test_numbers_of_other_libraries_become_plain_ones_for_they_would_compile_kernels_anew():
    asked = {"workers": np.int64(2), "max_episode_steps": np.int32(5), "episodes_seed": np.uint8(3), "beams": 90}
    count, checked = checked_arguments(np.int16(4), asked)
    assert (count, checked) == (4, {"workers": 2, "max_episode_steps": 5, "episodes_seed": 3, "beams": 90})
    assert {type(value) for value in (count, *checked.values())} == {int}
