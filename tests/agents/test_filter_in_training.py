"""The safety filter in training, and what a policy wears later."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason='training needs the extra "learn"')
pytest.importorskip("stable_baselines3", reason='training needs the extra "learn"')

from tagalong.agents import make_follower  # noqa: E402
from tagalong.agents.learned.guard import Guard, GuardConfig  # noqa: E402
from tagalong.agents.learned.steering import SteeringConfig  # noqa: E402
from tagalong.agents.training.worlds import guarding  # noqa: E402
from tagalong.agents.training.worlds.guarding import WorldsGuard  # noqa: E402
from tagalong.agents.training.worlds.preset import WorldsPreset  # noqa: E402
from tagalong.agents.training.worlds.run import WorldsRun, WorldsRunConfig  # noqa: E402
from tagalong.agents.training.worlds.tensor_worlds import TensorWorlds  # noqa: E402
from tagalong.envs.task import FollowInterface  # noqa: E402
from tagalong.slam import InputError  # noqa: E402

TINY = WorldsPreset(
    kinds=({"scene": "corridor", "people": 2},), worlds=5, episodes=4, env={"beams": 90}, steps=20, rollout=4, batch=10,
    epochs=1, width=8, most_steps=6,
)  # fmt: skip


def trained(folder, preset):
    WorldsRun(WorldsRunConfig(preset=preset), folder, lambda line: None).train()


@pytest.mark.parametrize("trained_so", [True, False])
def test_a_policy_wears_the_filter_that_it_was_trained_with_and_others_only_when_told(tmp_path, trained_so):
    trained(tmp_path, TINY if trained_so else replace(TINY, guard=None))
    interface = FollowInterface(bearings=np.deg2rad(np.linspace(-135.0, 135.0, 181)))
    card = json.loads((tmp_path / "policy.json").read_text())
    assert (card["guard"] is not None) == trained_so
    observation = {
        "scan": np.full(181, 0.21 / 30.0, np.float32),  # a wall all around: 4 cm before the front
        "leader": np.array([2.0, 0.0, 0.0, 0.0, 1.0, 1.0], np.float32),
        "people": np.zeros((6, 6), np.float32),
        "velocity": np.zeros(2, np.float32),
    }

    def drives(name):
        follower = make_follower(f"{tmp_path}{name}", interface)
        follower._network = lambda told: np.ones(2, np.float32)
        follower.reset()
        return bool(np.abs(follower.act(observation)).max() > 1e-3)

    assert [drives(name) for name in ("", "+guard", "-alone")] == [not trained_so, False, True]


def test_a_policy_wears_the_filter_just_as_it_was_in_training(tmp_path):
    trained(tmp_path, replace(TINY, guard=GuardConfig(margin=0.2)))
    interface = FollowInterface(bearings=np.deg2rad(np.linspace(-135.0, 135.0, 181)))
    for name in ("", "+guard"):
        assert make_follower(f"{tmp_path}{name}", interface)._guard.config == GuardConfig(margin=0.2)


def test_training_knows_where_the_laser_looks_as_driving_does():
    turned = FollowInterface(bearings=np.deg2rad(np.linspace(-135.0, 135.0, 90)), T_robot_lidar=(0.1, 0.05, 0.7))
    scan, leader = np.full((1, 90), 1.0, np.float32), np.zeros((1, 6), np.float32)
    scan[0, 20:26] = 0.4 / 30.0  # to the right of the laser's front, to the left of the robot's or not
    steering, changed = SteeringConfig(), 0
    for wish in ((1.3, 0.0), (0.3, 1.5), (0.3, -1.5), (-0.4, 0.0), (0.8, 0.8), (0.8, -0.8)):
        guard = Guard(GuardConfig(), steering, turned)
        guard.room_behind = lambda: np.inf
        rows = {
            "scan": scan[0],
            "leader": leader[0],
            "people": np.zeros((6, 6), np.float32),
            "velocity": np.zeros(2, np.float32),
        }
        guard.observe(rows)
        told = {name: torch.as_tensor(rows[name])[None] for name in ("scan", "leader", "people")}
        given = torch.tensor([[0.5, 0.0, 0.0, 0.0]]), torch.tensor([wish]), told
        limited = WorldsGuard(GuardConfig(), turned, 1, "cpu").limit(*given, steering)
        assert limited[0].tolist() == pytest.approx(guard.limit((0.5, 0.0, 0.0, 0.0), wish), abs=1e-6)
        changed += limited[0].tolist() != pytest.approx(wish)
    assert changed


def test_training_does_not_brake_for_bystanders_who_walk_out_of_the_way():
    interface = FollowInterface(bearings=np.deg2rad(np.linspace(-135.0, 135.0, 271)))
    told = {"scan": torch.ones(1, 271), "leader": torch.zeros(1, 6), "people": torch.zeros(1, 6, 6)}
    told["scan"][0, 135] = 0.6 / 30.0
    passes = []
    for there in (0.0, 1.0):
        told["people"][0, 2] = torch.tensor((0.8, 0.0, 1.2, 0.0, 1.0, there))
        guard = WorldsGuard(GuardConfig(), interface, 1, "cpu")
        commanded, wish = torch.tensor([[1.0, 0.0, 0.0, 0.0]]), torch.tensor([[1.0, 0.0]])
        passes.append(torch.equal(guard.limit(commanded, wish, told, SteeringConfig()), wish))
    assert passes == [False, True]


def test_only_who_was_trained_with_the_filter_can_be_asked_to_drive_without():
    for name in ("pid-alone", "learned-alone", "my_module:Bold-alone"):
        with pytest.raises(InputError, match="takes the safety filter from a policy that was trained with it"):
            make_follower(name)


def test_training_passes_the_wishes_through_the_filter():
    speeds = {}
    for guard in (TINY.guard, None):
        worlds = TensorWorlds(replace(TINY, guard=guard), 0, 1, "cpu")
        worlds.reset(0)
        worlds._seen["scan"][:] = 0.21 / 30.0
        worlds._seen["leader"][:] = 0.0
        worlds.step(torch.ones(5, 2))
        speeds[guard is None] = float(worlds._commanded.abs().max())
        worlds.close()
    assert speeds[False] < 1e-6 < 0.01 < speeds[True]


def test_a_gpu_guards_each_world_by_a_thread_of_its_own(monkeypatch):
    interface, rng = FollowInterface(bearings=np.deg2rad(np.linspace(-135.0, 135.0, 90))), np.random.default_rng(0)
    card = SimpleNamespace(
        as_cuda_array=lambda tensor: tensor.numpy(), to_device=lambda array: array, grid=lambda _: thread[0]
    )
    thread, asked = [0], []

    class Kernel:
        def __getitem__(self, grid):
            asked.append(grid)
            return self

        def __call__(self, *given):
            for thread[0] in range(asked[-1][0] * asked[-1][1]):
                guarding._guard(*given)

    on_processor = WorldsGuard(GuardConfig(), interface, 70, "cpu")
    monkeypatch.setattr(guarding, "guard_world", lambda *given: guarding.guard_worlds(*(
        value[None] if k < 5 else value for k, value in enumerate(given))))  # fmt: skip
    monkeypatch.setattr(guarding, "_array", lambda tensor: tensor.numpy())
    monkeypatch.setattr(guarding, "cuda", card)
    monkeypatch.setattr(guarding, "guard_on_gpu", Kernel())
    scans = torch.as_tensor(rng.uniform(0.005, 0.04, (70, 90)).astype(np.float32))
    told = {"scan": scans, "leader": torch.zeros(70, 6), "people": torch.zeros(70, 6, 6)}
    told["people"][::2, 0] = torch.tensor((0.5, 0.0, 1.2, 0.0, 1.0, 1.0))
    commanded = torch.zeros(70, 4)
    commanded[:, 0], wishes = 0.4, torch.as_tensor(rng.uniform(-1.0, 1.0, (70, 2)).astype(np.float32))
    given = commanded, wishes, told, SteeringConfig()
    limited = WorldsGuard(GuardConfig(), interface, 70, "cuda").limit(*given)
    assert torch.equal(limited, on_processor.limit(*given))
    assert asked == [(2, 64)]
    assert 10 < int((limited != wishes).any(dim=1).sum()) <= 70
