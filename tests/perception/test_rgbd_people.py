"""People in RGB-D: candidates by heads, gradients' histograms, the shipped classifier."""

import dataclasses

import numpy as np
import pytest
from hog_rgbd_reference import hog_reference
from measures_rgbd_reference import count_borders_reference
from rgbd_cut_outs import CAMERA, candidates, person, standing
from tagalong.perception.rgbd.frame import RgbdFrame
from tagalong.perception.rgbd.heads import HeadConfig, find_candidates, with_neighbours
from tagalong.perception.rgbd.hog import hog, hog_length
from tagalong.perception.rgbd.measures import (
    BORDER_STEP,
    MEASURES,
    Border,
    candidate_measures,
    count_borders,
    soft_bins,
)
from tagalong.perception.rgbd.people_finder import PeopleFinder, PeopleFinderConfig, spread
from tagalong.perception.rgbd.person_classifier import LENGTH, MODEL, PersonClassifier, candidate_features, read_card
from tagalong.perception.rgbd.planes import PlaneFinder
from tagalong.perception.rgbd.windows import CHANNELS, COLUMNS, ROWS, candidate_windows
from tagalong.slam import InputError


def test_one_head_makes_one_candidate_where_it_stands():
    found = candidates(standing(*person(3.0, 0.4)))
    assert len(found) == 1
    assert found.heads[0, 2] == pytest.approx(1.75, abs=0.04)
    assert found.axes[0] == pytest.approx([3.0, 0.4], abs=0.05)
    assert np.count_nonzero(found.label == 0) > 500


def test_two_people_shoulder_to_shoulder_are_two_by_their_heads():
    found = candidates(standing(*person(3.0, 0.24), *person(3.0, -0.24, 1.65)))
    assert len(found) == 2
    assert sorted(found.axes[:, 1]) == pytest.approx([-0.24, 0.24], abs=0.06)
    assert 0.8 < np.count_nonzero(found.label == 0) / np.count_nonzero(found.label == 1) < 1.4


def test_a_person_at_a_desk_does_not_own_the_desk():
    desk = (2.9, -1.3, -0.2, 0.6, 0.75)
    found = candidates(standing(*person(3.0, 0.0), desk))
    assert len(found) == 1
    low = PlaneFinder().find(standing(*person(3.0, 0.0), desk)).points[found.label == 0]
    assert low[:, 1].min() > -0.55


def test_low_things_and_walls_are_no_candidates():
    assert len(candidates(standing((3.0, -0.3, 0.3, 0.1, 1.0)))) == 0
    assert len(candidates(standing())) == 0


def test_a_body_whose_head_is_above_the_picture_is_a_candidate():
    found = candidates(standing(*person(1.0, 0.0)))
    assert len(found) == 1
    assert found.pixels[0, 0] < 2
    assert candidate_windows(PlaneFinder().find(standing(*person(1.0, 0.0))), found).shape == (
        1,
        CHANNELS,
        ROWS,
        COLUMNS,
    )


def test_points_alone_in_space_are_left_out():
    points = np.full((5, 5, 3), 4.0)
    points[2, 2] = 3.0
    supported = np.empty((5, 5), dtype=bool)
    with_neighbours(points, 2, supported)
    assert not supported[2, 2]
    assert supported.sum() == 24


def test_windows_show_people_of_any_distance_in_the_same_size():
    near, far = (
        candidate_windows(PlaneFinder().find(f), candidates(f))[0]
        for f in (standing(*person(2.5, 0.0)), standing(*person(4.5, 0.0)))
    )
    assert np.abs(near[2] - far[2]).mean() < 0.06
    assert 0.15 < near[2].mean() < 0.6
    assert set(np.unique(near[1].round(2))) >= {0.0, 1.0}


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_middle_of_a_window_is_that_of_head_and_chest_whatever_is_carried_below(side):
    low, high = sorted((side * 0.2, side * 0.45))
    frame = standing(*person(3.0, 0.3), (3.0, 0.3 + low, 0.3 + high, 0.1, 0.7))
    found = candidates(frame)
    assert len(found) == 1
    own = candidate_windows(PlaneFinder().find(frame), found)[0, 2]
    columns = np.arange(COLUMNS) + 0.5
    upper, lower = ((part * columns).sum() / part.sum() for part in (own[: ROWS // 3], own[ROWS * 2 // 3 :]))
    assert upper == pytest.approx(COLUMNS / 2, abs=0.7)
    assert side * (COLUMNS / 2 - lower) > 1.0  # left of the robot is left in the picture


def measured(frame):
    """Shares of the borders at the sides and above, extents and flatness of the frame's only candidate."""
    planes = PlaneFinder().find(frame)
    (row,) = candidate_measures(planes, find_candidates(planes))
    return row[:5], row[5:10], row[10:16], row[16:]


def test_a_person_is_measured():
    sides, above, extents, (face, wall, largest) = measured(standing(*person(3.0, 0.0)))
    across, thick, top, bottom, distance, area = extents
    assert sides[Border.FREE] == pytest.approx(1.0)
    assert above[Border.FREE] == pytest.approx(1.0)
    assert across == pytest.approx(0.44 / np.sqrt(12.0), abs=0.02)
    assert thick < 0.01
    assert (top, bottom, distance) == pytest.approx((1.75, 0.1, 3.0), abs=0.04)
    assert area == pytest.approx(0.44 * 1.35 + 0.18 * 0.3, rel=0.1)
    assert face > 0.99  # a cut-out is flat
    assert 0.95 < largest <= face
    assert wall == 0.0


def test_what_is_seen_through_a_gap_has_nearer_things_at_its_sides():
    gap = (1.5, -1.0, -0.1, 0.0, 2.1), (1.5, 0.1, 1.0, 0.0, 2.1)
    frame = standing((3.0, -0.6, 0.6, 0.1, 1.75), *gap)
    planes = PlaneFinder().find(frame)
    found = find_candidates(planes)
    between = np.argmin(np.abs(found.axes - (3.0, 0.0)).sum(axis=1))
    row = candidate_measures(planes, found)[between]
    assert row[Border.HIDDEN] > 0.9
    assert row[5 + Border.FREE] > 0.9


def test_the_picture_cuts_people_and_things_touch_them_and_measure_nothing():
    sides, above, *_ = measured(standing(*person(1.0, 0.0)))
    assert above[Border.CUT] > 0.3
    assert sides[Border.CUT] == 0.0
    assert measured(standing(*person(2.5, 1.75)))[0][Border.CUT] > 0.4
    label, depth = np.full((4, 9), -1, dtype=np.int32), np.full((4, 9), 3.0)
    label[1:, 3:6], counts = 0, np.zeros((1, 2, len(Border)))
    depth[:, 6:] = np.nan
    count_borders(depth, label, BORDER_STEP, counts, 0, 0, 9)
    assert counts[0, 0].tolist() == [0.0, 0.0, 3.0, 0.0, 3.0]  # nothing measured as far as the picture goes: cut
    assert counts[0, 1].tolist() == [0.0, 0.0, 3.0, 0.0, 0.0]


def test_the_kernel_of_borders_does_what_its_reference_does():
    rng = np.random.default_rng(0)
    for _ in range(5):
        label = np.repeat(np.repeat(rng.integers(-1, 3, (8, 10)), 5, axis=0), 7, axis=1).astype(np.int32)
        depth = 3.0 + rng.integers(-1, 2, label.shape) * 0.2
        depth[(label < 0) & (rng.random(depth.shape) < 0.8)] = np.nan  # what is somebody's was measured
        ours, reference = np.zeros((3, 2, len(Border))), np.zeros((3, 2, len(Border)))
        inside = (int(rng.integers(0, 6)), int(rng.integers(0, 8)), label.shape[1] - int(rng.integers(0, 8)))
        count_borders(depth, label, BORDER_STEP, ours, *inside)
        count_borders_reference(depth, label, BORDER_STEP, reference, inside)
        assert ours.tolist() == reference.tolist()
        assert (ours.sum(axis=(0, 1)) > 0).all()


def test_soft_bins_share_a_value_out_between_its_neighbours():
    values = np.full((2, MEASURES), 0.25)
    values[1] = 99.0
    bins = soft_bins(values).reshape(2, MEASURES, -1)
    assert bins.sum(axis=2) == pytest.approx(1.0)
    assert bins[0, 0].tolist() == pytest.approx([0.0, 0.0, 0.5, 0.5, 0.0, 0.0])  # halfway from 0.15 to 0.35
    assert (bins[1, :, -1] == 1.0).all()


def test_what_is_beside_and_behind_a_candidate_is_as_bright_as_it_is():
    frame = standing(*person(3.0, 0.0))
    window = candidate_windows(PlaneFinder().find(frame), candidates(frame))[0]
    inside, outside = window[0][window[2] > 0.99], window[0][window[2] < 0.01]
    assert inside.min() < 0.1 < inside.max()  # head and body
    assert outside == pytest.approx(np.average(window[0], weights=window[2]), abs=0.02)


def test_an_empty_room_has_no_features():
    planes = PlaneFinder().find(standing())
    assert candidate_features(planes, find_candidates(planes)).shape == (0, LENGTH)


def patches(count=3, channels=2):
    return np.random.default_rng(0).random((count, channels, ROWS, COLUMNS)).astype(np.float32)


@pytest.mark.parametrize("softness", [1e-5, 0.02])
def test_the_kernel_of_gradients_does_what_its_reference_does(softness):
    pictures = patches()
    ours, reference = (np.empty((3, hog_length(ROWS, COLUMNS, 2)), dtype=np.float32) for _ in range(2))
    hog(pictures, softness, ours)
    hog_reference(pictures, softness, reference)
    assert ours == pytest.approx(reference, abs=2e-5)


def test_histograms_of_gradients_are_those_of_scikit_image():
    feature = pytest.importorskip("skimage.feature", reason="scikit-image is in the extra dev")
    pictures = patches(2, 1)
    ours = np.empty((2, hog_length(ROWS, COLUMNS, 1)), dtype=np.float32)
    hog(pictures, 1e-5, ours)
    for picture, mine in zip(pictures[:, 0], ours, strict=True):
        theirs = feature.hog(picture.astype(np.float64), 9, (8, 8), (2, 2), block_norm="L2-Hys")
        assert mine == pytest.approx(theirs, abs=2e-3)
        assert np.corrcoef(mine, theirs)[0, 1] > 0.9999


def test_the_shipped_classifier_has_a_card_and_is_calibrated():
    classifier, card = PersonClassifier.load(), read_card()
    assert classifier.hidden.shape == (LENGTH + 1, card["config"]["units"])
    assert card["test"]["expected_calibration_error"] <= 0.05
    assert card["training"]["wardrobe"] != card["test"]["wardrobe"]
    assert not set(card["training"]["scenes"]) & set(card["test"]["scenes"])


def test_damaged_classifiers_are_errors(tmp_path):
    with pytest.raises(InputError, match="no classifier of people at"):
        PersonClassifier.load(tmp_path / "none.npz")
    (tmp_path / "bad.npz").write_bytes(b"nothing")
    with pytest.raises(InputError, match="tagalong train people"):
        PersonClassifier.load(tmp_path / "bad.npz")
    damaged = bytearray(MODEL.read_bytes())
    damaged[200] ^= 0xFF
    (tmp_path / "bad.npz").write_bytes(damaged)
    with pytest.raises(InputError, match="tagalong train people"):
        PersonClassifier.load(tmp_path / "bad.npz")
    np.savez(tmp_path / "short.npz", hidden=np.ones(5, np.float32), output=np.ones(3, np.float32))
    with pytest.raises(InputError, match="`hidden` layer"):
        PersonClassifier.load(tmp_path / "short.npz")


def test_the_likelihood_is_that_of_a_network_of_one_hidden_layer():
    hidden = np.zeros((LENGTH + 1, 2), dtype=np.float32)
    hidden[0], hidden[-1] = (2.0, -3.0), (1.0, 0.5)
    classifier = PersonClassifier(hidden, np.array([0.5, 4.0, -1.0], dtype=np.float32))
    features = np.zeros((3, LENGTH), dtype=np.float32)
    features[:, 0] = 0.0, 1.0, -1.0
    units = [(1.0, 0.5), (3.0, 0.0), (0.0, 3.5)]
    odds = np.array([0.5 * a + 4.0 * b - 1.0 for a, b in units])
    assert classifier.score(features) == pytest.approx(odds)
    assert classifier.likelihood(features) == pytest.approx(1.0 / (1.0 + np.exp(-odds)))
    assert classifier.likelihood(1e6 * features).tolist() == [pytest.approx(1 / (1 + np.exp(-1.5))), 1.0, 1.0]


def test_a_saved_classifier_says_the_same(tmp_path):
    classifier = PersonClassifier.load()
    classifier.save(tmp_path / "people.npz", {"model": "copy"})
    features = np.random.default_rng(0).random((4, LENGTH)).astype(np.float32)
    again = PersonClassifier.load(tmp_path / "people.npz").likelihood(features)
    assert np.array_equal(again, classifier.likelihood(features))
    assert MODEL.with_suffix(".json").exists()


class Certain(PersonClassifier):
    """Takes everything for a person."""

    sure = 0.9

    def likelihood(self, features):
        return np.full(len(features), self.sure)


def test_pixels_and_places_of_people_are_given_in_the_robot_frame():
    classifier = PersonClassifier.load()
    finder = PeopleFinder(Certain(classifier.hidden, classifier.output))
    plain = standing(*person(3.0, 0.4))
    frame = RgbdFrame(plain.depth, plain.colour, CAMERA, 0.0, T_robot_camera=(0.1, 0.0, np.pi / 2.0))
    people = finder.find(frame, PlaneFinder().find(frame))
    assert len(people) == 1
    assert people.positions[0] == pytest.approx([0.1 - 0.4, 3.05], abs=0.1)
    assert people.label.shape == (106, 128)
    assert (people.label[frame.colour[..., 0] < 100] == 0).mean() > 0.95
    assert (people.label[frame.colour[..., 0] > 100] == 0).mean() < 0.01


def test_nobody_is_in_an_empty_room_and_unlikely_people_are_left_out():
    frame = standing()
    assert len(PeopleFinder.load().find(frame, PlaneFinder().find(frame))) == 0
    classifier = PersonClassifier.load()
    choosy = PeopleFinder(
        Certain(classifier.hidden, classifier.output),
        PeopleFinderConfig(least_likelihood=0.95),
    )
    frame = standing(*person(3.0, 0.0))
    people = choosy.find(frame, PlaneFinder().find(frame))
    assert len(people) == 0
    assert (people.label == -1).all()


def test_ragged_pixels_beside_a_person_become_its_own():
    points = np.zeros((3, 5, 3))
    points[..., 0], points[..., 1] = 3.0, np.arange(5) * 0.05
    points[:, 3] += (0.1, 0.0, 0.0)
    points[:, 4] += (2.0, 0.0, 0.0)
    label = np.full((3, 5), -1, dtype=np.int32)
    label[:, :3] = 7
    grown = spread(points, label, np.ones((3, 5), dtype=bool), 0.15)
    assert (grown[:, 3] == 7).all()
    assert (grown[:, 4] == -1).all()


def test_impossible_configurations_are_errors():
    with pytest.raises(InputError, match="least_likelihood"):
        PeopleFinderConfig(least_likelihood=1.5)
    with pytest.raises(InputError, match="least_of_legs"):
        PeopleFinderConfig(least_of_legs=-0.1)
    with pytest.raises(InputError, match="apart"):
        PeopleFinderConfig(apart=-1.0)
    with pytest.raises(InputError, match="lowest"):
        HeadConfig(lowest=0.0)


def from_above(pitch, height=1.4):
    """A frame of one upright cut-out 2.5 m away by a camera whose nose is down, and of the same by a level one."""
    c, s = np.cos(pitch), np.sin(pitch)
    rays = CAMERA.rays @ np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]).T
    with np.errstate(divide="ignore"):
        depth = np.minimum(6.0 / rays[..., 0], np.where(rays[..., 2] < 0.0, -height / rays[..., 2], np.inf))
    colour = np.full((*depth.shape, 3), 150, dtype=np.uint8)
    for number, (away, right, left, bottom, top) in enumerate(person(2.5, 0.2)):
        at = away / rays[..., 0]
        y, z = rays[..., 1] * at, rays[..., 2] * at + height
        inside = (y > right) & (y < left) & (z > bottom) & (z < top) & (depth > at)
        depth[inside], colour[inside] = at[inside], 40 * number
    return RgbdFrame(depth.astype(np.float32), colour, CAMERA, 0.0, camera_height=None)


def test_a_person_stands_upright_in_the_window_however_the_camera_is_tilted():
    pictures = []
    for pitch in (0.0, np.radians(15.0)):
        planes = PlaneFinder().find(from_above(pitch))
        assert planes.mount.height == pytest.approx(1.4, abs=0.02)
        (window,) = candidate_windows(planes, find_candidates(planes))
        pictures.append(window)
    assert np.abs(pictures[0][2] - pictures[1][2]).mean() < 0.05


def test_people_beyond_what_the_noise_allows_are_not_told():
    frame, classifier = standing(*person(3.0, 0.0)), PersonClassifier.load()
    finder = PeopleFinder(Certain(classifier.hidden, classifier.output))
    planes = PlaneFinder().find(frame)
    assert len(finder.find(frame, planes)) == 1
    assert len(finder.find(frame, dataclasses.replace(planes, reach=2.5))) == 0


def test_a_noisy_frame_reaches_less_far():
    frame, rng = standing(), np.random.default_rng(0)
    reaches = []
    for quadratic in (0.0005, 0.002, 0.006):
        noise = (quadratic * frame.depth**2 * rng.standard_normal(frame.depth.shape)).astype(np.float32)
        reaches.append(PlaneFinder().find(dataclasses.replace(frame, depth=frame.depth + noise)).reach)
    assert reaches[0] > reaches[1] > reaches[2]
    assert reaches[1] == pytest.approx(np.sqrt(0.058 / 0.002), rel=0.3)


def test_people_are_marked_as_guesses_where_the_floor_is_not_known_or_left_out():
    frame = standing(*person(2.0, 0.0))
    blind = dataclasses.replace(frame, depth=np.where(CAMERA.rays[..., 2] < -0.15, np.nan, frame.depth))
    planes, classifier = PlaneFinder().find(blind), PersonClassifier.load()
    certain = Certain(classifier.hidden, classifier.output)
    assert not planes.mount.known
    people = PeopleFinder(certain).find(blind, planes)
    assert len(people) >= 1
    assert not people.floor_known
    assert len(PeopleFinder(certain, PeopleFinderConfig(without_floor=False)).find(blind, planes)) == 0
    assert PeopleFinder(certain).find(frame, PlaneFinder().find(frame)).floor_known


def test_a_frame_without_colour_is_judged_by_the_classifier_of_depth_alone():
    hidden = np.zeros((LENGTH + 1, 1), np.float32)
    by_colour, by_depth = (PersonClassifier(hidden, np.array([0.0, odds], np.float32)) for odds in (1.0, 2.0))
    finder = PeopleFinder(by_colour, depth_classifier=by_depth)
    frame, said = standing(*person(3.0, 0.0)), []
    for low, high in ((128, 128), (0, 0), (90, 200)):
        colour = np.full_like(frame.colour, low)
        colour[0, 0] = high
        other = dataclasses.replace(frame, colour=colour)
        said.append(float(finder.find(other, PlaneFinder().find(other)).likelihood[0]))
    depth, both = 1.0 / (1.0 + np.exp(-2.0)), 1.0 / (1.0 + np.exp(-1.0))
    assert said == pytest.approx([depth, depth, both])
