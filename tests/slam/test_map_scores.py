import json

import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import transform_points
from tagalong.slam.occupancy_map import OccupancyMap
from tagalong.slam.quality.cells import common_cells, dynamic_residue, score_cells
from tagalong.slam.quality.score import score_map


def drawn(rows, resolution=0.1, origin=(0.0, 0.0)):
    """A map from rows of text, top row first: # occupied, . free, blank unknown."""
    values = {"#": 0.9, ".": 0.1, " ": np.nan}
    cells = np.array([[values[c] for c in row] for row in reversed(rows)], dtype=np.float32)
    return OccupancyMap(cells, resolution, origin)


ROOM = drawn(
    [
        "############",
        "#..........#",
        "#..........#",
        "#..........#",
        "#......#####",
        "#......#    ",
        "########    ",
    ]
)


def changed(grid, cells, value):
    probability = grid.probability.copy()
    for row, col in cells:
        probability[row, col] = value
    return OccupancyMap(probability, grid.resolution, grid.origin)


def test_a_map_agrees_with_itself():
    score = score_cells(common_cells(ROOM, ROOM))
    assert (score.precision, score.recall, score.f1, score.iou, score.free_coverage) == (1, 1, 1, 1, 1)


def test_free_cells_are_carried_over_up_to_the_edges():
    field = drawn(["....", ".#..", "...."])
    cells = common_cells(field, field)
    left, low = (round(-place / 0.1) for place in cells.origin)
    for carried in (cells.reference_free, cells.estimate_free):
        np.testing.assert_array_equal(carried[low : low + 3, left : left + 4], field.free)
        assert carried.sum() == 11


def test_a_shift_by_one_cell_is_forgiven_by_the_tolerance_but_not_by_iou():
    moved = OccupancyMap(ROOM.probability, ROOM.resolution, (0.1, 0.0))
    score = score_cells(common_cells(moved, ROOM))
    assert score.precision == score.recall == 1.0
    assert score.iou < 0.8
    assert score_cells(common_cells(moved, ROOM, (-0.1, 0.0, 0.0))).iou == 1.0


def test_two_ghost_cells_cost_precision_and_two_missing_ones_recall():
    walls = int(ROOM.occupied.sum())
    # row 3 from below is far from every wall but the left one
    ghosts = changed(ROOM, [(3, 3), (3, 5)], 0.9)
    score = score_cells(common_cells(ghosts, ROOM))
    assert score.precision == pytest.approx(walls / (walls + 2))
    assert score.recall == 1.0
    assert score.iou == pytest.approx(walls / (walls + 2))
    hole = changed(ROOM, [(6, c) for c in range(3, 8)], np.nan)
    score = score_cells(common_cells(hole, ROOM))
    assert score.recall == pytest.approx((walls - 3) / walls)  # the outer two of five keep a neighbour
    assert score.precision == 1.0


def test_free_coverage_counts_what_the_estimate_knows_to_be_free():
    unseen = changed(ROOM, [(5, c) for c in range(1, 11)], np.nan)
    free = int(ROOM.free.sum())
    assert score_cells(common_cells(unseen, ROOM)).free_coverage == pytest.approx((free - 10) / free)


def test_a_coarser_map_sets_the_lattice():
    fine = OccupancyMap(np.kron(ROOM.probability, np.ones((5, 5), dtype=np.float32)), 0.02, (0.0, 0.0))
    cells = common_cells(fine, ROOM)
    assert cells.resolution == 0.1
    assert score_cells(cells).iou == 1.0
    assert score_cells(cells).free_coverage == 1.0


def test_residue_counts_ghosts_where_somebody_walked_and_nothing_else():
    estimate = changed(ROOM, [(3, 4), (3, 8), (5, 5)], 0.9)
    at = ROOM.cell_centres(np.isin(np.arange(ROOM.probability.size), [3 * 12 + 4, 3 * 12 + 2]).reshape(7, 12))
    cells = common_cells(estimate, ROOM)
    residue = dynamic_residue(cells, at[None], radius=0.04)
    assert residue.cells == 1
    assert residue.area_m2 == pytest.approx(0.01)
    assert residue.share == pytest.approx(0.5)
    assert dynamic_residue(cells, [*at, (np.nan, np.nan)], radius=0.04) == residue  # a foot that was not there
    nobody = dynamic_residue(cells, np.empty((7, 0, 2)))
    assert nobody.cells == 0
    assert np.isnan(nobody.share)
    with pytest.raises(InputError, match=r"\(\.\.\., 2\)"):
        dynamic_residue(cells, np.zeros((3, 3)))


def corridor(step):
    """A corridor with an L bend on a lattice of `step` metres."""
    xs, ys = np.arange(0, 8, step) + step / 2, np.arange(0, 5, step) + step / 2
    x, y = np.meshgrid(xs, ys)
    inside = ((y < 2) | (x > 6)) & (x > 0.1) & (x < 7.9) & (y > 0.1) & (y < 4.9)
    wall = ~inside & ((y < 2.1) | (x > 5.9))
    return OccupancyMap(np.where(inside, 0.1, np.where(wall, 0.9, np.nan)).astype(np.float32), step, (0.0, 0.0))


def turned(grid, T_ref_est):
    """The same map drawn in a frame that `T_ref_est` maps back."""
    size = 260
    rows, cols = np.indices((size, size))
    centres = np.stack((cols, rows), axis=-1).reshape(-1, 2) * 0.05 + 0.025 - 3.0
    back = transform_points(T_ref_est, centres) / grid.resolution
    col, row = np.floor(back).astype(int).T
    inside = (row >= 0) & (row < grid.probability.shape[0]) & (col >= 0) & (col < grid.probability.shape[1])
    probability = np.full(size * size, np.nan, dtype=np.float32)
    probability[inside] = grid.probability[row[inside], col[inside]]
    return OccupancyMap(probability.reshape(size, size), 0.05, (-3.0, -3.0))


def test_the_facade_registers_before_it_measures():
    reference = corridor(0.05)
    score = score_map(turned(reference, (0.3, -0.4, 0.2)), reference, people=np.array([[(3.0, 1.0)]]))
    np.testing.assert_allclose(score.registration.T_ref_est, (0.3, -0.4, 0.2), atol=0.01)
    assert score.adnn.mean_m < 0.02
    assert score.ghosts.mean_m < 0.02
    assert score.cells.f1 > 0.98
    assert score.residue is not None
    assert score.residue.cells == 0
    assert json.loads(json.dumps(score.to_dict()))["registration"]["converged"]
    assert score_map(reference, reference).to_dict()["dynamic_residue"] is None
