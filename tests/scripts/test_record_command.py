"""`tagalong record`: followers' episodes as datasets."""

import json
import sys

import pytest
from tagalong.envs.suites import suite
from tagalong.scripts.cli import main
from tagalong.scripts.runs import demonstrations

SHORT = ["--beams", "181", "--set", "lost_limit_s=0.3", "--set", "people.source=truth"]


@pytest.fixture
def minari(tmp_path, monkeypatch):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "minari"))
    return pytest.importorskip("minari")


def test_each_follower_has_a_dataset_in_both_formats(tmp_path, minari):
    words = ["record", "--followers", "plain_pid,pid+guard", "--episodes", "2", *SHORT, "--out", str(tmp_path)]
    assert main(words) == 0
    assert sorted(minari.list_local_datasets()) == ["tagalong/corridor/pid-guard-v0", "tagalong/corridor/plain_pid-v0"]
    dataset = minari.load_dataset("tagalong/corridor/pid-guard-v0")
    assert dataset.storage.metadata["algorithm_name"] == "pid+guard"
    told = json.loads((tmp_path / "record.json").read_text())
    assert [row["seed"] for row in told["episodes"]] == [0, 1, 0, 1]
    assert sum(row["steps"] for row in told["episodes"][2:]) == dataset.total_steps
    assert (tmp_path / "lerobot" / "corridor" / "plain_pid" / "meta" / "info.json").is_file()


def test_what_was_driven_is_not_driven_again(tmp_path, minari, monkeypatch):
    words = ["record", *SHORT, "--formats", "minari", "--out", str(tmp_path), "--episodes"]
    assert main([*words, "1"]) == 0
    driven = []
    drive = demonstrations.demonstrate

    def noted(*given, seed, **more):
        driven.append(seed)
        return drive(*given, seed=seed, **more)

    monkeypatch.setattr(demonstrations, "demonstrate", noted)
    assert main([*words, "3"]) == 0
    assert driven == [1, 2]
    assert minari.load_dataset("tagalong/corridor/pid-v0").total_episodes == 3


def test_a_suite_of_several_environments_has_a_dataset_of_each(tmp_path, minari):
    words = ["record", "--suite", "follow-bench", "--episodes", "2", *SHORT, "--formats", "minari"]
    assert main([*words, "--out", str(tmp_path)]) == 0
    names = sorted(minari.list_local_datasets())
    assert names == ["tagalong/follow-bench-doorway/pid-v0", "tagalong/follow-bench-narrow_corridor/pid-v0"]
    assert minari.load_dataset(names[0]).recover_environment().unwrapped.config.world.scene == "doorway"
    one = next(iter(minari.load_dataset(names[0]).storage.get_episode_metadata([0])))
    assert (one["seed"], one["options"]) == (1, {"people": 9})


def test_cells_of_a_suite_that_differ_in_options_alone_share_a_dataset_named_after_their_building():
    asked = demonstrations.Asked(
        followers=["pid"],
        place="hard-v2",
        scenarios=suite("hard-v2"),
        episodes=12,
        seed=0,
        arguments={"slam": None, "beams": 90},
        formats=[],
    )
    counts = {dataset.name: len(dataset.cells) for dataset in demonstrations.datasets_asked(asked)}
    assert counts["hard-v2-tight_office/pid"] == 3
    assert counts["hard-v2-clutter-30-20/pid"] == 1
    assert sum(counts.values()) == 12


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--followers", "nobody"], "unknown follower 'nobody'"),
        (["--followers", ","], "--followers names nobody"),
        (["--followers", "frontier"], "frontier explores without a leader"),
        (["--followers", "pid", "pid+"], "must differ in letters and numbers"),
        (["--suite", "office", "--people", "3"], "leave out --people"),
        (["--people", "0"], "argument --people: must be a whole number of at least 1, got '0'"),
        (["--episodes", "0"], "--episodes: must be a whole number of at least 1"),
        (["--set", "no.such=1"], "no.such"),
    ],
)
def test_what_cannot_be_recorded_is_told_in_a_line(words, told, tmp_path, capsys):
    pytest.importorskip("minari")
    assert main(["record", *words, "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert told in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_without_the_extra_it_is_named_before_any_drive(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "minari", None)
    assert main(["record", "--out", str(tmp_path / "out")]) == 2
    assert 'need the extra "datasets"' in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
