"""The paper's error, the paired test, consistency and recovery on made-up results, and one short world."""

import numpy as np
import pytest
from tagalong.scripts.figures.plots import new_figure
from tagalong.scripts.reproduce.clustering import pictures
from tagalong.scripts.reproduce.clustering.animation import LEGEND
from tagalong.scripts.reproduce.clustering.cells import GAPS, recovery_cell
from tagalong.scripts.reproduce.clustering.drives import ROBOTS, shortened, simulate
from tagalong.scripts.reproduce.clustering.example import COLUMNS, odometry_covariances
from tagalong.scripts.reproduce.clustering.filters import errors_of, run_ekf_slam, run_localization, y_errors
from tagalong.scripts.reproduce.clustering.judgement import Worlds, claim, compare_all, consistency, recovery, slowest
from tagalong.scripts.reproduce.clustering.methods import METHODS, PAPER, cluster
from tagalong.scripts.reproduce.clustering.pictures import _ground, draw_dynamics, draw_growth, draw_times
from tagalong.scripts.reproduce.clustering.tables import claim_table, methods_table, recovery_table, y_table
from tagalong.scripts.reproduce.experiment import load_experiment


@pytest.fixture(scope="module")
def drive():
    return simulate(3)


def test_the_error_of_y_is_taken_where_x_coincides():
    path = np.array([(0.1 * k, 0.0, 0.0) for k in range(50)])
    keys = np.array([5, 20, 40])
    found = y_errors(path[keys] + (0.33, 0.2, 0.0), path, keys)
    np.testing.assert_allclose(found, 0.2)
    assert np.isnan(y_errors(np.array([[30.0, 0.0]]), path, np.array([20]))).all()


def test_a_world_is_two_laps_of_two_robots(drive):
    assert drive.arcs[-1] > 60.0
    assert len(drive.posts) >= 20
    off = errors_of(drive, drive.odometry["typical"][drive.keys])
    assert errors_of(drive, drive.odometry["perfect"][drive.keys])["rms_m"] < 1e-9 < off["rms_m"]
    scan = drive.scans[drive.keys[10]]
    assert np.nanmax(np.where(np.isfinite(shortened(scan, 4.0).ranges), shortened(scan, 4.0).ranges, 0.0)) <= 4.0


def test_both_filters_do_better_than_odometry(drive):
    found = cluster("dbscan", [drive.scans[i] for i in drive.keys])
    blind = errors_of(drive, drive.odometry["typical"][drive.keys])["rms_m"]
    for run in (run_ekf_slam, run_localization):
        assert errors_of(drive, run(drive, "typical", drive.scans, found.labels).poses)["rms_m"] < min(0.1, 0.5 * blind)


def test_ellipses_grow_without_update(drive):
    areas = np.linalg.det(odometry_covariances(drive))
    assert areas[-1] > areas[len(areas) // 2] > areas[3] > 0.0


def test_most_is_found_again_after_six_metres():
    found = recovery_cell(1)
    assert set(found) == set(GAPS)
    assert found["6 m"]["within_3_m"] < 0.1


def made_up(seed):
    rng = np.random.default_rng(seed)
    better = {"heuristic": 1.0, "dbscan": 0.9, "kmeans": 2.0, "gmm": 1.2, "kmeans-silhouette": 1.5, "gmm-bic": 1.3}
    slow = {"heuristic": 0.4, "dbscan": 0.3, "kmeans": 2.0, "gmm": 6.0, "kmeans-silhouette": 3.0, "gmm-bic": 6.0}
    figures = ("rms_m", "ate_m", "y_sum_m", "y_mean_m", "end_m")
    world = 0.02 * (1.0 + rng.random())

    def errors(scale):
        return dict.fromkeys(figures, world * scale)

    robots = {
        robot: {"odometry": errors(20.0)}
        | {name: dict.fromkeys(("slam", "localization", "lost"), errors(better[name])) for name in METHODS}
        for robot in ROBOTS
    }
    timing = {
        name: {"cluster_s": slow[name], "typical_filter_s": 0.01 * world, "perfect_filter_s": 0.1} for name in METHODS
    }
    growth = {"arc_m": [0.0, 50.0, 90.0], "area_m2": [0.1, -1.0, 3.0]}
    return {"keys": 200, "robots": robots, "timing": timing, "sightings": dict.fromkeys(METHODS, 4.0), "growth": growth}


@pytest.fixture
def worlds():
    return Worlds([made_up(seed) for seed in range(16)])


def test_the_claim_is_tested_not_assumed(worlds):
    assert claim(worlds)["five_percent_better"]
    assert claim(worlds)["timing"]["fastest"]
    assert slowest(worlds) == "gmm"
    rng = np.random.default_rng(0)
    same = rng.random(16)
    equal, noise = compare_all({"dbscan": same, "heuristic": same, "gmm": same + 0.3 * rng.standard_normal(16)})
    assert (equal.equal, equal.p, equal.verdict) == (16, 1.0, "no difference found")
    assert noise.equal == 0


def test_nees_within_its_bounds_is_counted():
    rng = np.random.default_rng(0)
    rows = [{"nees": rng.chisquare(3, 400).tolist()} for _ in range(50)]
    assert consistency(rows).inside > 0.9
    assert consistency([{"nees": [2.0 * value for value in row["nees"]]} for row in rows]).inside < 0.1


def test_no_nees_is_above_the_plot(tmp_path, monkeypatch):
    kept = []
    monkeypatch.setattr(pictures, "save_figure", lambda path, figure: kept.append(figure) or path)
    pictures.draw_consistency(consistency([{"nees": [3.0] * 20 + [40.0]}]), tmp_path)
    assert kept[0].axes[0].get_ylim()[1] > 40.0


def test_recovery_counts_who_is_back():
    row = {"seen_again": True, "before_m": 0.01, "peak_m": 0.3, "worst_later_m": 0.05, "blind_way_m": 6.0}
    rows = [{name: row | {"within_3_m": 0.02 if k else 0.4} for name in GAPS} for k in range(20)]
    assert recovery(rows)["6 m"]["back"].mean == pytest.approx(0.95)
    never = [{name: {"seen_again": False} for name in GAPS}]
    assert recovery(never)["6 m"]["worlds"] == 0
    assert recovery_table(never).rows[0][2:8] == ["-", "-", "- of 0", "-", "-", "-"]
    assert len(recovery_table(rows).rows) == len(GAPS)


def test_tables_and_figures_are_made(worlds, drive, tmp_path):
    for table in (methods_table(worlds), y_table(worlds), claim_table(worlds)):
        assert all(len(row) == len(table.columns) for row in table.rows)
    example = {"path": drive.path, "keys": drive.keys, "posts": drive.posts, "odometry": drive.odometry["typical"][:9]}
    example |= {"covered": np.arange(9) > 6}
    for name in PAPER:
        example |= {f"{name}_scan": np.arange(9), f"{name}_means": np.ones((9, 2)), f"{name}_totals": _unit(9)}
        for column in COLUMNS[1:]:
            key = f"{name}_{column}"
            example |= {f"{key}_poses": np.zeros((9, 3)), f"{key}_landmarks": np.ones((4, 2))}
            example[f"{key}_covariances"] = _unit(4)
    figures = [draw_times(worlds, tmp_path), draw_growth(worlds, example, tmp_path), draw_dynamics(example, tmp_path)]
    assert all(figure.file.stat().st_size > 5000 for figure in figures)
    assert len(LEGEND) == 9


def test_places_are_drawn_on_axes_with_names_and_units(drive):
    axes = new_figure(3, 3).add_subplot()
    _ground(axes, {"path": drive.path, "posts": drive.posts})
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [m]", "y [m]")


def _unit(count):
    return np.tile(0.1 * np.eye(2), (count, 1, 1))


def test_the_experiment_is_known():
    assert load_experiment("clustering").name == "clustering"
