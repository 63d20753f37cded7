"""Who falls behind drives faster, by as much as the pursuit law says."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.agents.learned.keep_up import KeepUp, KeepUpConfig
from tagalong.agents.learned.pilot import Pilot, PilotConfig
from tagalong.agents.learned.situation import Situation
from tagalong.agents.learned.steering import REST
from tagalong.agents.scripted.leader_memory import Goal, Mode
from tagalong.envs.task import FollowInterface
from tagalong.slam import InputError

CONFIG = KeepUpConfig(distance=1.35, gain=1.2, pace=1.0, ahead=0.8)
NO_TRAIL = np.zeros((0, 2))


def keep_pace(wish, goal, trail=NO_TRAIL):
    trail, nothing = np.asarray(trail, dtype=np.float64), np.zeros((0, 2))
    return KeepUp(CONFIG).keep_pace(wish, Situation(REST, goal, 0.0, trail, nothing, np.zeros((0, 6)), lambda: 0.0))


def test_the_leaders_pace_and_the_way_that_is_too_much_give_the_least_speed():
    goal = Goal(Mode.FOLLOW, 1.85, 0.0, 0.4, 0.0)
    assert keep_pace((0.1, 0.2), goal) == pytest.approx((0.4 + 1.2 * 0.5, 0.2))
    assert keep_pace((1.3, 0.2), goal) == (1.3, 0.2)  # who is fast enough is left alone
    near = Goal(Mode.FOLLOW, 0.8, 0.0, 0.0, 0.0)
    assert keep_pace((-0.2, 0.0), near) == (-0.2, 0.0)  # and who is near may back away


def test_the_way_is_that_along_the_trail_and_counts_less_the_farther_it_leads_aside():
    goal = Goal(Mode.FOLLOW, 1.0, 1.0, 0.0, 0.0)
    round_the_corner = keep_pace((0.0, 0.0), goal, [[1.0, 0.0]])  # 2 m of way, the next 0.8 m straight ahead
    assert round_the_corner[0] == pytest.approx(1.2 * 0.65)
    straight = keep_pace((0.0, 0.0), goal)  # 1.41 m, at 45 degrees
    assert straight[0] == pytest.approx(1.2 * (np.sqrt(2.0) - 1.35) * 0.5)
    assert keep_pace((0.0, 1.6), Goal(Mode.FOLLOW, 0.0, 3.0, 0.0, 1.0))[0] == pytest.approx(0.0)


@pytest.mark.parametrize("mode", [Mode.WAIT, Mode.APPROACH, Mode.SEARCH])
def test_nobody_is_urged_after_a_leader_out_of_sight(mode):
    assert keep_pace((0.1, 0.1), Goal(mode, 3.0, 3.0, 1.0, 0.0)) == (0.1, 0.1)


def drive(pilot, leader, steps):
    """Drive by a network that never wishes to move; the leader stays at `leader` in the robot frame."""
    told = {
        "scan": np.ones(271, dtype=np.float32),
        "leader": np.array([*leader, 0.9, 1.0], dtype=np.float32),
        "people": np.zeros((6, 6), dtype=np.float32),
        "velocity": np.zeros(2, dtype=np.float32),
    }
    for _ in range(steps):
        pilot.inputs(told)
        pilot.drive(pilot.config.steering.output(0.0, 0.0))
    return pilot.commanded[0]


def pilot(**fields):
    interface = FollowInterface(bearings=np.deg2rad(np.linspace(-135.0, 135.0, 271)))
    return Pilot(replace(PilotConfig(), **fields), interface)


def test_the_pilot_urges_the_network_only_with_a_guard():
    away = (2.5, 0.0, 0.9, 0.0)
    assert drive(pilot(), away, 10) > 0.5
    assert drive(pilot(keep_up=None, detour=None), away, 10) == pytest.approx(0.0, abs=1e-9)
    assert drive(pilot(guard=None), away, 10) == pytest.approx(0.0, abs=1e-9)


def test_the_pilot_urges_within_what_can_be_driven_so_it_stops_as_soon_as_the_leader_does():
    one = pilot()
    assert drive(one, (8.0, 0.0, 1.2, 0.0), 25) == pytest.approx(one.config.steering.max_speed, abs=0.01)
    assert drive(one, (1.0, 0.0, 0.0, 0.0), 2) < one.config.steering.max_speed - 0.02


def test_a_distance_that_is_none_is_refused():
    with pytest.raises(InputError, match="distance"):
        KeepUpConfig(distance=0.0)
