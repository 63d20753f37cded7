"""The paper's own tracker."""

import numpy as np
import pytest
from tagalong.perception import PeopleFilter, PeopleFilterConfig, perception_preset, table_ii
from tagalong.perception.tracking.camera import SeenPeople
from tagalong.perception.tracking.ye2021 import Ye2021Tracker
from tagalong.perception.tracking.ye2021_config import Ye2021Config
from tagalong.slam import InputError, LaserScan


@pytest.fixture
def paper(make_stage):
    """A stage with the paper's tracker, at 10 Hz."""
    stage = make_stage()
    stage.tracker = Ye2021Tracker(Ye2021Config(), stage.detector)
    return stage


def test_two_legs_that_walk_are_one_person_where_they_are(paper):
    history, truth = paper.walk([3.0, -1.0], [0.0, 0.8], 4.0)
    assert [len(people) for people in history[:5]] == [0] * 5
    assert [len(people) for people in history[20:]] == [1] * 20
    assert history[-1].positions[0] == pytest.approx(truth[-1, 0], abs=0.3)
    assert history[-1].velocities[0, 1] == pytest.approx(0.8, abs=0.4)
    assert {int(people.ids[0]) for people in history[20:]} == {0}


def test_two_legs_that_stand_are_nobody(paper):
    for _ in range(40):
        assert len(paper.show([[2.0, 0.1], [2.0, -0.1]])) == 0


def test_legs_that_walk_among_things_are_nobody(paper):
    """Who starts where the local grid is not free is none (initiation, third condition)."""
    for k in range(40):
        legs = np.array([[2.0, -1.0 + 0.05 * k], [2.2, -1.0 + 0.05 * k]])
        assert len(paper.show(legs, things=np.stack((np.full(60, 2.1), np.linspace(-1.5, 1.5, 60)), 1))) == 0


def test_a_person_out_of_sight_ends_when_its_place_is_too_uncertain(paper):
    paper.walk([3.0, -1.0], [0.0, 0.8], 4.0)
    gone = [len(paper.show(())) for _ in range(30)]
    assert gone[0] == 1
    assert gone[-1] == 0


def test_the_preset_has_the_numbers_of_table_ii_and_removes_what_the_paper_removes():
    config = perception_preset("ye2021")
    assert config.method == "ye2021"
    distances = {"alpha": 0.13, "delta": 0.5, "zeta": 0.35}
    others = {"beta": 3, "gamma": 0.3, "epsilon": 0.9, "c_min": 0.1, "q": 0.05, "r": 0.1}
    assert table_ii(config) == distances | others
    assert config.removal.unconfirmed_radius == 0.0


def test_it_takes_no_camera_and_no_time_that_stands_still(paper):
    scan = LaserScan(np.ones(2), np.array([0.0, 0.1]), 0.1, 10.0, time_s=1.0)
    with pytest.raises(InputError, match="takes no camera"):
        paper.tracker.update(scan, np.zeros(3), SeenPeople(1.0, np.zeros((0, 2)), np.zeros(0)))
    paper.tracker.update(scan, np.zeros(3))
    with pytest.raises(InputError, match="scan times must increase"):
        paper.tracker.update(scan, np.zeros(3))
    PeopleFilter(PeopleFilterConfig(method="ye2021")).update(scan, np.zeros(3))
