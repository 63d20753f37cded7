"""Episodes as demonstrations, and as datasets of Minari and LeRobot."""

import json

import gymnasium as gym
import numpy as np
import pytest
from tagalong.agents import make_follower
from tagalong.envs.recording import (
    Demonstration,
    demonstrate,
    lerobot_dataset,
    minari_dataset,
    write_lerobot,
    write_minari,
)
from tagalong.envs.wrappers import PooledObservation
from tagalong.slam import InputError

PLAIN = {"people": "truth", "slam": None, "beams": 90}


@pytest.fixture(scope="module")
def env():
    return gym.make("tagalong/Corridor-v0", people_count=2, **PLAIN)


@pytest.fixture(scope="module")
def episodes(env):
    return [demonstrate(env, make_follower("pid"), seed=seed, steps=5 + seed) for seed in range(2)]


def test_a_demonstration_is_what_the_environment_said_and_was_told(env, episodes):
    one = episodes[1]
    follower = make_follower("pid")
    observation, info = env.reset(seed=1)
    follower.reset()
    for k in range(len(one)):
        action = np.clip(follower.act(observation), -1.0, 1.0)
        assert np.array_equal(one.actions[k], action)
        assert all(np.array_equal(one.observations[name][k], observation[name]) for name in observation)
        assert one.infos["reward_distance"][k] == info["reward_terms"]["distance"]
        observation, reward, *_, info = env.step(action)
        assert one.rewards[k] == reward
    assert np.array_equal(one.observations["scan"][-1], observation["scan"])
    assert (len(one), len(one.observations["scan"]), one.seed) == (6, 7, 1)
    assert one.truncated.tolist() == [False] * 5 + [True]  # it was cut


def test_a_demonstration_comes_back_from_its_file(episodes, tmp_path):
    episodes[0].save(tmp_path / "one.npz")
    again = Demonstration.load(tmp_path / "one.npz")
    for name in ("observations", "infos"):
        before, after = getattr(episodes[0], name), getattr(again, name)
        assert {key: value.tolist() for key, value in before.items()} == {k: v.tolist() for k, v in after.items()}
    assert (again.seed, again.options, again.ending, len(again)) == (0, {}, "", 5)


def test_a_file_that_is_no_demonstration_is_refused(episodes, tmp_path):
    np.savez(tmp_path / "other.npz", actions=np.zeros(3))
    with pytest.raises(InputError, match="holds no demonstration"):
        Demonstration.load(tmp_path / "other.npz")
    episodes[0].save(tmp_path / "whole.npz")
    with np.load(tmp_path / "whole.npz") as arrays:
        np.savez(tmp_path / "short.npz", **{**arrays, "observations/scan": arrays["observations/scan"][:-1]})
    with pytest.raises(InputError, match="holds no demonstration"):
        Demonstration.load(tmp_path / "short.npz")


def test_observations_that_are_one_vector_are_refused(env):
    with pytest.raises(InputError, match="observations that are a Dict"):
        demonstrate(PooledObservation(env), make_follower("pid"), seed=0)


def test_minari_reads_what_was_written_and_makes_the_environment_again(env, episodes, tmp_path, monkeypatch):
    minari = pytest.importorskip("minari")
    write_minari(tmp_path, "tagalong/corridor/pid-v0", env, iter(episodes), "pid")
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    dataset = minari.load_dataset("tagalong/corridor/pid-v0")
    assert (dataset.total_episodes, dataset.total_steps) == (2, 11)
    assert [told["seed"] for told in dataset.storage.get_episode_metadata([0, 1])] == [0, 1]
    for read, written in zip(dataset, episodes, strict=True):
        for name, array in written.observations.items():
            assert np.array_equal(read.observations[name], array), name
        for name, array in written.infos.items():
            assert np.array_equal(read.infos[name], array), name
        assert np.array_equal(read.actions, written.actions)
        assert np.array_equal(read.rewards, written.rewards)
        assert read.truncations[-1]
    again = dataset.recover_environment()
    assert np.array_equal(again.reset(seed=1)[0]["scan"], episodes[1].observations["scan"][0])
    assert dataset.observation_space == env.observation_space


def test_nothing_in_a_minari_dataset_is_code(env, episodes, tmp_path):
    pytest.importorskip("minari")
    folder = write_minari(tmp_path, "tagalong/corridor/pid-v0", env, episodes, "pid")
    files = [path for path in folder.rglob("*") if path.is_file()]
    assert {path.suffix for path in files} == {".json", ".arrow"}
    assert all(path.read_bytes()[:6] == b"ARROW1" for path in files if path.suffix == ".arrow")


def test_a_dataset_is_there_whole_or_not_at_all(env, episodes, tmp_path):
    pytest.importorskip("minari")

    def breaks_off():
        yield episodes[0]
        raise InputError("no more")

    with pytest.raises(InputError, match="no more"):
        write_minari(tmp_path, "tagalong/corridor/pid-v0", env, breaks_off())
    with pytest.raises(InputError, match="no more"):
        write_lerobot(tmp_path / "lerobot", env, breaks_off())
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []
    write_lerobot(tmp_path / "lerobot", env, episodes)
    with pytest.raises(InputError, match="is there already"):
        write_lerobot(tmp_path / "lerobot", env, episodes)


def test_an_environment_that_no_text_can_tell_is_refused_by_name(tmp_path):
    pytest.importorskip("minari")
    told = gym.make("tagalong/Corridor-v0", **{"reward.terms": {"own": lambda facts: 0.0}}, **PLAIN)
    with pytest.raises(InputError, match="cannot be kept as text"):
        write_minari(tmp_path, "tagalong/corridor/own-v0", told, [])
    with pytest.raises(InputError, match="NAMESPACE/NAME-vNUMBER, got "):
        write_minari(tmp_path, "../x", told, [])


def test_a_lerobot_dataset_has_the_columns_and_the_indices_of_version_3(env, episodes, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    folder = write_lerobot(tmp_path / "corridor", env, iter(episodes), "pid")
    info = json.loads((folder / "meta" / "info.json").read_text())
    assert (info["codebase_version"], info["fps"], info["total_episodes"], info["total_frames"]) == ("v3.0", 10, 2, 11)
    table = parquet.read_table(folder / info["data_path"].format(chunk_index=0, file_index=0))
    assert table.column_names == list(info["features"])
    assert table["index"].to_pylist() == list(range(11))
    assert table["episode_index"].to_pylist() == [0] * 5 + [1] * 6
    assert np.allclose(table["timestamp"].to_numpy(), [0.1 * k for k in (*range(5), *range(6))])
    assert table["next.done"].to_pylist() == [k in (4, 10) for k in range(11)]
    scans = np.array(table["observation.lidar"].to_pylist(), dtype=np.float32)
    assert np.array_equal(scans, np.concatenate([one.observations["scan"][:-1] for one in episodes]))
    rows = parquet.read_table(folder / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    assert [(row["seed"], row["dataset_from_index"], row["dataset_to_index"]) for row in rows] == [
        (0, 0, 5),
        (1, 5, 11),
    ]


def test_a_lerobot_dataset_tells_what_its_laser_is(env, episodes, tmp_path):
    pytest.importorskip("pyarrow")
    folder = write_lerobot(tmp_path / "corridor", env, episodes)
    features = json.loads((folder / "meta" / "info.json").read_text())["features"]
    lidar = features["observation.lidar"]
    assert (lidar["dtype"], lidar["shape"], lidar["info"]["lidar.range_max_m"]) == ("float32", [90], 30.0)
    assert np.allclose(lidar["info"]["lidar.bearings_rad"], env.unwrapped.interface.bearings)
    assert features["action"]["names"] == ["forward_command", "turn_command"]
    names = features["observation.environment_state"]["names"]
    assert (len(names), names[0], names[6]) == (42, "leader_x", "person_0_x")


def test_statistics_of_all_episodes_are_those_of_all_frames(env, episodes, tmp_path):
    pytest.importorskip("pyarrow")
    folder = write_lerobot(tmp_path / "corridor", env, episodes)
    told = json.loads((folder / "meta" / "stats.json").read_text())["action"]
    actions = np.concatenate([one.actions for one in episodes]).astype(float)
    assert told["count"] == [11]
    for figure, expected in (("mean", actions.mean(0)), ("std", actions.std(0)), ("max", actions.max(0))):
        assert np.allclose(told[figure], expected)


def test_episodes_beyond_a_file_go_into_the_next(env, episodes, tmp_path, monkeypatch):
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr(lerobot_dataset, "_FILE_MB", 1e-6)
    folder = write_lerobot(tmp_path / "corridor", env, episodes)
    assert len(list((folder / "data").rglob("*.parquet"))) == 2
    rows = parquet.read_table(folder / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    assert [row["data/file_index"] for row in rows] == [0, 1]


def test_equal_episodes_make_equal_bytes(env, episodes, tmp_path):
    pytest.importorskip("minari")
    for name in ("a", "b"):
        write_minari(tmp_path / name, "tagalong/corridor/pid-v0", env, episodes)
        write_lerobot(tmp_path / name / "lerobot", env, episodes)
    first, second = (
        {
            path.relative_to(tmp_path / name): path.read_bytes()
            for path in (tmp_path / name).rglob("*")
            if path.is_file()
        }
        for name in ("a", "b")
    )
    assert first == second


def test_what_is_not_installed_is_named_with_its_extra(monkeypatch):
    for module, check in (("minari", minari_dataset.check_minari), ("pyarrow", lerobot_dataset.check_lerobot)):
        monkeypatch.setitem(__import__("sys").modules, module, None)
        with pytest.raises(ImportError, match='need the extra "datasets"'):
            check()
