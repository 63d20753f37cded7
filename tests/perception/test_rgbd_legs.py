"""Legs alone in RGB-D frames, and where a picture ends: what the upper edge cuts."""

import dataclasses

import numpy as np
import pytest
from rgbd_cut_outs import candidates, person, standing
from tagalong.perception.rgbd.frame import Pinhole, RgbdFrame
from tagalong.perception.rgbd.heads import HeadConfig, find_candidates, join_cut
from tagalong.perception.rgbd.margins import margins
from tagalong.perception.rgbd.measures import Border, candidate_measures
from tagalong.perception.rgbd.people_finder import PeopleFinder
from tagalong.perception.rgbd.person_classifier import PersonClassifier, candidate_features
from tagalong.perception.rgbd.planes import PlaneFinder
from tagalong.perception.rgbd.windows import ROWS, candidate_windows


def legs(away, y, apart=0.1, top=1.75):
    """Two shins of a cut-out, and what is above them."""
    return (
        (away, y - apart - 0.06, y - apart + 0.06, 0.03, 0.8),
        (away, y + apart - 0.06, y + apart + 0.06, 0.03, 0.8),
        (away, y - 0.22, y + 0.22, 0.8, top),
    )


def blanked(frame, rows):
    """The frame with nothing measured in its uppermost `rows`."""
    depth = frame.depth.copy()
    depth[:rows] = np.nan
    return dataclasses.replace(frame, depth=depth)


def looking_down(frame, rows):
    """The lower part of a level camera's picture, `rows` of it: what one shows that is turned down."""
    (across, down), (column, row) = frame.camera.focal, frame.camera.axis
    cut = frame.camera.height - rows
    camera = Pinhole.from_intrinsics((frame.camera.width, rows), (across, down), (column - 0.5, row - cut - 0.5))
    return RgbdFrame(frame.depth[cut:].copy(), frame.colour[cut:].copy(), camera, 0.0)


def test_two_legs_that_the_picture_cuts_are_one_candidate():
    found = candidates(looking_down(standing(*legs(1.6, 0.2)), 35))
    assert len(found) == 1
    assert found.legs.tolist() == [True]
    assert found.heads[0, 2] < 0.8
    assert found.axes[0] == pytest.approx([1.6, 0.2], abs=0.12)


def test_noise_where_the_picture_cuts_hides_nobody():
    """The uppermost pixels of a leg may come out lower than those below them."""
    frame = looking_down(standing(*legs(1.6, 0.0)), 35)
    depth, figure = frame.depth.copy(), frame.depth < 2.0
    depth[0][figure[0]], depth[1][figure[1]] = np.nan, 1.67
    found = candidates(dataclasses.replace(frame, depth=depth))
    assert len(found) == 1
    assert found.pixels[0, 0] == 1


def test_the_legs_of_two_people_are_two_candidates():
    found = candidates(looking_down(standing(*legs(1.6, 0.35), *legs(1.6, -0.35)), 35))
    assert sorted(found.axes[:, 1]) == pytest.approx([-0.35, 0.35], abs=0.12)


def test_legs_alone_are_shown_twice_as_large():
    frame = looking_down(standing(*legs(1.6, 0.0)), 35)
    planes = PlaneFinder().find(frame)
    found = find_candidates(planes)
    own = candidate_windows(planes, found)[0, 2]
    whole = candidate_windows(planes, dataclasses.replace(found, cut=np.array([False])))[0, 2]
    assert own[-8].sum() == pytest.approx(2 * 0.12 / ((0.86 + 0.2) / ROWS), rel=0.3)
    assert candidate_measures(planes, found)[0, 12] == pytest.approx(2.0 * found.heads[0, 2])
    assert not np.array_equal(own, whole)


def test_low_things_that_the_picture_shows_whole_are_no_legs():
    assert len(candidates(looking_down(standing((1.6, -0.1, 0.1, 0.03, 0.4)), 35))) == 0


def test_the_picture_ends_where_nothing_is_measured_any_more():
    """Depth that is registered to colour leaves the uppermost rows blank."""
    frame = standing(*person(1.0, 0.0))
    planes = PlaneFinder().find(blanked(frame, 8))
    assert candidates(frame).cut.tolist() == candidates(blanked(frame, 8)).cut.tolist() == [True]
    assert candidate_measures(planes, find_candidates(planes))[0, 5 + Border.CUT] > 0.3
    assert margins(blanked(frame, 8).depth) == (8, 0, 128)
    assert margins(blanked(frame, 60).depth).top == 13  # an eighth: what measures nothing below is no margin


class Sure(PersonClassifier):
    """Takes everything for a person."""

    sure = 0.9

    def likelihood(self, features):
        return np.full(len(features), self.sure)


class NearlySure(Sure):
    """Is a little less sure."""

    sure = 0.85


def test_legs_alone_are_told_by_a_classifier_that_is_sure():
    classifier, frame = PersonClassifier.load(), looking_down(standing(*legs(1.6, 0.0)), 35)
    planes = PlaneFinder().find(frame)
    told = [
        len(PeopleFinder(kind(classifier.hidden, classifier.output)).find(frame, planes)) for kind in (NearlySure, Sure)
    ]
    assert told == [0, 1]
    body = standing(*person(3.0, 0.0))
    finder = PeopleFinder(NearlySure(classifier.hidden, classifier.output))
    assert len(finder.find(body, PlaneFinder().find(body))) == 1


def test_the_classifier_is_told_what_can_only_be_legs():
    for frame, alone in ((looking_down(standing(*legs(1.6, 0.0)), 35), 1.0), (standing(*person(3.0, 0.0)), 0.0)):
        planes = PlaneFinder().find(frame)
        assert candidate_features(planes, find_candidates(planes))[:, -1].tolist() == [alone]


@pytest.mark.parametrize(("between", "clusters"), [(0.25, 1), (0.6, 2)])
def test_two_legs_at_the_edge_are_one_person_and_two_people_beside_each_other_are_two(between, clusters):
    points, label = np.zeros((4, 9, 3)), np.full((4, 9), -1, dtype=np.int64)
    label[:, 1], label[:, 7] = 0, 1
    points[:, 7, 0] = between
    join_cut(points, label, 2, 2, HeadConfig().apart)
    assert len(set(label[label >= 0].tolist())) == clusters
