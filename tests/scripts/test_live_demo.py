"""`tagalong demo --live`."""

import pytest
from tagalong.scripts.cli import main
from tagalong.scripts.commands import demo
from tagalong.scripts.lab import episode_recordings


class Shown:
    """Stands for a recording that is shown at once."""

    def __init__(self):
        self.opened = True

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.opened = False


def test_a_live_view_without_a_display_is_refused_before_the_drive(tmp_path, capsys, monkeypatch):
    pytest.importorskip("rerun")
    monkeypatch.setattr(demo, "has_display", lambda: False)
    assert main(["demo", "--live", "--out", str(tmp_path / "out")]) == 2
    assert "a live view needs a display" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_episodes_are_shown_where_that_was_asked_for_and_the_view_ends_with_them(monkeypatch):
    shown = []
    monkeypatch.setattr(episode_recordings, "LiveRecording", lambda: shown.append(Shown()) or shown[-1])
    with episode_recordings.shown_episodes(False):
        assert shown == []
    with episode_recordings.shown_episodes(True):
        assert shown[0].opened
    assert not shown[0].opened
