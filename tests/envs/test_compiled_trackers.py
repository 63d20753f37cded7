"""The real tracker in compiled worlds: what the onboard stack of the single environment knows by the same sweeps."""

import gymnasium as gym
import numpy as np
import pytest
from tagalong.envs.compiled.trackers import Trackers
from tagalong.envs.episode_setup import OnboardStackFactory
from tagalong.envs.task.observation import leader_entry, people_entry
from tagalong.slam import LaserScan

WORLDS = 4


def worlds(name="Office", **fields):
    given = {"workers": 1, "episodes_ahead": 4, "people_count": 6, "people": "tracker", "max_episode_steps": 150}
    made = gym.make_vec(
        f"tagalong/{name}-v0", WORLDS, "vector_entry_point", simulator="compiled", **{**given, **fields}
    )
    return made


def towards(leader):
    """Actions that follow `leader` (w, 6) from a distance, so that there is something to know, once it is known."""
    away, bearing = np.hypot(leader[:, 0], leader[:, 1]), np.arctan2(leader[:, 1], leader[:, 0])
    return (leader[:, 4:5] > 0.0) * np.clip(np.stack((0.8 * (away - 1.2), 1.5 * bearing), axis=1), -1.0, 1.0)


class Stacks:
    """An onboard stack for each world, fresh in each episode, which reads the sweeps that the worlds took."""

    def __init__(self, env):
        self.env, self.make, self.made = env, OnboardStackFactory(env.config).make, {}

    def entries(self, w):
        state, told, lidar = self.env._state, self.env._told, self.env.config.sensors.lidar
        episode = int(state.seed[w]), int(state.episode[w])
        if self.made.get(w, (None,))[0] != episode:
            self.made[w] = episode, self.make(None, np.random.default_rng(0))
        limits = lidar.range_min, lidar.range_max, float(told.time_s[w])
        scan = LaserScan(told.ranges[w].copy(), lidar.bearings, *limits, lidar.mount)
        belief = self.made[w][1].update(scan, state.odometry[w].copy())
        slots = self.env.config.observation.people_slots
        return leader_entry(belief), people_entry(belief.people_robot, belief.leader_id, slots), belief


@pytest.mark.parametrize(("name", "beams"), [("Office", 360), ("MeetingRoom", 1081)])
def test_each_world_knows_what_the_onboard_stack_knows_by_the_same_sweeps(name, beams):
    env, known, lost = worlds(name, beams=beams), 0, 0
    observation, info = env.reset(seed=5)
    stacks = Stacks(env.unwrapped)
    for k in range(320):
        for w in range(WORLDS):
            leader, people, belief = stacks.entries(w)
            np.testing.assert_allclose(observation["leader"][w], leader, atol=2e-6)
            np.testing.assert_allclose(observation["people"][w], people, atol=2e-6)
            assert (info["leader_id"][w], info["tracked_people"][w]) == (belief.leader_id, len(belief.people))
            known += len(belief.people)
            lost += belief.leader is not None and belief.leader_id < 0
        actions = towards(observation["leader"])
        actions[1::2] *= k % 150 < 60  # half of the robots lose their leaders
        observation, *_, info = env.step(actions)
    assert known > 500
    assert lost > 10 or name != "Office"  # in a room everybody is in view
    assert (env.unwrapped._state.episode > 0).all()
    env.close()


def test_a_thousand_worlds_take_no_more_than_two_gibibytes():
    env = worlds(beams=360)
    observation, _ = env.reset(seed=9)
    for _ in range(60):
        observation, *_ = env.step(towards(observation["leader"]))
    assert env.unwrapped._trackers.memory / WORLDS * 1024 < 2**30  # and as much for all else
    env.close()


def test_where_there_is_no_room_for_a_sweep_it_is_made_and_nothing_else_changes():
    told = []
    for little in (False, True):
        env = worlds(beams=360, workers=2)
        if little:
            env.unwrapped._trackers = Trackers(env.unwrapped.config, WORLDS, room=2, pages=4)
        trackers = env.unwrapped._trackers
        observation, _ = env.reset(seed=9)
        told.append([])
        for _ in range(60):
            told[-1] += [observation[key].tobytes() for key in ("leader", "people", "scan")]
            observation, reward, *_ = env.step(towards(observation["leader"]))
            told[-1].append(reward.tobytes())
        assert trackers._minds.tracks.hypotheses.shape[1] >= 16
        assert trackers._minds.tracks.cells.cells.shape[1] >= 64 * 100
        assert env.unwrapped.memory > trackers.memory > WORLDS * 1.5e5
        env.close()
    assert told[0] == told[1]
