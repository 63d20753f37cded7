"""Episodes shown in rerun's viewer while they are driven: here the stream flows into memory."""

import pickle

import gymnasium as gym
import numpy as np
import pytest
from tagalong.envs.topview import rendering
from tagalong.envs.viewing import live
from tagalong.slam import InputError
from tagalong.slam.errors import MissingExtraError

PLAIN = {"people": "truth", "beams": 90, "slam": "truth", "disable_env_checker": True}


@pytest.fixture
def viewers(monkeypatch):
    """The streams that were opened, each with what has flown through it."""
    pytest.importorskip("rerun")
    opened = []
    monkeypatch.setattr(live, "open_viewer", lambda stream: opened.append((stream, stream.memory_recording())))
    monkeypatch.setattr(rendering, "has_display", lambda: True)
    return opened


def flown(viewers):
    ((stream, memory),) = viewers
    stream.flush()
    return memory.num_msgs()


def test_every_moment_is_shown_once_without_being_asked_for(viewers):
    env = gym.make("tagalong/Corridor-v0", render_mode="rerun", **PLAIN)
    assert "rerun" in env.unwrapped.metadata["render_modes"]
    assert viewers == []  # opened with the first moment
    env.reset(seed=0)
    first = flown(viewers)
    env.step(np.array([0.5, 0.0]))
    second = flown(viewers)
    assert env.render() is None
    assert flown(viewers) == second > first > 0
    env.reset(seed=1)  # in the same viewer
    assert flown(viewers) > second
    pickle.loads(pickle.dumps(env.unwrapped._renderer)).close()
    env.close()


def test_what_is_shown_is_what_a_recording_has(viewers):
    env = gym.make("tagalong/Corridor-v0", render_mode="rerun", **PLAIN)
    env.reset(seed=0)
    flown(viewers)
    content = viewers[0][1].drain_as_bytes()
    for entity in (b"map/odom/base_link/laser/scan_filtered", b"map/odom/people", b"world/truth/pose", b"map/path"):
        assert entity in content, entity
    env.close()


def test_without_a_display_or_the_extra_a_live_view_is_refused_in_a_line(monkeypatch):
    pytest.importorskip("rerun")
    monkeypatch.setattr(rendering, "has_display", lambda: False)
    with pytest.raises(InputError, match="a live view needs a display"):
        gym.make("tagalong/Corridor-v0", render_mode="rerun", **PLAIN)
    assert "rerun" not in rendering.possible_modes()
    monkeypatch.setattr(live, "find_spec", lambda name: None)
    with pytest.raises(MissingExtraError, match='"rerun"'):
        gym.make("tagalong/Corridor-v0", render_mode="rerun", **PLAIN)
