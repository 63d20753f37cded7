"""Compiled worlds on a GPU: what they do is tested on a pretended one, and on a real one where there is one."""

from types import SimpleNamespace

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from numba import cuda
from tagalong.envs.compiled.episodes import step_worlds
from tagalong.envs.compiled.state import arrays_of, scratch
from tagalong.envs.compiled.vector_env import turns
from tagalong.envs.cuda_worlds.kernel import scratch_of
from tagalong.slam import InputError

GIVEN = {"episodes_ahead": 8, "beams": 90, "people_count": 3}
REAL = pytest.mark.skipif(not cuda.is_available(), reason="needs an NVIDIA GPU and numba-cuda")


def made(simulator, worlds=5, **arguments):
    given = {**GIVEN, **arguments}
    return gym.make_vec("tagalong/Corridor-v0", worlds, "vector_entry_point", simulator=simulator, **given).unwrapped


class Memory(np.ndarray):
    """An array of a pretended GPU."""

    def copy_to_host(self, here):
        here[...] = self

    def copy_to_device(self, there):
        self[...] = there


def plain(values):
    """The same arrays as the processor's kernels know them."""
    if isinstance(values, np.ndarray):
        return values.view(np.ndarray)
    return type(values)(*map(plain, values)) if hasattr(values, "_fields") else values


class Kernel:
    """`step_on_gpu`, done by the processor with the scratch of the first thread."""

    def __getitem__(self, grid):
        return self

    def __call__(self, what, actions, rules, plans, state, told, room):
        given = [plain(values) for values in (rules, plans, state, told)]
        one = scratch_of.py_func(plain(room), len(what) - 1)
        step_worlds(turns(len(what)), plain(what), plain(actions), *given, one)


@pytest.fixture
def pretended(monkeypatch):
    """A GPU whose memory is the processor's."""
    from tagalong.envs.cuda_worlds import memory, vector_env

    card = SimpleNamespace(
        is_available=lambda: True,
        to_device=lambda array: array.copy().view(Memory),
        device_array=lambda shape, kind: np.zeros(shape, kind).view(Memory),
        as_cuda_array=lambda tensor: tensor.numpy().view(Memory),
    )
    for module in (memory, vector_env):
        monkeypatch.setattr(module, "cuda", card)
    monkeypatch.setattr(memory, "step_on_gpu", Kernel())


def drive(env, steps=40, seed=7):
    """All that an environment tells in some steps, among them a reset of a part of the worlds, as bytes."""
    rng, told = np.random.default_rng(0), []
    observation, info = env.reset(seed=seed)
    for k in range(steps):
        told += [np.asarray(observation[key]).tobytes() for key in sorted(observation)]
        if k != 13:  # after a reset of a part, tensors tell of all worlds, arrays of that part
            told.append(np.asarray(info["robot_pose"]).tobytes())
        if k == 12:
            mask = np.array([True, False, True, False, False])
            observation, info = env.reset(options={"reset_mask": mask, "people": 2})
            continue
        if env.metadata["autoreset_mode"] == AutoresetMode.DISABLED and env._state.ended.any():
            observation, info = env.reset(options={"reset_mask": env._state.ended.copy()})
        observation, reward, _, _, info = env.step(rng.uniform(-1.0, 1.0, (5, 2)))
        told.append(np.asarray(reward).tobytes())
    env.close()
    return told


@pytest.mark.parametrize("mode", list(AutoresetMode))
@pytest.mark.parametrize("people", ["truth", "modelled"])
def test_worlds_come_to_the_gpu_and_back_as_they_were(pretended, mode, people):
    given = {"autoreset_mode": mode, "max_episode_steps": 9, "people": people}
    assert drive(made("cuda", **given)) == drive(made("compiled", workers=1, **given))


def test_what_a_gpu_cannot_do_is_refused_in_one_line(pretended):
    with pytest.raises(InputError, match='does not support people="tracker"'):
        made("cuda", people="tracker")
    with pytest.raises(InputError, match=r"does not support `reward.terms`"):
        made("cuda", **{"reward.terms": {"mine": lambda facts: 0.0}})
    with pytest.raises(InputError, match="`workers` are threads of a processor"):
        made("cuda", workers=2)
    with pytest.raises(InputError, match="nothing is told before the first reset"):
        made("cuda").told  # noqa: B018


def of_threads(values, threads):
    """Scratch of so many threads, as the GPU has it."""
    if isinstance(values, np.ndarray):
        return np.stack([np.full_like(values, t) for t in range(threads)])
    return type(values)(*(of_threads(value, threads) for value in values))


def test_each_thread_has_its_own_row_of_each_scratch():
    of_all = of_threads(scratch(ticks=4, beams=3, people=2), 2)
    for t in range(2):
        own = arrays_of(scratch_of.py_func(of_all, t))
        for array, of_both in zip(own, arrays_of(of_all), strict=True):
            assert np.shares_memory(array, of_both[t])
            assert array.shape == of_both.shape[1:]


@pytest.mark.skipif(cuda.is_available(), reason="there is a GPU")
def test_without_a_gpu_it_is_said_what_is_needed():
    with pytest.raises(InputError, match=r'needs an NVIDIA GPU, its driver and numba-cuda .*"compiled" does the same'):
        made("cuda")


@REAL
@pytest.mark.parametrize("people", ["truth", "modelled"])
def test_a_real_gpu_drives_as_the_processor_does(people):
    both = [made(simulator, 64, people=people, beams=360) for simulator in ("cuda", "compiled")]
    told = [env.reset(seed=3) for env in both]
    actions = np.random.default_rng(0).uniform(0.0, 1.0, (60, 64, 2))
    for k, action in enumerate(actions):
        (ours, our_info), (theirs, their_info) = told
        assert our_info["robot_pose"] == pytest.approx(their_info["robot_pose"], abs=1e-6)
        for name in ours if k < 3 else ():  # then noise has been drawn for other beams here and there
            assert ours[name] == pytest.approx(theirs[name], abs=1e-3)
        told = [(out[0], out[4]) for out in (env.step(action) for env in both)]


@REAL
def test_a_real_gpu_makes_the_same_bytes_for_the_same_seed():
    assert drive(made("cuda", max_episode_steps=9)) == drive(made("cuda", max_episode_steps=9))


def test_episodes_that_were_not_drawn_take_no_room_on_the_gpu(pretended):
    env, rows = made("cuda", 5), []
    for options in (None, {"people": 2, "reset_mask": np.array([False, False, True, False, False])}):
        env.reset(seed=0, options=options)
        rows.append({len(array) for array in env._gpu._plans})
    assert rows == [{8}, {8 + 3}]
