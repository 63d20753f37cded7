from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between, inverse, transform_points
from tagalong.slam.quality.adnn import adnn, nearest_distances
from tagalong.slam.quality.icp import Cloud, SurfaceIcpConfig, icp_points, icp_surface
from tagalong.slam.quality.placements import placements
from tagalong.slam.quality.registration import RegistrationConfig, register
from tagalong.slam.quality.rigid import fit_rigid
from tagalong.slam.search.score_pyramid import build_pyramid


def outline(*corners, step=0.05):
    """Points every `step` metres along a closed polygon."""
    ends = np.array([*corners, corners[0]], dtype=float)
    parts = []
    for a, b in pairwise(ends):
        n = max(int(np.linalg.norm(b - a) / step), 1)
        parts.append(a + np.arange(n)[:, None] / n * (b - a))
    return np.vstack(parts)


RECTANGLE = outline((0, 0), (8, 0), (8, 3), (0, 3))
L_SHAPE = outline((0, 0), (10, 0), (10, 2), (2, 2), (2, 5), (0, 5))
# a door niche in one wall and a pillar tell the four turns of this almost square room apart
SQUARE_ROOM = np.vstack(
    (
        outline((0, 0), (5, 0), (5, 2), (5.4, 2), (5.4, 3), (5, 3), (5, 5.05), (0, 5.05)),
        outline((1, 3.5), (1.4, 3.5), (1.4, 3.9), (1, 3.9)),
    )
)


def near(found, expected, metres, degrees):
    """Whether a pose is no farther than this from another."""
    error = between(expected, found)
    return np.hypot(error[0], error[1]) < metres and np.rad2deg(abs(error[2])) < degrees


@pytest.mark.parametrize("turn_deg", [0, 17, 45, 90, 133, 180, -90, -20])
def test_a_shifted_and_turned_l_shape_comes_back(turn_deg):
    T_est_ref = np.array((3.0, -7.0, np.deg2rad(turn_deg)))
    fit = register(transform_points(T_est_ref, L_SHAPE), L_SHAPE)
    assert near(fit.T_ref_est, inverse(T_est_ref), 1e-3, 0.02)
    assert fit.converged
    assert fit.residual_m < 1e-3


@pytest.mark.parametrize("turn_deg", [0, 10, 37, 45, 80, 90, 135, 180, 225, -90, -50])
def test_a_near_square_room_is_not_laid_on_its_side(turn_deg):
    T_est_ref = np.array((-1.0, 2.0, np.deg2rad(turn_deg)))
    fit = register(transform_points(T_est_ref, SQUARE_ROOM), SQUARE_ROOM)
    assert near(fit.T_ref_est, inverse(T_est_ref), 1e-3, 0.02)


@pytest.mark.parametrize("turn_deg", [20, 33, -70, 158])
@pytest.mark.parametrize("shape", [RECTANGLE, L_SHAPE, SQUARE_ROOM])
def test_axes_laid_on_each_other_leave_nothing_to_refine(shape, turn_deg):
    estimate = transform_points((3.0, -7.0, np.deg2rad(turn_deg)), shape)
    fit = register(estimate, shape, RegistrationConfig(coarse_points=len(shape), coarse_iterations=1))
    assert fit.coarse_residual_m < 1e-9


def test_both_signs_of_the_axes_are_tried():
    lopsided = np.vstack((RECTANGLE, outline((6, 1), (7, 1), (7, 1.5), (6, 1.5))))
    T_est_ref = np.array((0.0, 0.0, np.pi))
    fit = register(transform_points(T_est_ref, lopsided), lopsided)
    assert near(fit.T_ref_est, inverse(T_est_ref), 1e-3, 0.02)


def test_a_mirrored_map_is_turned_but_never_mirrored():
    mirrored = L_SHAPE * (1.0, -1.0)
    fit = register(mirrored, L_SHAPE)
    assert fit.residual_m > 0.1


def test_missing_walls_and_ghosts_hardly_pull():
    rng = np.random.default_rng(1)
    cut = L_SHAPE[(L_SHAPE[:, 0] < 9.0) | (L_SHAPE[:, 1] > 0.5)]
    ghosts = rng.uniform((1, 0.4), (9, 1.6), (60, 2))
    T_est_ref = np.array((0.4, -0.2, 0.1))
    estimate = transform_points(T_est_ref, np.vstack((cut, ghosts)) + rng.normal(0, 0.01, (len(cut) + 60, 2)))
    fit = register(estimate, L_SHAPE)
    assert near(fit.T_ref_est, inverse(T_est_ref), 0.01, 0.1)


@settings(deadline=None, max_examples=20)
@given(st.floats(-5, 5), st.floats(-5, 5), st.floats(-3.1, 3.1))
def test_the_residual_does_not_depend_on_where_the_estimate_lies(x, y, theta):
    noisy = L_SHAPE + np.random.default_rng(0).normal(0, 0.02, L_SHAPE.shape)
    at_home = register(noisy, L_SHAPE).residual_m
    assert register(transform_points((x, y, theta), noisy), L_SHAPE).residual_m == pytest.approx(at_home, abs=5e-4)


def on_lattice(points, cell, offset):
    """The centres of the cells in which noisy points of walls lie, of a lattice moved by `offset`."""
    rng = np.random.default_rng(7)
    noisy = np.repeat(points, 6, axis=0) + rng.normal(0, 0.01, (6 * len(points), 2))
    return np.unique(np.floor((noisy - offset) / cell), axis=0) * cell + cell / 2 + offset


@pytest.mark.parametrize("shift", [(0.013, 0.007), (0.31, -0.11), (0.057, 0.05)])
def test_parallel_lattices_do_not_hold_the_maps_a_cell_apart(shift):
    walls = outline((0, 0), (10, 0), (10, 2), (2, 2), (2, 5), (0, 5), step=0.01)
    reference, estimate = on_lattice(walls, 0.02, (0.0, 0.0)), on_lattice(walls + shift, 0.02, (0.003, 0.004))
    fit = register(estimate, reference)
    assert near(fit.T_ref_est, (-shift[0], -shift[1], 0.0), 1.5e-3, 0.01)
    # point to point stops where the lattices fit, half a cell and more away
    snapped = icp_points(Cloud(reference), estimate, np.zeros(3), 200, 0.04)
    assert np.hypot(*(snapped[:2] + shift)) > 3e-3


def test_a_straight_wall_is_not_moved_along_itself():
    wall = np.column_stack((np.arange(0, 5, 0.05), np.zeros(100)))
    fit = icp_surface(Cloud(wall + np.array((0.0, 0.03))), Cloud(wall), np.zeros(3), SurfaceIcpConfig())
    np.testing.assert_allclose(fit.T_whole_part, (0.0, -0.03, 0.0), atol=1e-9)


def test_maps_far_from_the_origin_register_as_well():
    away = np.array((4000.0, -9000.0))
    estimate = transform_points((0.3, 0.2, 0.01), L_SHAPE) + away
    fit = register(estimate, L_SHAPE + away)
    assert np.abs(transform_points(fit.T_ref_est, estimate) - L_SHAPE - away).max() < 1e-3


def test_too_few_points_and_bad_configs_are_named():
    with pytest.raises(InputError, match="3 occupied cells in the estimate"):
        register(np.zeros((2, 2)), L_SHAPE)
    with pytest.raises(InputError, match="3 occupied cells in the reference"):
        register(L_SHAPE, np.zeros((0, 2)))
    with pytest.raises(InputError, match="outlier_m"):
        RegistrationConfig(fine=SurfaceIcpConfig(outlier_m=0.0))
    with pytest.raises(InputError, match="coarse_points"):
        RegistrationConfig(coarse_points=0)


@settings(deadline=None, max_examples=50)
@given(st.integers(2, 30), st.integers(0, 1000))
def test_the_rigid_fit_recovers_any_motion(n, seed):
    rng = np.random.default_rng(seed)
    points, T = rng.uniform(-9, 9, (n, 2)), np.array((*rng.uniform(-9, 9, 2), rng.uniform(-np.pi, np.pi)))
    assert near(fit_rigid(points, transform_points(T, points)), T, 1e-9, 1e-7)


def test_the_rigid_fit_needs_pairs():
    with pytest.raises(InputError, match="pairs"):
        fit_rigid(np.zeros((3, 2)), np.zeros((2, 2)))


def test_adnn_is_the_mean_over_the_reference_of_the_nearest_estimate():
    reference = np.array([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0)])
    estimate = np.array([(0.0, 0.3), (1.0, 0.0), (2.0, 0.4)])
    result = adnn(estimate, reference)
    # distances 0.3, 0, 0.4 and hypot(1, 0.4) = 1.0770...
    assert result.mean_m == pytest.approx((0.3 + 0.0 + 0.4 + np.hypot(1, 0.4)) / 4)
    assert result.max_m == pytest.approx(np.hypot(1, 0.4))
    assert result.min_m == 0.0
    assert result.cells == 4


def test_ghosts_show_in_the_reverse_direction_only():
    ghosts = np.vstack((L_SHAPE, np.full((10, 2), 1.0)))
    assert adnn(ghosts, L_SHAPE).mean_m == 0.0
    assert adnn(L_SHAPE, ghosts).mean_m == pytest.approx(10 * 1.0 / len(ghosts))


def test_nearest_distances_agree_with_brute_force():
    rng = np.random.default_rng(3)
    a, b = rng.normal(size=(40, 2)), rng.normal(size=(70, 2))
    brute = np.linalg.norm(a[:, None] - b[None], axis=-1).min(axis=1)
    np.testing.assert_allclose(nearest_distances(a, b), brute, atol=1e-12)


def test_adnn_of_an_empty_map_is_an_error_that_says_so():
    with pytest.raises(InputError, match="got 0 and 3"):
        adnn(np.ones((3, 2)), np.zeros((0, 2)))


def building(seed=3):
    """Points of an office floor: rooms of different widths on both sides of a corridor, each with a door and a post."""
    rng = np.random.default_rng(seed)
    walls = [outline((0, 0), (24, 0), (24, 12), (0, 12))]
    for low, high, door in ((0.0, 5.0, 5.0), (7.0, 12.0, 7.0)):
        x = 0.0
        while x < 22.0:
            right = min(x + rng.uniform(2.5, 5.0), 24.0)
            middle = (x + right) / 2 + rng.uniform(-0.5, 0.5)
            along = np.arange(x, right, 0.05)
            along = along[np.abs(along - middle) > 0.5]
            walls.append(np.column_stack((along, np.full(len(along), door))))
            walls.append(np.column_stack((np.full(100, right), np.linspace(low, high, 100))))
            post = rng.uniform((x + 0.5, low + 1), (right - 0.5, high - 1))
            walls.append(post + outline((0, 0), (0.4, 0), (0.4, 0.3), (0, 0.3)))
            x = right
    return np.vstack(walls)


@pytest.mark.parametrize("turn_deg", [0, 40, -100, 180])
@pytest.mark.parametrize("low_x", [0.0, 8.0, 15.0])
@pytest.mark.parametrize("swapped", [False, True])
def test_a_part_of_a_building_is_found_in_the_whole_of_it_whatever_its_frame(turn_deg, low_x, swapped):
    whole = building()
    part = whole[(whole[:, 0] >= low_x) & (whole[:, 0] <= low_x + 9.0)]
    T_est_ref = np.array((3.0, -4.0, np.deg2rad(turn_deg)))
    estimate, reference = (whole, part) if swapped else (part, whole)
    fit = register(transform_points(T_est_ref, estimate), reference)
    assert near(fit.T_ref_est, inverse(T_est_ref), 5e-3, 0.03)


def test_a_part_stays_the_part_though_stray_beams_reach_farther_than_the_building():
    rng = np.random.default_rng(5)
    whole = building()
    part = whole[whole[:, 0] < 9.0]
    strays = part.mean(axis=0) + rng.uniform(-80.0, 80.0, (40, 2))
    T_est_ref = np.array((3.0, -4.0, 2.0))
    fit = register(transform_points(T_est_ref, np.vstack((part, strays))), whole)
    assert near(fit.T_ref_est, inverse(T_est_ref), 0.01, 0.05)


def test_a_part_of_one_of_many_buildings_is_found_in_a_campus():
    rng = np.random.default_rng(1)
    places = [np.array((70.0 * (k % 4), 70.0 * (k // 4), rng.uniform(-np.pi, np.pi))) for k in range(12)]
    campus = np.vstack([transform_points(place, building(k)) for k, place in enumerate(places)])
    for k in range(12):
        part = building(k)[building(k)[:, 0] < 11.0]
        assert near(register(part, campus).T_ref_est, places[k], 0.02, 0.1)


def test_what_has_not_been_mapped_does_not_pull_at_all():
    whole = building()
    part = whole[whole[:, 0] < 7.0] + np.random.default_rng(2).normal(0, 0.01, (int((whole[:, 0] < 7.0).sum()), 2))
    fit = register(part, whole)
    assert near(fit.T_ref_est, np.zeros(3), 3e-3, 0.05)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
def test_maps_of_any_size_come_back_if_only_from_their_own_frame(scale):
    fit = register(L_SHAPE * scale, L_SHAPE * scale)
    np.testing.assert_allclose(fit.T_ref_est, np.zeros(3), atol=1e-6 * scale)


def test_all_look_alikes_are_placements_and_what_has_little_in_common_has_none():
    twice = np.vstack((building(), building() + np.array((40.0, 0.0))))
    part = building()[building()[:, 0] < 9.0]
    found = placements(Cloud(part), Cloud(twice))
    for place in ((0.0, 0.0, 0.0), (40.0, 0.0, 0.0)):
        assert any(near(pose, place, 0.5, 2.0) for pose in found)
    sparse = np.random.default_rng(2).uniform(0.0, 60.0, (150, 2))
    assert not placements(Cloud(part), Cloud(sparse))


def test_the_search_of_a_building_of_any_extent_takes_little_memory(monkeypatch):
    drawn = []

    def noted(grid, **options):
        drawn.append(grid.values.size)
        return build_pyramid(grid, **options)

    monkeypatch.setattr("tagalong.slam.quality.placements.build_pyramid", noted)
    for farthest in (100.0, 1e5):
        placements(Cloud(L_SHAPE), Cloud(np.array([(0.0, 0.0), (farthest, 0.0), (0.0, farthest)])))
    assert max(drawn) < 2100**2


@pytest.mark.parametrize("points", [np.zeros((3, 2)), np.array([(0.0, 0.0), (1e5, 0.0), (0.0, 1e5)])])
def test_maps_that_have_nothing_in_common_get_a_pose_and_no_error(points):
    assert np.isfinite(register(points, L_SHAPE).T_ref_est).all()
    assert np.isfinite(register(L_SHAPE, points).T_ref_est).all()
