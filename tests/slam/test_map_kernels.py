"""The kernels that compare maps: what they do once more in numpy and scipy, to the last bit."""

import numpy as np
import pytest
from scipy.ndimage import binary_dilation
from scipy.spatial import KDTree
from tagalong.slam.quality.cells import CommonCells, dynamic_residue, score_cells
from tagalong.slam.quality.map_kernels import describe_pieces, look_up, mark_near


def test_looks_up_the_cells_in_which_points_lie():
    rng = np.random.default_rng(0)
    mask = rng.random((30, 50)) < 0.5
    points = np.concatenate((rng.uniform(-2.0, 5.0, (500, 2)), np.arange(-20.0, 60.0)[:, None] * (0.05, 0.05)))
    cols, rows = np.floor((points - (0.3, -0.2)) / 0.05 + 1e-6).astype(int).T
    inside = (rows >= 0) & (rows < 30) & (cols >= 0) & (cols < 50)
    expected = np.zeros(len(points), dtype=bool)
    expected[inside] = mask[rows[inside], cols[inside]]
    found = np.ones(len(points), dtype=bool)
    look_up(points, 0.3, -0.2, 0.05, mask, found)
    np.testing.assert_array_equal(found, expected)
    assert 0 < found.sum() < inside.sum() < len(points)


@pytest.mark.parametrize("radius", [0.005, 0.12, 0.5])
def test_marks_the_cells_near_to_points(radius: float):
    places = np.random.default_rng(1).uniform(-1.5, 2.5, (60, 2))
    marked = np.zeros((40, 60), dtype=bool)
    mark_near(places, radius, -1.0, 0.5, 0.02, marked)
    rows, cols = np.nonzero(np.ones_like(marked))
    centres = np.stack((cols, rows), axis=-1) * 0.02 + 0.01 + (-1.0, 0.5)
    distances, _ = KDTree(places).query(centres, distance_upper_bound=radius)
    np.testing.assert_array_equal(marked.ravel(), np.isfinite(distances))
    assert not marked.all()


def test_describes_a_piece_of_wall_by_mean_and_covariance():
    rng = np.random.default_rng(2)
    points = rng.normal(size=(200, 2))
    distances, neighbours = KDTree(points).query(points, k=7, distance_upper_bound=0.3)
    near = np.isfinite(distances)
    assert 0 < near.sum() < near.size
    members, weights = points[np.where(near, neighbours, 0)], near / near.sum(axis=1, keepdims=True)
    means = np.einsum("nk,nki->ni", weights, members)
    spread = members - means[:, None]
    middles, spreads = np.empty((200, 2)), np.empty((200, 2, 2))
    describe_pieces(points, neighbours, middles, spreads)
    np.testing.assert_array_equal(middles, means)
    np.testing.assert_array_equal(spreads, np.einsum("nk,nki,nkj->nij", weights, spread, spread))


def test_a_cell_beside_a_wall_belongs_to_it():
    rng = np.random.default_rng(3)
    estimate, reference, free = (rng.random((3, 25, 35)) < 0.05).copy()
    free = ~free & ~reference
    around = np.ones((3, 3), dtype=bool)
    cells = CommonCells(estimate, ~estimate, reference, free, 0.1, (0.0, 0.0))
    assert score_cells(cells).precision == (estimate & binary_dilation(reference, around)).sum() / estimate.sum()
    everywhere = np.stack(np.meshgrid(np.arange(0.0, 3.5, 0.1), np.arange(0.0, 2.5, 0.1)), axis=-1) + 0.05
    residue = dynamic_residue(cells, everywhere)
    assert residue.cells == (estimate & free & ~binary_dilation(reference, around)).sum() > 0
