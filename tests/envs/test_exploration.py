"""Episodes without a leader, and how much of a building was seen."""

import gymnasium as gym
import numpy as np
import pytest
import tagalong  # noqa: F401 (registers the ids)
from gymnasium.utils.env_checker import check_env
from tagalong.envs.metrics.exploration import exploration_metrics
from tagalong.envs.recording.rollout import rollout
from tagalong.envs.scenes.scene import Scene
from tagalong.envs.scenes.solids import Solid
from tagalong.envs.task.coverage import CELL_M, FARTHEST_M, Coverage
from tagalong.envs.task.coverage_kernels import sweep, sweep_reference
from tagalong.perception import PeopleFilter
from tagalong.perception.tracking import NoLegs
from tagalong.slam import InputError, LaserScan

SMALL = {"beams": 361, "slam": None}


def of_nobody(scan):
    """A scan in which nobody is known or suspected."""
    return PeopleFilter(detector=NoLegs()).update(scan, np.zeros(3))


def make(**arguments):
    return gym.make("tagalong/Corridor-v0", disable_env_checker=True, **{**SMALL, "leader": False, **arguments})


class Constant:
    """Always the same action."""

    def __init__(self, *action):
        self.action = np.array(action, dtype=np.float32)

    def reset(self):
        pass

    def act(self, observation):
        return self.action


def two_rooms():
    """A room of 4 x 4 m around the origin, and one behind a wall to the right that nobody can see or reach."""
    walls = [(0.0, 2.1, 6.4, 0.1), (0.0, -2.1, 6.4, 0.1), (-2.1, 0.0, 0.1, 2.2), (2.1, 0.0, 0.1, 2.2)]
    walls.append((6.1, 0.0, 0.1, 2.2))
    solids = tuple(Solid(kind="wall", x=x, y=y, half_length=length, half_width=width) for x, y, length, width in walls)
    return Scene(
        name="two rooms",
        solids=solids,
        floor=np.array([(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)]),
        routes={"only": np.array([(0.0, 0.0), (4.0, 0.0)])},
        route_name="only",
        lap=0.0,
        half_width=1.0,
        standing_places=np.empty((0, 2)),
    )


def square_scan(half, bearings):
    ranges = half / np.maximum(np.abs(np.cos(bearings)), np.abs(np.sin(bearings)))
    return LaserScan(ranges, bearings, 0.05, 30.0)


@pytest.mark.parametrize("seed", range(3))
def test_the_kernel_marks_what_its_reference_marks(seed):
    rng = np.random.default_rng(seed)
    blocked = rng.random((20, 30)) < 0.1
    blocked[8, 11] = False
    ends = rng.uniform(-5.0, 35.0, (40, 2))
    one, other = np.zeros_like(blocked), np.zeros_like(blocked)
    sweep(11.3, 8.6, ends, blocked, one)
    sweep_reference(11.3, 8.6, ends, blocked, other)
    assert one.any()
    assert np.array_equal(one, other)


def test_one_look_around_sees_the_whole_room_and_what_is_out_of_reach_does_not_count():
    coverage = Coverage(two_rooms())
    wanted, seen, _ = coverage.cells
    assert wanted.sum() * CELL_M**2 == pytest.approx(16.0, rel=0.1)
    assert coverage.share == 0.0
    assert not seen.any()
    coverage.update(of_nobody(square_scan(2.0, np.linspace(-np.pi, np.pi, 1441))), np.zeros(3))
    assert coverage.share > 0.97


def test_half_a_look_sees_half_of_the_room_and_people_hide_what_is_behind_them():
    bearings = np.linspace(-np.pi / 2, np.pi / 2, 721)
    coverage = Coverage(two_rooms())
    coverage.update(of_nobody(square_scan(2.0, bearings)), np.zeros(3))
    assert coverage.share == pytest.approx(0.5, abs=0.04)
    scan = square_scan(2.0, bearings)
    hidden = LaserScan(np.where(np.abs(bearings) < 0.3, np.nan, scan.ranges), bearings, 0.05, 30.0)
    behind = Coverage(two_rooms())
    behind.update(of_nobody(hidden), np.zeros(3))
    assert behind.share < coverage.share - 0.03


def test_what_is_too_far_away_is_not_seen():
    coverage = Coverage(two_rooms())
    far = LaserScan(np.full(5, 25.0), np.linspace(-0.01, 0.01, 5), 0.05, 30.0)
    coverage.update(of_nobody(far), np.array([-5.0, 0.0, 0.0]))
    _, seen, corner = coverage.cells
    assert (np.nonzero(seen)[1].max() + 1) * CELL_M + corner[0] == pytest.approx(-5.0 + FARTHEST_M, abs=2 * CELL_M)


def test_gymnasium_finds_nothing_to_complain_about_without_a_leader(recwarn):
    check_env(make().unwrapped, skip_render_check=True)
    assert not [str(w.message) for w in recwarn if "gymnasium" in str(w.filename)]


def test_the_bystanders_are_those_of_the_same_seed_behind_a_leader():
    led, alone = make(leader=True, people_count=4, standing=1), make(people_count=3, standing=1)
    led.reset(seed=5)
    alone.reset(seed=5)
    assert np.array_equal(led.unwrapped.truth.people.positions[1:], alone.unwrapped.truth.people.positions)
    assert alone.unwrapped.truth.leader_index == -1


def test_without_a_leader_there_is_none_to_see_and_the_terms_sum_to_the_reward():
    env = make(people_count=2)
    observation, _ = env.reset(seed=1)
    assert "leader" not in observation
    for _ in range(30):
        observation, reward, _, _, info = env.step([0.5, 0.0])
        assert sum(info["reward_terms"].values()) == pytest.approx(reward)
    assert "leader_distance" not in info
    assert 0.05 < info["coverage"] < 0.5


def test_the_episode_ends_when_the_goal_is_covered():
    episode = rollout(make(people_count=0, coverage_goal=0.2), Constant(0.5, 0.0), seed=0, steps=300)
    assert episode.ending == "covered"
    history = episode.history
    assert history.coverage[-1] >= 0.2 > history.coverage[-2]
    assert np.all(np.diff(history.coverage) >= 0.0)
    assert history.reward_terms["coverage"].sum() == pytest.approx(100.0 * (history.coverage[-1] - history.coverage[0]))
    assert len(history.bystanders) == 0
    assert np.isnan(episode.metrics["time_to_90_s"])


def test_a_contact_ends_the_episode_or_is_only_counted():
    ends = rollout(make(people_count=0), Constant(0.6, 0.3), seed=0, steps=150)
    goes_on = rollout(make(people_count=0, ends_on_contact=False), Constant(0.6, 0.3), seed=0, steps=150)
    assert ends.ending == "collision_static"
    assert goes_on.ending == ""
    assert len(goes_on.history) > len(ends.history)
    assert goes_on.metrics["contacts_static"] >= 1.0


def test_times_of_coverage_are_read_from_the_history():
    episode = rollout(make(people_count=0, coverage_goal=1.0), Constant(0.5, 0.0), seed=0, steps=20)
    fields = {**vars(episode.history), "coverage": np.linspace(0.5, 0.97, len(episode.history))}
    figures = exploration_metrics(type(episode.history)(**fields))
    assert figures["time_to_90_s"] == pytest.approx(1.8, abs=0.1)
    assert figures["time_to_95_s"] == pytest.approx(2.0, abs=0.1)
    assert np.isnan(figures["time_to_99_s"])


def test_behind_a_leader_coverage_is_measured_only_when_asked_for():
    silent, asked = make(leader=True), make(leader=True, coverage=True)
    assert "coverage" not in silent.reset(seed=0)[1]
    assert asked.reset(seed=0)[1]["coverage"] > 0.0


def test_the_robots_own_map_is_there_for_planners_and_nowhere_without_slam():
    assert make().unwrapped.interface.own_map is None
    env = make(slam="cartographer", people_count=0, beams=721)
    env.reset(seed=2)
    for _ in range(40):
        env.step([0.5, 0.0])
    own = env.unwrapped.interface.own_map()
    assert own.map.free.sum() * own.map.resolution**2 > 10.0
    truth = env.unwrapped.truth.robot_pose[:2] - env.unwrapped.world.start[:2]
    assert np.hypot(*own.pose[:2]) == pytest.approx(np.hypot(*truth), abs=0.1)


def test_a_snapshot_keeps_what_was_seen():
    env = make(people_count=0).unwrapped
    env.reset(seed=3)
    state = env.save_state()
    first = [env.step([0.5, 0.1])[4]["coverage"] for _ in range(10)]
    env.restore_state(state)
    assert first == [env.step([0.5, 0.1])[4]["coverage"] for _ in range(10)]


@pytest.mark.parametrize(("name", "value"), [("coverage_goal", 0.0), ("coverage_goal", 1.1), ("people_count", -1)])
def test_impossible_values_are_refused(name, value):
    with pytest.raises(InputError, match=name):
        make(**{name: value})
