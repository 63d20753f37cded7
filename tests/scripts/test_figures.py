import numpy as np
import pytest
from full_disk import full_disk
from PIL import Image
from tagalong.scripts.figures.canvas import BLUE, INK, ORANGE, RED, PlanCanvas, save_png, side_by_side, stacked
from tagalong.scripts.figures.maps import BOTH, FREE, UNKNOWN, map_picture, overlay_picture
from tagalong.scripts.figures.scans import scan_pair_picture
from tagalong.scripts.figures.trajectory import trajectory_picture
from tagalong.scripts.figures.video import save_gif
from tagalong.slam import InputError, LaserScan, OccupancyMap


def room(ghost=False):
    cells = np.full((60, 80), 0.1, dtype=np.float32)
    cells[0], cells[-1], cells[:, 0], cells[:, -1] = 0.9, 0.9, 0.9, 0.9
    cells[20:22, 0:30] = 0.9
    cells[40:, 60:] = np.nan
    if ghost:
        cells[30:34, 40:44] = 0.9
    return OccupancyMap(cells, 0.05, (-1.0, 2.0))


def colours(picture):
    return {colour for _, colour in picture.getcolors(1 << 24)}


def count(picture, colour):
    return sum(n for n, c in picture.getcolors(1 << 24) if c == colour)


def test_a_map_shows_walls_free_space_and_the_unknown():
    picture = map_picture(room(), "a room")
    assert {INK, FREE, UNKNOWN} <= colours(picture)
    assert count(picture, FREE) > 4 * count(picture, INK)


def test_an_overlay_shows_agreement_ghosts_and_missing_walls():
    both = overlay_picture(room(), room(), T_ref_est=np.zeros(3))
    ghost = overlay_picture(room(ghost=True), room(), T_ref_est=np.zeros(3))
    missing = overlay_picture(room(), room(ghost=True), T_ref_est=np.zeros(3))
    assert count(both, BOTH) > 1000
    legend = count(both, BLUE), count(both, RED)
    assert count(ghost, BLUE) > legend[0] + 100
    assert count(ghost, RED) == legend[1]
    assert count(missing, RED) > legend[1] + 100


def test_an_overlay_registers_when_it_is_not_told_how_the_maps_lie():
    moved = OccupancyMap(room().probability, 0.05, (4.0, 5.0))
    assert count(overlay_picture(moved, room()), BOTH) > 1000


def test_the_canvas_puts_the_plane_upright_and_clips_at_its_border():
    canvas = PlanCanvas((0.0, 0.0), (10.0, 10.0), size=(600, 600))
    canvas.cells(np.array([(1.0, 9.0)]), 1.0, RED)
    canvas.circle((0.0, 0.0), 30.0, BLUE)
    canvas.circle((10.0, 10.0), 3.0, BLUE, 3.0)
    picture = canvas.finished()
    assert picture.getpixel((24 + 60, 24 + 60)) == RED
    pixels = np.array(picture)
    blue = (pixels == BLUE).all(axis=-1)
    assert blue.any()
    assert not blue[:, : 24 + 300].any()
    assert not blue[:, 24 + 601 :].any()


def test_a_long_legend_takes_more_lines_and_leaves_the_scale_bar_alone():
    def sheet(entries):
        canvas = PlanCanvas((0.0, 0.0), (10.0, 10.0), size=(600, 600))
        canvas.legend(entries)
        return np.array(canvas.finished())

    bare, short, long = sheet([]), sheet([("start", RED)]), sheet([(f"stretch {i} of the path", RED) for i in range(9)])
    assert bare.shape == short.shape
    assert long.shape[0] > short.shape[0]
    corner = np.s_[624 : bare.shape[0], 648 - 24 - 150 :]  # where the bar of 1 m and its text stand
    assert (bare[corner] == INK).all(axis=-1).any()
    assert np.array_equal(bare[corner], short[corner])
    assert np.array_equal(bare[corner], long[corner])
    rows = np.flatnonzero((long == RED).all(axis=-1).any(axis=1))
    assert np.count_nonzero(np.diff(rows) > 1) >= 2


def test_thin_walls_stay_visible_on_a_large_plan():
    canvas = PlanCanvas((0.0, 0.0), (400.0, 400.0))
    canvas.cells(np.column_stack((np.arange(0, 400, 0.02), np.full(20000, 200.0))), 0.02, INK, 1.5)
    assert (np.array(canvas.finished()).min(axis=(1, 2)) < 60).any()


def test_a_scan_pair_colours_what_the_filter_drops():
    bearings = np.linspace(-2.3, 2.3, 400)
    raw = LaserScan(np.full(400, 4.0), bearings, 0.1, 30.0, T_robot_lidar=(0.1, 0.0, 0.0))
    dropped = np.abs(bearings) < 0.1
    filtered = raw.without(dropped)
    picture = scan_pair_picture(raw, filtered, [(4.0, 0.0)], title="t = 1 s")
    pixels = np.array(picture)
    half = pixels.shape[1] // 2
    assert (pixels[:, :half] == ORANGE).all(axis=-1).sum() > 50
    assert not (pixels[:, half:] == ORANGE).all(axis=-1).any()


def test_trajectories_are_drawn_on_the_map_even_beyond_it():
    path = np.array([(0.0, 3.0, 0.0), (6.0, 3.0, 0.0)])
    with_path = trajectory_picture(room(), {"estimate": path, "nothing": np.empty((0, 3))})
    assert count(with_path, BLUE) > 500
    assert count(trajectory_picture(room(), {}), BLUE) == 0


def test_coarse_cells_are_shown_whole_and_drawn_at_once():
    corner = np.full((2, 3), 0.9, dtype=np.float32)
    corner[1, 1:] = 0.1
    pixels = np.array(map_picture(OccupancyMap(corner, 10.0, (0.0, 0.0))))
    ink, free = ((pixels == colour).all(axis=-1) for colour in (INK, FREE))
    plan = slice(24, 24 + 900)  # below it stand scale bar and legend
    rows, cols = np.nonzero(ink[plan])
    # 30 x 20 m of cells in a picture of 40 x 30 m, 30 px a metre
    assert (np.ptp(cols) + 1, np.ptp(rows) + 1) == pytest.approx((900, 600), abs=4)
    assert ink[plan].sum() == pytest.approx(4 * 300**2, rel=0.02)
    assert free[24 + 160 : 24 + 440, 24 + 460 : 24 + 1040].all()


def test_large_and_small_squares_are_drawn_alike():
    points = np.random.default_rng(0).uniform(-1.0, 11.0, (40, 2))
    one_by_one, all_together = PlanCanvas((0, 0), (10, 10)), PlanCanvas((0, 0), (10, 10))
    one_by_one.cells(points, 0.4, RED)
    all_together.cells(np.tile(points, (200, 1)), 0.4, RED)
    assert one_by_one.finished().tobytes() == all_together.finished().tobytes()


def test_an_empty_map_is_a_picture_too():
    empty = OccupancyMap(np.full((3, 3), np.nan, dtype=np.float32), 0.1, (0.0, 0.0))
    assert map_picture(empty).width > 100


def test_pictures_are_equal_to_the_byte_and_can_be_joined(tmp_path):
    save_png(tmp_path / "a.png", map_picture(room()))
    save_png(tmp_path / "b.png", map_picture(room()))
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    one, two = Image.new("RGB", (30, 20)), Image.new("RGB", (10, 40))
    assert side_by_side((one, two)).size == (40, 40)
    assert stacked((one, two)).size == (30, 60)


def test_a_failed_write_leaves_nothing(tmp_path, monkeypatch):
    picture = map_picture(room())

    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(picture, "save", interrupted)
    with pytest.raises(KeyboardInterrupt):
        save_png(tmp_path / "a.png", picture)
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_leaves_the_picture_that_was_there(tmp_path):
    noise = np.random.default_rng(0).integers(0, 255, (99, 99, 3), dtype=np.uint8)
    for name, write in {
        "a.png": lambda path: save_png(path, Image.fromarray(noise)),
        "a.gif": lambda path: save_gif(path, [noise], 10.0),
    }.items():
        write(tmp_path / name)
        whole = (tmp_path / name).read_bytes()
        with full_disk(), pytest.raises(InputError, match=rf"{name}: cannot be written \(File too large\)"):
            write(tmp_path / name)
        assert (tmp_path / name).read_bytes() == whole
        assert not list(tmp_path.glob(".*"))
