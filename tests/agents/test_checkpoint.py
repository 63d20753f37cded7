"""Checkpoints of a training run: whole after a kill, nothing in them runs code, and damaged ones are told."""

import json
import struct

import numpy as np
import pytest

pytest.importorskip("stable_baselines3", reason="checkpoints need the extra learn")

from tagalong.agents.training import checkpoint
from tagalong.agents.training.checkpoint import Progress, load_arrays, load_progress, save_checkpoint
from tagalong.slam import InputError

SHAPES = {"policy/a": (2, 3), "optimizer/0/step": (), "optimizer/0/exp_avg": (2, 3)}


def arrays(value=1.0):
    return {name: np.full(shape, value, dtype=np.float32) for name, shape in SHAPES.items()}


def loaded(folder):
    progress, file = load_progress(folder)
    return progress, load_arrays(file, SHAPES)


def test_what_was_saved_comes_back(tmp_path):
    evaluation = {"after": "imitation 1", "mean_return": 2.5, "success": 1.0, "returns": [2.5]}
    progress = Progress(rounds=2, passes=1, error=0.25, rollouts=5, minutes=3.0, best=2.5, due="imitation 2")
    progress.evaluations, progress.curriculum = [evaluation], {"level": 1, "drawn": 9, "recent": [True]}
    save_checkpoint(tmp_path, arrays(3.5), progress)
    again, content = loaded(tmp_path)
    assert again == progress
    assert all((content[name] == value).all() for name, value in arrays(3.5).items())


@pytest.mark.parametrize("dies", ["save", "write_json"])
def test_who_dies_while_saving_leaves_the_checkpoint_before_whole(tmp_path, monkeypatch, dies):
    save_checkpoint(tmp_path, arrays(1.0), Progress(rounds=2, rollouts=5))

    def killed(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(checkpoint, dies, killed)
    with pytest.raises(KeyboardInterrupt):
        save_checkpoint(tmp_path, arrays(2.0), Progress(rounds=2, rollouts=5, steps=7))
    monkeypatch.undo()
    progress, content = loaded(tmp_path)
    assert (progress.steps, content["policy/a"][0, 0]) == (0, 1.0)
    save_checkpoint(tmp_path, arrays(3.0), Progress(rounds=3))
    progress, content = loaded(tmp_path)
    assert (progress.rounds, content["policy/a"][0, 0]) == (3, 3.0)


def test_a_full_disk_is_told_in_one_line_and_leaves_the_checkpoint_before(tmp_path, monkeypatch):
    save_checkpoint(tmp_path, arrays(1.0), Progress(rounds=2))

    def full(self, content):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    with pytest.raises(InputError, match=r"cannot be written \(No space left on device\)"):
        save_checkpoint(tmp_path, arrays(2.0), Progress(rounds=3))
    assert loaded(tmp_path)[1]["policy/a"][0, 0] == 1.0


def test_only_the_newest_arrays_are_kept(tmp_path):
    for k in range(12):
        save_checkpoint(tmp_path, arrays(float(k)), Progress(rounds=k))
    assert loaded(tmp_path)[1]["policy/a"][0, 0] == 11.0
    assert len(list(tmp_path.iterdir())) == 2


def test_an_index_that_names_a_file_opens_none(tmp_path):
    (tmp_path / "run").mkdir()
    save_checkpoint(tmp_path / "run", arrays(), Progress())
    index = tmp_path / "run" / "checkpoint.json"
    content = json.loads(index.read_text())
    for name in ("../model.zip", "model.zip", "/etc/passwd", 1.5, -1, True, None, 10**20):
        index.write_text(json.dumps({**content, "model": name}))
        with pytest.raises(InputError, match=r"checkpoint.json: .*`model` must be a whole number"):
            load_progress(tmp_path / "run")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"rounds": -1}, "`rounds` must be"),
        ({"rounds": "3"}, "`rounds` must be"),
        ({"steps": 1e300}, "`steps` must be"),
        ({"minutes": None}, "`minutes` must be"),
        ({"best": [1]}, "`best` must be"),
        ({"due": "x" * 5000}, "`due` must be"),
        ({"evaluations": {}}, "`evaluations` must be"),
        ({"evaluations": [3]}, r"evaluations\[0\]: `after` must be"),
        (
            {"evaluations": [{"after": "a", "mean_return": 1.0, "success": 1.0, "returns": ["a"]}]},
            r"evaluations\[0\]: `returns\[0\]` must be",
        ),
        ({"curriculum": [1]}, "`curriculum` must be"),
    ],
)
def test_an_index_with_wrong_entries_is_told_in_one_short_line(tmp_path, change, said):
    save_checkpoint(tmp_path, arrays(), Progress())
    index = tmp_path / "checkpoint.json"
    index.write_text(json.dumps({**json.loads(index.read_text()), **change}))
    with pytest.raises(InputError, match=said) as told:
        load_progress(tmp_path)
    assert len(str(told.value).replace(str(tmp_path), "")) < 300
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    "text", ["", "[]", "3", "[" * 100_000, '{"model": ' + "9" * 5000 + "}", '{"model": NaN}', "\0"]
)
def test_an_index_that_is_none_is_told(tmp_path, text):
    (tmp_path / "checkpoint.json").write_text(text)
    with pytest.raises(InputError, match=r"checkpoint\.json"):
        load_progress(tmp_path)


def tensors(header, body=b"", length=None):
    """The bytes of a safetensors file with such a header."""
    text = json.dumps(header).encode()
    return struct.pack("<Q", len(text) if length is None else length) + text + body


def entry(shape, start, end, dtype="F32"):
    return {"dtype": dtype, "shape": shape, "data_offsets": [start, end]}


BROKEN = {
    "empty": b"",
    "cut": tensors({"policy/a": entry([2, 3], 0, 24)}, bytes(20)),
    "huge header": tensors({}, length=2**62),
    "long header": tensors({}, b" " * 100, length=2**21),
    "huge shape": tensors({"policy/a": entry([2**62, 2**62], 0, 24)}, bytes(24)),
    "gigabytes": tensors({"policy/a": entry([2**30], 0, 2**32)}, bytes(24)),
    "wrong shape": tensors({"policy/a": entry([3, 2], 0, 24)}, bytes(24)),
    "wrong kind": tensors({"policy/a": entry([2, 3], 0, 12, "BF16")}, bytes(12)),
    "unknown": tensors({"spy": entry([2, 3], 0, 24)}, bytes(24)),
    "nan": tensors({"policy/a": entry([2, 3], 0, 24)}, np.full(6, np.nan, dtype="<f4").tobytes()),
    "overlap": tensors({"policy/a": entry([2, 3], 0, 24), "optimizer/0/step": entry([], 0, 4)}, bytes(24)),
    "deep": struct.pack("<Q", 200_000) + b"[" * 200_000,
    "too long": tensors({"policy/a": entry([2, 3], 0, 24)}, bytes(24) + bytes(2**21)),
    "zip": b"PK\3\4" + bytes(100),
}


@pytest.mark.parametrize("kind", sorted(BROKEN))
def test_arrays_that_are_none_of_this_run_are_told(tmp_path, kind):
    file = tmp_path / "model_1.safetensors"
    file.write_bytes(BROKEN[kind])
    with pytest.raises(InputError, match=r"model_1\.safetensors: (no checkpoint of this run|is too large)") as told:
        load_arrays(file, SHAPES)
    assert "\n" not in str(told.value)


def test_arrays_that_are_not_there_are_told(tmp_path):
    save_checkpoint(tmp_path, arrays(), Progress())
    _, file = load_progress(tmp_path)
    file.unlink()
    with pytest.raises(InputError, match="no such file"):
        load_arrays(file, SHAPES)
