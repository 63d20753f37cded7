"""Training runs: killed and going on, ended by the clock, and folders that hold no run. Needs the extra `learn`."""

import base64
import json
import os
import pickle
import shutil
import signal
import subprocess
import sys
import time
import zipfile
from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason='training needs the extra "learn"')
pytest.importorskip("sb3_contrib", reason='training needs the extra "learn"')

import small_training  # noqa: E402
from small_training import tiny  # noqa: E402
from tagalong.agents.learned.follower import load_policy  # noqa: E402
from tagalong.agents.learned.network import Network  # noqa: E402
from tagalong.agents.training.models import mean_output  # noqa: E402
from tagalong.agents.training.presets import ImitationConfig, ReinforcementConfig  # noqa: E402
from tagalong.agents.training.run import RunConfig, TrainingRun  # noqa: E402
from tagalong.slam import InputError  # noqa: E402


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A tiny run from beginning to end: its folder, its progress, and the lines that it told."""
    folder, lines = tmp_path_factory.mktemp("whole"), []
    return folder, TrainingRun(RunConfig(preset=tiny(), name="tiny"), folder, lines.append).train(), lines


def test_imitation_lowers_the_error_and_the_exported_policy_drives(whole):
    folder, progress, lines = whole
    errors = [float(line.rsplit(" ", 1)[1]) for line in lines if "error" in line]
    assert errors[-1] < 0.8 * errors[0]
    assert len(progress.evaluations) == 3
    arrays, config = load_policy(folder)
    inputs = {name: np.zeros(shape, np.float32) for name, shape in config.features.shapes.items()}
    assert Network(arrays)(inputs).shape == (2,)
    with pytest.raises(InputError, match="other settings"):
        TrainingRun(RunConfig(preset=tiny(width=16), name="tiny"), folder, lines.append)


CHILD = """
import sys
sys.path.insert(0, {helpers!r})
from pathlib import Path
from small_training import tiny
from tagalong.agents.training.run import RunConfig, TrainingRun
if __name__ == "__main__":
    TrainingRun(RunConfig(preset=tiny(), name="tiny"), Path({folder!r}), print).train()
"""


def test_a_killed_run_goes_on_and_its_evaluations_are_those_of_an_undisturbed_one(tmp_path, whole):
    code = CHILD.format(helpers=os.path.dirname(small_training.__file__), folder=str(tmp_path / "killed"))
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.DEVNULL)
    index = tmp_path / "killed" / "checkpoint.json"
    deadline = time.monotonic() + 120.0
    while not index.is_file() and child.poll() is None and time.monotonic() < deadline:
        time.sleep(0.02)
    child.send_signal(signal.SIGKILL)
    child.wait()
    assert index.is_file()
    resumed = TrainingRun(RunConfig(preset=tiny(), name="tiny"), tmp_path / "killed", lambda line: None).train()
    assert resumed.evaluations == whole[1].evaluations


class Killed(Exception):
    """Stands for SIGKILL: nothing more is done."""


def killed_after_every(word, run):
    """Run until it is done, killed after each line with `word`; return its progress and the number of kills."""
    seen, kills = set(), 0

    def tick(line):
        if word in line and line not in seen:
            seen.add(line)
            raise Killed

    while True:
        one = run(tick)
        try:
            return one.train(), kills
        except Killed:
            kills += 1


def test_a_run_that_is_killed_after_every_drive_and_pass_of_its_first_round_on_loses_none(tmp_path, whole):
    def run(tick):
        return TrainingRun(RunConfig(preset=tiny(), name="tiny"), tmp_path, tick)

    progress, kills = killed_after_every("imitation round", run)
    assert kills == 3 * (2 + 2)
    assert progress.evaluations == whole[1].evaluations
    ours, theirs = (dict(np.load(folder / "policy.npz")) for folder in (tmp_path, whole[0]))
    assert all((ours[name] == theirs[name]).all() for name in theirs)


def test_a_finished_run_is_not_trained_on(tmp_path, whole):
    again = TrainingRun(RunConfig(preset=tiny(), name="tiny"), whole[0], lambda line: None).train()
    assert again.evaluations == whole[1].evaluations


def test_the_time_that_is_given_includes_evaluations(tmp_path, monkeypatch):
    clock, lines = [0.0], []
    monkeypatch.setattr("tagalong.agents.training.running.time.monotonic", lambda: clock[0])

    def tick(line):
        lines.append(line)
        clock[0] += 60.0

    preset = tiny(imitation=replace(tiny().imitation, rounds=1), evaluations=4)
    minutes = 2 + 2 + 2  # drives, passes, and two of the four episodes of the evaluation
    early = TrainingRun(RunConfig(preset=preset, name="tiny", max_minutes=minutes), tmp_path, tick).train()
    assert lines[-1] == "evaluating after imitation 1: episode 2/4"
    assert (early.evaluations, early.rounds) == ([], 1)
    card = json.loads((tmp_path / "policy.json").read_text())
    assert card["evaluation"] is None  # there is a policy all the same
    done = TrainingRun(RunConfig(preset=preset, name="tiny"), tmp_path, lines.append).train()
    assert [one["after"] for one in done.evaluations] == ["imitation 1"]
    assert json.loads((tmp_path / "policy.json").read_text())["evaluation"] == done.evaluations[0]


def spying_zip(file, trace):
    """Write a model as stable-baselines3 does, which leaves a trace where it is loaded."""

    class Spy:
        def __reduce__(self):
            return type(trace).touch, (trace,)

    data = {"spy": {":type:": "Spy", ":serialized:": base64.b64encode(pickle.dumps(Spy())).decode()}}
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("data", json.dumps(data))


def test_a_run_whose_index_names_a_pickle_is_refused_and_the_pickle_not_opened(tmp_path):
    config = RunConfig(preset=tiny(), name="tiny")
    TrainingRun(config, tmp_path / "run", lambda line: None)  # writes the settings
    for name in ("model.zip", "run/model_1.safetensors"):
        spying_zip(tmp_path / name, tmp_path / "trace")
    progress = {"rounds": 1, "steps": 0, "rollouts": 0, "minutes": 0.1, "best": None, "evaluations": []}
    progress |= {"curriculum": {"level": 0, "drawn": 0, "recent": []}, "passes": 0, "error": 0.0, "due": ""}
    for model, said in (("../model.zip", "must be a whole number"), (1, "no checkpoint of this run|too large")):
        (tmp_path / "run" / "checkpoint.json").write_text(json.dumps({**progress, "model": model}))
        with pytest.raises(InputError, match=said):
            TrainingRun(config, tmp_path / "run", lambda line: None)
    assert not (tmp_path / "trace").exists()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"rounds": 4}, "`rounds` can be 3 at most"),
        ({"passes": 1}, "`passes` can be 0 at most"),
        ({"rounds": 2, "passes": 3}, "`passes` can be 2 at most"),
        ({"rounds": 2, "passes": 1}, "needs fit/"),
        ({"curriculum": {}}, "a curriculum's state needs `level`"),
        ({"curriculum": {"level": 9, "drawn": 0, "recent": []}}, "a curriculum's state needs `level`"),
        ({"curriculum": {"level": 0, "drawn": 0, "recent": [1]}}, "a curriculum's state needs `recent`"),
    ],
)
def test_a_checkpoint_that_does_not_fit_its_run_is_told_in_one_line(tmp_path, whole, change, said):
    shutil.copytree(whole[0], tmp_path / "run")
    index = tmp_path / "run" / "checkpoint.json"
    index.write_text(json.dumps({**json.loads(index.read_text()), **change}))
    with pytest.raises(InputError, match=said):
        TrainingRun(RunConfig(preset=tiny(), name="tiny"), tmp_path / "run", lambda line: None)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"labels": np.zeros((9, 3), np.float32)}, r"labels must be floats \(9, 2\)"),
        ({"labels": np.float32(1.0)}, "needs 1 to 120 rows"),
        ({"labels": np.zeros((121, 2), np.float32)}, "needs 1 to 120 rows"),
        ({"scan": np.zeros((9, 2, 8), np.float16)}, "scan must be floats"),
        ({"vector": np.array(["a"])}, "vector must be floats"),
        ({"scan": np.full((9, 2, 90), np.nan, np.float16)}, "scan has values that are not finite"),
        ({"more": np.zeros(1)}, "needs the arrays"),
    ],
)
def test_a_table_of_demonstrations_that_is_none_is_told_in_one_line(tmp_path, change, said):
    preset, folder = tiny(), tmp_path / "demonstrations"
    folder.mkdir()
    shapes = preset.pilot.features.shapes
    table = {name: np.zeros((9, *shape), np.float16) for name, shape in shapes.items()}
    np.savez(folder / "round_0.npz", **{**table, "labels": np.zeros((9, 2), np.float32), **change})
    with pytest.raises(InputError, match=said):
        TrainingRun(RunConfig(preset=preset, name="tiny"), tmp_path, lambda line: None).train()


@pytest.mark.parametrize("seed", [-1, 1 << 32])
def test_a_seed_that_no_generator_takes_is_refused(seed):
    with pytest.raises(InputError, match="a run's seed is a whole number from 0"):
        RunConfig(preset=tiny(), name="tiny", seed=seed)


def test_more_workers_than_a_machine_holds_are_refused():
    with pytest.raises(InputError, match="1 to 64 workers"):
        RunConfig(preset=tiny(), name="tiny", workers=100_000)


def test_reinforcement_goes_on_from_its_checkpoint(tmp_path):
    config = ReinforcementConfig(steps=64, num_envs=2, rollout=16, evaluate_every=100, critic_rollouts=1)
    preset = tiny(imitation=ImitationConfig(rounds=0), reinforcement=config, most_steps=30)
    early = RunConfig(preset=preset, name="tiny", max_minutes=1e-9)
    first = TrainingRun(early, tmp_path, lambda line: None).train()
    assert first.steps == 0
    done = TrainingRun(RunConfig(preset=preset, name="tiny"), tmp_path, lambda line: None).train()
    assert done.rollouts >= 1
    assert len(done.evaluations) == 1
    again = TrainingRun(RunConfig(preset=preset, name="tiny"), tmp_path, lambda line: None)
    assert again.progress.evaluations == done.evaluations
    assert mean_output(
        again._model, {k: torch.zeros(1, *s) for k, s in preset.pilot.features.shapes.items()}
    ).shape == (1, 2)
