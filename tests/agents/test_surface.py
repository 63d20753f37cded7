"""The door of the followers: what is public, and that its manual is true."""

import doctest
import subprocess
import sys

import pytest
import tagalong.agents

SURFACE = {
    "EXPLORERS",
    "FOLLOWERS",
    "DWAConfig",
    "DWAFollower",
    "Follower",
    "FrontierExplorer",
    "LearnedFollower",
    "PIDConfig",
    "PIDFollower",
    "PurePursuitConfig",
    "PurePursuitFollower",
    "RandomWalk",
    "RandomWalkConfig",
    "TourConfig",
    "following_tour",
    "make_follower",
}


def test_the_surface_is_this_and_every_name_is_there():
    assert set(tagalong.agents.__all__) == SURFACE
    for name in SURFACE:
        assert getattr(tagalong.agents, name) is not None
        assert name in dir(tagalong.agents)
        assert name in (tagalong.agents.__doc__ or "")


def test_another_name_is_told():
    with pytest.raises(AttributeError, match=r"module 'tagalong.agents' has no attribute 'Nobody'"):
        _ = tagalong.agents.Nobody  # pyright: ignore[reportAttributeAccessIssue]


def test_the_example_of_the_manual_runs():
    assert doctest.testmod(tagalong.agents) == (0, 7)


def test_a_name_of_the_door_is_not_hidden_by_a_module_of_that_name():
    asked = "from tagalong.agents import following_tour as tour; tour.__call__"
    code = f"import tagalong.agents.tour, tagalong.agents.roster; {asked}"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
