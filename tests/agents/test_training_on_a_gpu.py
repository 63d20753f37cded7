"""The safety filter and the training on a real GPU, where there is one."""

from dataclasses import replace

import numpy as np
import pytest
from numba import cuda

torch = pytest.importorskip("torch", reason='training needs the extra "learn"')
pytest.importorskip("stable_baselines3", reason='training needs the extra "learn"')
if not (cuda.is_available() and torch.cuda.is_available()):
    pytest.skip("needs an NVIDIA GPU, numba-cuda and a torch for it", allow_module_level=True)

from tagalong.agents.learned.guard import GuardConfig  # noqa: E402
from tagalong.agents.learned.steering import SteeringConfig  # noqa: E402
from tagalong.agents.training.worlds.guarding import WorldsGuard  # noqa: E402
from tagalong.agents.training.worlds.preset import WorldsPreset  # noqa: E402
from tagalong.agents.training.worlds.run import WorldsRun, WorldsRunConfig  # noqa: E402
from tagalong.envs.task import FollowInterface  # noqa: E402

SMALL = WorldsPreset(
    kinds=({"scene": "corridor", "people": 2},), worlds=100, episodes=8, env={"beams": 90, "people": "modelled"},
    steps=6400, rollout=16, batch=400, epochs=2, width=32, most_steps=60,
)  # fmt: skip


def test_a_gpu_lets_pass_what_the_processor_does():
    count, rng = 5000, np.random.default_rng(0)
    interface = FollowInterface(bearings=np.deg2rad(np.linspace(-135.0, 135.0, 181)))
    scans = rng.uniform(0.4, 4.0, (count, 1)) * np.exp(np.cumsum(rng.normal(0.0, 0.1, (count, 181)), axis=1)) / 30.0
    commanded = rng.uniform((-0.3, -0.5, -1.5, -1.0), (1.3, 0.5, 1.5, 1.0), (count, 4))
    wishes = rng.uniform((-0.3, -1.5), (1.3, 1.5), (count, 2))
    leader = np.tile((1.2, 0.0, 0.0, 0.0, 1.0, 1.0), (count, 1))
    given = [torch.as_tensor(values.astype(np.float32)) for values in (commanded, wishes, scans.clip(0, 1), leader)]
    steering = SteeringConfig()
    ours, theirs = (
        WorldsGuard(GuardConfig(), interface, count, device)
        .limit(*(tensor.to(device) for tensor in given), steering)
        .cpu()
        for device in ("cuda", "cpu")
    )
    apart = int((ours - theirs).abs().amax(dim=1).gt(1e-6).sum())
    assert apart <= 2  # a bound that is met to the last digit
    assert 500 < int((theirs != given[1]).any(dim=1).sum()) < 4500


@pytest.mark.parametrize("guard", [GuardConfig(), None])
def test_a_training_on_a_gpu_makes_the_same_bytes_twice(tmp_path, guard):
    policies = []
    for name in "ab":
        config = WorldsRunConfig(preset=replace(SMALL, guard=guard), device="cuda")
        WorldsRun(config, tmp_path / name, lambda line: None).train()
        policies.append((tmp_path / name / "policy.safetensors").read_bytes())
    assert policies[0] == policies[1]
