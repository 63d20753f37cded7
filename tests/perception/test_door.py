"""The public surface of perception: what it lists is there, its manual is true, and to open it costs nothing."""

import doctest
import subprocess
import sys

import tagalong.perception as door


def test_every_public_name_can_be_imported_and_lives_where_type_checkers_look():
    assert sorted(door.__all__) == sorted(door._HOME)
    for name in door.__all__:
        assert getattr(door, name).__name__ == name
    assert set(door.__all__) <= set(dir(door))


def test_the_surface_is_this():
    assert " ".join(door.__all__) == (
        "BodyLeaderSelector Detections FilteredScan ImmobileMapper LeaderSelector LegDetector LegDetectorConfig "
        "LegForest People PeopleFilter PeopleFilterConfig PeopleFinder PeopleTracker PerceptionConfig PlaneFinder "
        "TrackerConfig filtered_scans perception_preset table_ii"
    )


def test_the_manual_is_one_screen_and_its_example_runs():
    assert door.__doc__ is not None
    assert len(door.__doc__.splitlines()) < 45
    result = doctest.testmod(door)
    assert result.attempted >= 6
    assert result.failed == 0


def test_opening_the_door_imports_nothing_heavy():
    said = "import sys, tagalong.perception as p; print([m for m in ('numba', 'scipy', 'sklearn') if m in sys.modules])"
    run = subprocess.run([sys.executable, "-c", said], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_an_unknown_name_is_an_attribute_error():
    assert not hasattr(door, "PeopleFilterr")
