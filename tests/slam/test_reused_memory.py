"""Large arrays lie on memory that is used again, and never on memory that something else lies on."""

import copy

import numpy as np
from tagalong.slam.local.submap import Submap, SubmapConfig
from tagalong.slam.local.sweep import Sweep
from tagalong.slam.reused_memory import ReusedMemory, reused_array
from tagalong.slam.search.score_pyramid import ScoreGrid, build_pyramid

MB = 1 << 20


def place(array):
    return array.__array_interface__["data"][0]


def test_an_array_has_the_shape_and_kind_that_was_asked_for_and_can_be_written_to():
    memory = ReusedMemory()
    for shape, kind in (((700, 300), np.float32), ((3, 5), np.int16), ((0, 7), np.float64), ((4, 600, 300), np.uint8)):
        array = reused_array(shape, kind, memory)
        array.fill(3)
        assert array.shape == shape
        assert array.dtype == kind
        assert array.flags.c_contiguous
        assert (array == 3).all()


def test_what_comes_after_an_array_lies_where_that_was():
    memory = ReusedMemory()
    first = reused_array((2 * MB,), np.uint8, memory)
    where = place(first)
    del first
    assert place(reused_array((1900, 1000), np.uint8, memory)) == where


def test_a_view_keeps_its_memory_from_being_used_again():
    memory = ReusedMemory()
    view = reused_array((MB,), np.float32, memory)[10:20].reshape(2, 5)
    view[:] = 7
    other = reused_array((MB,), np.float32, memory)
    other.fill(0)
    assert (view == 7).all()


def test_a_large_block_is_not_spent_on_a_small_array():
    memory = ReusedMemory()
    where = place(reused_array((4 * MB,), np.uint8, memory))
    assert place(reused_array((MB,), np.uint8, memory)) != where


def test_no_more_is_kept_than_was_said():
    memory = ReusedMemory(kept=3 * MB)
    arrays = [reused_array((MB,), np.uint8, memory) for _ in range(8)]
    assert memory.nbytes == 0
    del arrays
    assert memory.nbytes == 3 * MB


def test_a_copy_of_an_array_is_its_own():
    array = reused_array((MB,), np.uint8)
    array.fill(5)
    other = copy.deepcopy(array)
    array.fill(6)
    assert (other == 5).all()


def soil_memory():
    """Leave ones in all bits of what large arrays are made of next."""
    arrays = [reused_array((round(2 ** (k / 4)) * MB // 8,), np.uint8) for k in range(24)]
    for array in arrays:
        array.fill(255)


def test_what_lay_in_memory_before_is_seen_in_no_pyramid():
    grid = ScoreGrid(np.random.default_rng(0).integers(0, 256, (700, 500), dtype=np.uint8), (0.0, 0.0), 0.05)
    soil_memory()
    pyramid = build_pyramid(grid, margin=40)
    inner = pyramid.levels[0, 7:707, 7:507]
    assert (inner == grid.values).all()
    assert pyramid.levels[0].sum(dtype=np.int64) == grid.values.sum(dtype=np.int64)
    assert pyramid.phases.sum(dtype=np.int64) == pyramid.levels[3].sum(dtype=np.int64)


def submap_of(corners):
    """Return a submap drawn from a scan of one beam to each of `corners` (n, 2) [m], so that it grows each time."""
    submap = Submap(SubmapConfig(), np.zeros(3))
    for corner in corners:
        submap.insert(Sweep(np.array([[0.0, 0.0], corner]), 1, 0))
    return submap


def test_what_lay_in_memory_before_is_seen_in_no_submap_however_it_grows():
    corners = np.array([[9.0, 1.0], [-11.0, 2.0], [3.0, -14.0], [-2.0, 17.0], [20.0, 20.0]])
    soil_memory()
    submap = submap_of(corners)
    assert submap.field.nbytes > MB
    drawn = np.abs(submap.field) > 0.0
    assert np.isfinite(submap.field).all()
    assert 0 < drawn.sum() < 2 * len(corners)
    assert submap.visits.sum() < 2 * np.hypot(*corners.T).sum() / submap.resolution
    before = submap.field.copy()
    submap.finish()
    soil_memory()
    assert (submap.field == before).all()
