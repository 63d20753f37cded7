"""The experiment on recall over distance."""

import numpy as np
from tagalong.scripts.benchmarks import recall_by_distance


def test_near_people_are_found_and_counted_once():
    there, found, _ = recall_by_distance.drive_counts(1, 1081, 0.0, 6.0)
    assert there[:2].sum() > 30
    assert np.all(found <= there)
    assert found[0] > 0.5 * there[0]


def test_the_table_has_a_line_for_each_distance(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(recall_by_distance, "BEAMS", (360,))
    words = ["--seeds", "1", "--seconds", "3", "--out", str(tmp_path)]
    assert recall_by_distance.main(words) == 0
    printed = capsys.readouterr().out
    assert "360 beams, by spacing" in printed
    assert len(printed.splitlines()) == 2 + len(recall_by_distance.EDGES) - 1
    assert (tmp_path / "recall_by_distance.json").exists()
