"""What `tagalong train follower` prints."""

from tagalong.scripts.training.follower import ProgressLines


def test_a_resumed_run_counts_the_minutes_before_it(capsys):
    lines = ProgressLines()
    lines.go_on(12.0)
    lines("too soon to be told")
    lines("evaluation after imitation 3")
    told = capsys.readouterr().out.splitlines()
    assert told == ["  12.0 min  going on from the last checkpoint", "  12.0 min  evaluation after imitation 3"]
