"""Checkpoints of a training run."""

import pytest

pytest.importorskip("stable_baselines3", reason="checkpoints need the extra learn")

from tagalong.agents.training.checkpoint import Progress, load_checkpoint, save_checkpoint


class Model:
    """Writes two halves; may be killed between them."""

    def __init__(self, text, dies=False):
        self.text, self.dies = text, dies

    def save(self, path):
        path.write_text(self.text[:2])
        if self.dies:
            raise KeyboardInterrupt
        path.write_text(self.text)


def test_who_dies_while_saving_leaves_the_checkpoint_before_whole_even_under_the_same_name(tmp_path):
    progress = Progress(rounds=2, rollouts=5, minutes=3.0)
    save_checkpoint(tmp_path, Model("first"), progress)
    with pytest.raises(KeyboardInterrupt):
        save_checkpoint(tmp_path, Model("other", dies=True), progress)
    again, file = load_checkpoint(tmp_path)
    assert file.read_text() == "first"
    assert again == progress


def test_only_the_newest_model_is_kept(tmp_path):
    save_checkpoint(tmp_path, Model("first"), Progress(rounds=1))
    save_checkpoint(tmp_path, Model("later"), Progress(rounds=2, best=4.0))
    progress, file = load_checkpoint(tmp_path)
    assert (progress.rounds, progress.best, file.read_text()) == (2, 4.0, "later")
    assert [each.name for each in tmp_path.glob("*.zip")] == [file.name]
