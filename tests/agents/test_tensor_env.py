"""Worlds on a GPU in tensors; the GPU is a pretended one, whose memory is the processor's."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

torch = pytest.importorskip("torch", reason='tensors need the extra "learn"')

from tagalong.agents import TensorVectorEnv  # noqa: E402
from tagalong.envs import CompiledVectorEnv, CudaVectorEnv  # noqa: E402
from tagalong.slam import InputError  # noqa: E402

GIVEN = {"scene": "corridor", "episodes_ahead": 8, "beams": 90, "people_count": 3, "max_episode_steps": 9}


class Whole(np.ndarray):
    """An array as numba has it on a GPU, where it goes through all rows of a column that is taken from it."""

    def __getitem__(self, key):
        raise AssertionError("a column of an array on the GPU: take it from a tensor")


class Pretended(CudaVectorEnv):
    """`CudaVectorEnv` whose kernel is the processor's."""

    def __init__(self, num_envs, **arguments):
        CompiledVectorEnv.__init__(self, num_envs, workers=1, **arguments)
        self._gpu = None

    @property
    def told(self):
        return type(self._told)(*(array.view(Whole) for array in self._told))

    def _run(self, what, actions):
        self._move(what, actions)

    def _move(self, what, actions):
        CompiledVectorEnv._run(self, what, np.asarray(actions))


@pytest.fixture
def made(monkeypatch):
    """Makes environments of five worlds."""
    card = SimpleNamespace(as_cuda_array=lambda tensor: tensor.numpy(), to_device=lambda array: array)
    monkeypatch.setattr(sys.modules[CudaVectorEnv.__module__], "cuda", card)
    monkeypatch.setattr(sys.modules[TensorVectorEnv.__module__], "DEVICE", "cpu")
    return lambda mode: TensorVectorEnv(Pretended(5, autoreset_mode=mode, **GIVEN))


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_tensors_tell_what_arrays_tell(made, mode):
    ours, theirs = made(mode), CompiledVectorEnv(5, workers=1, autoreset_mode=mode, **GIVEN)
    (seen, told), (wanted, info) = ours.reset(seed=7), theirs.reset(seed=7)
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (30, 5, 2))
    for action in actions:
        assert {name: values.numpy().tobytes() for name, values in seen.items()} == {
            name: values.tobytes() for name, values in wanted.items()
        }
        for name in ("robot_pose", "time_s", "is_success", "lost_s"):
            assert told[name].numpy().tobytes() == info[name].tobytes()
        for name, term in told["reward_terms"].items():
            assert term.numpy().tobytes() == info["reward_terms"][name].tobytes()
        if mode == AutoresetMode.DISABLED and ours.env.ended.any():
            with pytest.raises(InputError, match="has ended: reset it first"):
                ours.step(torch.as_tensor(action))
            (seen, told), (wanted, info) = ours.reset(), theirs.reset()
            continue
        seen, *judged, told = ours.step(torch.as_tensor(action))
        wanted, *judged_too, info = theirs.step(action)
        assert [one.numpy().tobytes() for one in judged] == [one.tobytes() for one in judged_too]
        assert ("final_obs" in told) == ("final_obs" in info)
        for i in np.flatnonzero(info.get("_final_obs", [])):
            assert told["_final_obs"][i]
            assert told["final_obs"]["scan"][i].numpy().tobytes() == info["final_obs"][i]["scan"].tobytes()
            assert told["final_info"]["time_s"][i] == info["final_info"]["time_s"][i]


def test_tensors_belong_to_the_caller(made):
    env = made("NextStep")
    first, _ = env.reset(seed=0)
    kept = {name: values.clone() for name, values in first.items()}
    env.step(torch.full((5, 2), 0.3))
    assert all(torch.equal(first[name], kept[name]) for name in kept)
    env.close()


def test_other_actions_and_other_simulators_are_refused(made):
    env = made("NextStep")
    env.reset(seed=0)
    with pytest.raises(InputError, match=r"actions have shape \(5, 2\), got \(5, 3\)"):
        env.step(torch.zeros(5, 3))
    with pytest.raises(InputError, match='need simulator="cuda", got a CompiledVectorEnv'):
        TensorVectorEnv(CompiledVectorEnv(2, **GIVEN))
