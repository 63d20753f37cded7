"""What is counted on the maps of the lab, and one short drive to its report."""

import argparse
import json

import numpy as np
import pytest
from tagalong.envs import RgbdConfig
from tagalong.scripts.benchmarks import rgbd_planes
from tagalong.scripts.reproduce.experiment import load_experiment
from tagalong.scripts.reproduce.immobile import measures, tables
from tagalong.scripts.reproduce.immobile.counted import Counted, CountedShare
from tagalong.scripts.reproduce.immobile.drives import MAPPERS, _Drive, lab_drive, lab_world
from tagalong.scripts.reproduce.immobile.plan import CLEAN, SHAKEN, cell_name, plan_of
from tagalong.scripts.reproduce.run import run_experiment
from tagalong.slam import InputError, LaserScan, OccupancyMap, read_ros_map
from tagalong.slam.geometry import inverse, transform_points

RESOLUTION = 0.05


def options(**given):
    parser = argparse.ArgumentParser()
    load_experiment("immobile").add_arguments(parser)
    return argparse.Namespace(**{**vars(parser.parse_args([])), "quick": False, "data": None, **given})


def map_with(cells, size=200):
    """A map of 10 x 10 m, free but for the cells at these places (x, y)."""
    probability = np.zeros((size, size), dtype=np.float32)
    col, row = np.floor(np.asarray(cells, dtype=float).reshape(-1, 2) / RESOLUTION).astype(int).T
    probability[row, col] = 1.0
    return OccupancyMap(probability, RESOLUTION, (0.0, 0.0))


def test_cells_of_people_are_those_where_somebody_was_and_nothing_is():
    scene = lab_world(0).scene
    stood = scene.marks["e"].mean(axis=0)
    grid = map_with([stood, stood + 0.2, stood + 1.0, (1.0, 0.02)])
    walked = np.array([stood, (1.0, 0.2)])
    assert measures.people_cells(grid, np.zeros(3), scene, walked) == 2


def test_static_cells_hold_a_true_surface_and_may_be_lost():
    scene = lab_world(0).scene
    nothing = (3.02, 1.02)
    outer_face = (3.02, scene.bounds[3] - 0.01)
    conventional = map_with([(3.02, 0.01), nothing, outer_face])
    cells = measures.static_cells(conventional, np.zeros(3), scene)
    assert cells.tolist() == [pytest.approx([3.025, 0.025])]
    assert measures.lost_cells(map_with([(3.02, 0.06)]), cells, reach=0) == 1
    assert measures.lost_cells(map_with([(3.02, 0.06)]), cells, reach=1) == 0


def test_known_cells_and_wrongly_free_ones_are_counted_in_a_polygon():
    scene = lab_world(0).scene
    grid = map_with([])
    corner = scene.marks["a"]
    side = corner.max(axis=0) - corner.min(axis=0)
    known = measures.known_cells(grid, np.zeros(3), corner)
    assert known == pytest.approx(side.prod() / RESOLUTION**2, rel=0.05)
    assert measures.cells_in(corner, np.zeros(3), RESOLUTION) == known
    turned = measures.cells_in(corner, np.array([1.0, 2.0, 0.5]), RESOLUTION)
    assert turned == pytest.approx(known, rel=0.02)
    below, free = measures.wrongly_free(grid, np.zeros(3), scene, corner)
    assert below == free > 50


def test_tops_count_where_they_were_seen():
    scene = lab_world(0).scene
    tops = measures.SeenTops(scene, np.zeros(3), RESOLUTION)
    table = next(solid for solid in scene.solids if solid.kind == "table")
    seen = np.array([[table.x, table.y], [table.x + 0.1, table.y], [table.x + 9.0, table.y]])
    tops.add("table", seen)
    assert tops.share("table", map_with(seen[:1])) == (2, 1)


def test_the_door_is_cleared_when_the_map_lets_go_of_what_the_scan_sees_through():
    world = lab_world(0)
    T_map_world = inverse(world.start)
    watch = measures.DoorWatch(world.scene, T_map_world, RESOLUTION)
    assert watch.cells / RESOLUTION % 1.0 == pytest.approx(0.5)  # centres
    leaf = transform_points(inverse(T_map_world), watch.cells) - world.scene.doors[0].hinge
    assert np.hypot(*leaf.T).max() < world.scene.doors[0].width
    low, high = watch.cells.min(axis=0) - 1.0, watch.cells.max(axis=0) + 1.0
    size = np.ceil((high - low) / RESOLUTION).astype(int)
    full = OccupancyMap(np.ones(size[::-1], dtype=np.float32), RESOLUTION, (float(low[0]), float(low[1])))
    empty = OccupancyMap(np.zeros(size[::-1], dtype=np.float32), RESOLUTION, full.origin)
    watch.closed(full)
    x, y = watch.cells.mean(axis=0)
    bearings = np.linspace(-np.pi, np.pi, 1441)
    for time_s, grid in ((1.0, full), (1.5, full), (3.5, empty)):
        watch.opened(np.array([x, y + 2.0, 0.0]), LaserScan(np.full(1441, 9.0), bearings, 0.1, 10.0, time_s), grid)
    delays = watch.delays()
    assert len(delays) == len(watch.cells)
    assert delays == pytest.approx(2.5)
    assert watch.still(full) == len(delays)
    assert watch.still(empty) == 0


def test_a_ray_that_passes_beside_a_cell_of_the_door_does_not_see_it_open():
    world = lab_world(0)
    T_map_world = inverse(world.start)
    bearings = np.radians([-95.0, -90.0])
    seen = {}
    for aside in (0.02, 0.03):
        watch = measures.DoorWatch(world.scene, T_map_world, RESOLUTION)
        size = np.full(2, 400)
        low = watch.cells[0] - 10.0
        full = OccupancyMap(np.ones(size, dtype=np.float32), RESOLUTION, (float(low[0]), float(low[1])))
        watch.closed(full)
        x, y = watch.cells[watch.cells[:, 0].argmax()]
        pose = np.array([x + aside, y + 2.0, 0.0])
        for k, reach in enumerate((1.9, 2.05, 9.0)):  # before the cell, in it, beyond it
            watch.opened(pose, LaserScan(np.array([np.nan, reach]), bearings, 0.1, 10.0, float(k)), full)
            seen[aside, reach] = len(watch.delays())
    assert seen[0.02, 1.9] == seen[0.02, 2.05] == 0
    assert seen[0.02, 9.0] > seen[0.03, 9.0] == 0


def test_shares_are_written_with_their_counts():
    assert str(CountedShare(1, 8)) == "12.5 % (1 of 8)"
    assert str(CountedShare(0, 0)) == "none"


def drive_row(people, door_late, laser_known=100):
    """What one drive returned, as far as it is counted: `people` cells left of 50, `door_late` cells of 40."""
    maps = {"people_cells": people, "table": [100, 96], "chair": [100, 97], "known": {"a": 200, "b": 200}}
    maps |= {"static_lost": 5, "wrongly_free": {"a": [0, 0], "b": [0, 0]}}
    laser = {**maps, "known": {"a": laser_known, "b": laser_known}}
    door = {"cells": 40 if door_late is not None else 0, "within_2_s": 40 - (door_late or 0)}
    rows = {"conventional": {**maps, "people_cells": 50}, "laser": laser, "immobile": maps}
    hidden = {"a": 210, "b": 200}
    return {"maps": rows, "door": {"immobile": door}, "static_cells": 1000, "hidden_cells": hidden}


def test_an_error_is_compared_over_all_drives_and_its_interval_is_over_the_drives():
    shaken = "vibration 2 deg"
    rows = {cell_name(CLEAN, 0): drive_row(1, 1), cell_name(CLEAN, 1): drive_row(1, 0)}
    rows |= {cell_name(shaken, 0): drive_row(2, 3), cell_name(shaken, 1): drive_row(2, 1)}
    counted = Counted(rows, (0, 1))
    assert counted.ratio("immobile", shaken, "people cells left").mean == pytest.approx(2.0)
    assert counted.ratio("immobile", shaken, "door cells not cleared in 2 s").mean == pytest.approx(4.0)
    assert counted.known("immobile", "a", shaken).value == pytest.approx(2.0)
    table = {row[1]: row[2:] for row in tables.doubled_table(counted, [shaken]).rows}
    assert table["people cells left"] == ("2.0 % (2 of 100)", "4.0 % (4 of 100)", "2.00 [2.00, 2.00]", "yes", "yes")
    assert table["door cells not cleared in 2 s"][2:] == ("4.00 [2.15, inf]", "NO", "yes")
    assert table["unknown cells in a"][0] == "4.8 % (20 of 420)"
    assert table["unknown cells in b"][2:] == ("-", "yes", "yes")


def test_of_no_errors_the_double_is_none_by_share_and_what_is_believable_by_bound():
    shaken, name = "vibration 2 deg", "door cells not cleared in 2 s"
    verdicts = []
    for late in (0, 1, 2):
        rows = {cell_name(CLEAN, 0): drive_row(1, 0), cell_name(shaken, 0): drive_row(1, late)}
        table = {row[1]: row[2:] for row in tables.doubled_table(Counted(rows, (0,)), [shaken]).rows}
        verdicts.append(table[name][2:])
    assert verdicts == [("-", "yes", "yes"), ("-", "NO", "yes"), ("-", "NO", "NO")]


def test_numbers_have_intervals_over_the_drives():
    shaken = "vibration 2 deg"
    rows = {cell_name(name, seed): drive_row(1 + 2 * seed, 0) for name in (CLEAN, shaken) for seed in (0, 1)}
    for row in rows.values():
        row["maps"] = dict.fromkeys(MAPPERS, row["maps"]["immobile"]) | row["maps"]
    found = tables.numbers(Counted(rows, (0, 1)), [CLEAN, shaken])
    people = found[CLEAN]["immobile"]["people cells left"]
    assert (people["cells"], people["of"], people["n"]) == (4, 100, 2)
    assert people["low"] < people["mean"] < people["high"]
    assert people["mean"] == pytest.approx(people["cells"] / people["of"])
    assert found[shaken]["immobile"]["people cells left"]["ratio_to_undisturbed"]["mean"] == pytest.approx(1.0)
    assert "ratio_to_undisturbed" not in people
    assert "known area in a over the laser's" in found[CLEAN]["immobile"]
    one = tables.numbers(Counted(rows, (0,)), [CLEAN])[CLEAN]["immobile"]["people cells left"]
    assert np.isnan([one["low"], one["high"]]).all()


def test_a_door_that_never_opened_has_no_verdict():
    rows = {cell_name(name, 0): drive_row(1, None) for name in (CLEAN, "vibration 2 deg")}
    table = {row[1]: row[2:] for row in tables.doubled_table(Counted(rows, (0,)), ["vibration 2 deg"]).rows}
    assert table["people cells left"][2:] == ("1.00", "yes", "yes")
    assert table["door cells not cleared in 2 s"] == ("none", "none", "-", "-", "-")


def test_the_plan_holds_every_disturbance_for_every_seed():
    plan = plan_of(options(seeds=2))
    cells = plan.cells()
    assert len(cells) == 2 * len(SHAKEN)
    assert cells[0].arguments["vibration_deg"] == 0.0
    assert plan.settings["camera_hz"] == 10.0
    assert plan_of(options(quick=True)).disturbances[0] == CLEAN
    with pytest.raises(InputError, match="poses"):
        lab_drive(0, "guess", 2.0, 0.3, 0.0, 0.0, 0.0, 0.0, 1.0, [], files=None)  # pyright: ignore[reportArgumentType]


def test_the_papers_robot_and_camera_are_a_preset(tmp_path):
    cell = plan_of(options(seeds=1, paper=True)).cells()[0]
    assert cell.arguments["paper"]
    drive = _Drive(lab_world(0, RgbdConfig(width=512, height=424), "pioneer"), "truth", 0.0, 0.0, 0, ["immobile"])
    assert drive.world.frames[-1].depth.shape == (424, 512)
    assert drive.world.config.robot.chassis == (0.455, 0.381, 0.237)
    told = {
        **cell.arguments,
        "poses": "truth",
        "camera_hz": 1.0,
        "longest_s": 1.0,
        "ways": ["conventional", "immobile"],
    }
    assert lab_drive(**told, files=tmp_path)["pose_error_m"] < 1e-6


def test_a_short_drive_ends_in_a_report_with_all_its_figures(tmp_path):
    given = options(
        quick=True, minutes=0.1, poses="truth", out=tmp_path, jobs=1, backend="local", experiment="immobile"
    )
    report = run_experiment(load_experiment("immobile"), given)
    figures = {figure.file.name for section in report.sections for figure in section.figures}
    assert {name.split("_")[0] for name in figures} == {f"fig{k}" for k in (1, 3, 4, 5, 6, 7, 8, 9)}
    assert all((tmp_path / "figures" / name).stat().st_size > 5000 for name in figures)
    exported = [read_ros_map(tmp_path / "maps" / f"seed-0{layer}.yaml") for layer in ("", "_movable")]
    assert exported[0].probability.shape == exported[1].probability.shape
    assert exported[0].occupied.sum() > 100
    content = json.loads((tmp_path / "results.json").read_text())
    row = content["cells"][f"{CLEAN.replace(' ', '-')}/seed-0"]
    assert row["pose_error_m"] < 1e-12
    assert row["maps"]["immobile"]["table"][1] > 3 * row["maps"]["laser"]["table"][1]


def test_planes_are_counted_against_what_the_rays_met():
    counts = rgbd_planes.Counts()
    rgbd_planes.count_drive(0, rgbd_planes.MOUNTS["level"], counts, longest_s=6.0)
    assert counts.whole["wall"] > 5000
    assert counts.right["wall"] > 0.95 * counts.whole["wall"]
    assert max(counts.slopes) < np.radians(0.3)
    assert len(counts.row()) == len(rgbd_planes.KINDS) + 3
