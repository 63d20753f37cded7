"""Numbers beyond what physics allows are refused at the border, in one line, by all that takes them."""

import math
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
import pytest
from tagalong.perception import PeopleFilter
from tagalong.perception.tracking import NoLegs, SeenPeople
from tagalong.slam.bounds import MOST_BEAMS, Within, cell_numbers, check_numbers, checked_pose, memory_for
from tagalong.slam.engine import ENGINES, make_slam
from tagalong.slam.errors import InputError, shown
from tagalong.slam.gmapping.tile_maps import TileMaps
from tagalong.slam.grid import GridConfig, OccupancyGrid, render_map
from tagalong.slam.localization.localizer import Localizer
from tagalong.slam.logs.drive import RecordedDrive
from tagalong.slam.logs.drive_folder import SimulatedDrive
from tagalong.slam.logs.tum import Trajectory
from tagalong.slam.occupancy_map import OccupancyMap
from tagalong.slam.processes.threads import Workers
from tagalong.slam.quality.adnn import adnn
from tagalong.slam.quality.cells import common_cells, dynamic_residue
from tagalong.slam.quality.trajectory import absolute_error
from tagalong.slam.scan import LaserScan
from tagalong.slam.scan_to_scan import make_matcher
from tagalong.slam.scan_to_scan.matchers import MATCHERS

BEARINGS = np.linspace(-1.5, 1.5, 61)
OUT = r"no map reaches|would grow|must be a finite pose"
NONSENSE = [1e25, -1e300, 9.3e18, np.inf, np.nan]


def scan(ranges: np.ndarray | None = None, **changes: Any) -> LaserScan:
    values: dict[str, Any] = {"ranges": np.full(61, 2.0) if ranges is None else ranges, "bearings": BEARINGS}
    return LaserScan(**(values | {"range_min": 0.1, "range_max": 8.0} | changes))


def room() -> OccupancyMap:
    probability = np.full((60, 60), 0.1, np.float32)
    probability[[0, -1]] = probability[:, [0, -1]] = 0.9
    return OccupancyMap(probability, 0.1, (-3.0, -3.0))


@pytest.mark.parametrize("value", NONSENSE)
@pytest.mark.parametrize("place", [0, 1, 2])
@pytest.mark.parametrize("name", ENGINES)
def test_an_engine_refuses_odometry_out_of_this_world(name, place, value):
    engine = make_slam(name)
    engine.update(np.zeros(3), scan())
    odometry = np.zeros(3)
    odometry[place] = value
    with pytest.raises(InputError, match="`odometry`"):
        engine.update(odometry, scan())
    engine.update(np.zeros(3), scan())  # and goes on as if nothing had been said
    assert len(engine.trajectory()) == 2


@pytest.mark.parametrize("name", ENGINES)
def test_an_engine_refuses_a_jump_that_no_robot_makes(name):
    engine = make_slam(name)
    engine.update((5e6, 5e6, 0.0), scan())  # in the frame of a survey
    with pytest.raises(InputError, match="must not jump by more than 10000 m"):
        engine.update((0.0, 0.0, 0.0), scan())


@pytest.mark.parametrize("value", NONSENSE)
def test_localization_refuses_starts_and_odometry_out_of_this_world(value):
    with pytest.raises(InputError, match="`start`"):
        Localizer(room(), start=(value, 0.0, 0.0))
    with pytest.raises(InputError, match="`odometry`"):
        Localizer(room()).update((0.0, value, 0.0), scan())


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("range_max", 1e308),
        ("range_max", np.nan),
        ("range_min", np.nan),
        ("time_s", np.nan),
        ("time_s", 1e302),
        ("time_s", -np.inf),
        ("T_robot_lidar", (9.2e18, 0.0, 0.0)),
        ("T_robot_lidar", (0.0, np.nan, 0.0)),
        ("T_robot_lidar", (0.0, 0.0, 1e300)),
        ("T_robot_lidar", (0.0, 0.0)),
        ("bearings", np.linspace(-1e6, 1e6, 61)),
        ("bearings", np.arange(61) * 1e-300),
    ],
)
def test_a_scan_says_which_of_its_numbers_can_not_be(field, value):
    with pytest.raises(InputError, match=f"`{field}`"):
        scan(**{field: value})


def test_a_scan_has_no_more_beams_than_any_scanner():
    with pytest.raises(InputError, match=f"{MOST_BEAMS} beams"):
        LaserScan(np.ones(MOST_BEAMS + 1), np.linspace(-3.0, 3.0, MOST_BEAMS + 1), 0.0, 8.0)


@pytest.mark.parametrize("poses", [[[0, 0, 0], [1e300, 0, 0]], [[0, 0, 0], [2e4, 0, 0]], [[0, 0, np.nan], [0, 0, 0]]])
@pytest.mark.parametrize("field", ["odometry", "reference"])
def test_a_drive_names_the_scan_where_its_poses_go_wrong(field, poses):
    both: dict[str, Any] = {"odometry": np.zeros((2, 3)), "reference": None, field: np.array(poses, dtype=np.float64)}
    with pytest.raises(InputError, match=rf"`{field}` must .* scans? [01]"):
        RecordedDrive(scans=[scan(), scan()], name="a", **both)


@pytest.mark.parametrize("value", NONSENSE[:-1])
def test_feet_at_infinity_are_refused_and_missing_feet_are_not(value):
    drive, truth = RecordedDrive(np.zeros((1, 3)), [scan()], None, "a"), np.zeros((1, 3))
    assert np.isnan(SimulatedDrive(drive, truth, np.full((1, 2, 2), np.nan)).feet).all()
    with pytest.raises(InputError, match="`feet`"):
        SimulatedDrive(drive, truth, np.full((1, 2, 2), value))
    with pytest.raises(InputError, match="`people`"):
        dynamic_residue(common_cells(room(), room()), [[value, 0.0]])


@pytest.mark.parametrize(
    "changes",
    [
        {"resolution": 1e-9},
        {"resolution": 1e308},
        {"resolution": np.nan},
        {"origin": (np.inf, 0.0)},
        {"origin": (0.0, 1e25)},
        {"occupied_threshold": np.nan},
        {"free_threshold": 7.0},
    ],
)
def test_a_map_lies_somewhere_and_has_cells_of_some_size(changes):
    with pytest.raises(InputError, match=f"`{next(iter(changes))}`"):
        OccupancyMap(**({"probability": np.zeros((2, 2), np.float32), "resolution": 0.1, "origin": (0, 0)} | changes))


@pytest.mark.parametrize(
    ("engine", "setting", "value"),
    [
        ("gmapping", "particles", 1_000_000),
        ("gmapping", "particles", True),
        ("gmapping", "delta", 1e308),
        ("gmapping", "delta", np.nan),
        ("gmapping", "delta", 5e-324),
        ("gmapping", "srr", np.inf),
        ("gmapping", "threads", 100_000),
        ("gmapping", "matcher.windows", (40, 3)),
        ("gmapping", "matcher.samples", 10**12),
        ("cartographer", "local.insertion_voxel", 1e-9),
        ("cartographer", "local.submaps.submap.resolution", 1e-9),
        ("cartographer", "local.matcher.iterations", 10**9),
        ("cartographer", "global_.constraints.search_linear", 1e9),
        ("cartographer", "resolution", np.inf),
        ("ekf", "resolution", 1e-9),
        ("ekf", "cluster_distance", 1e300),
        ("ekf", "travel", np.nan),
    ],
)
def test_a_setting_that_would_take_all_time_or_memory_is_refused(engine, setting, value):
    with pytest.raises(InputError, match=f"`{setting.rpartition('.')[2]}` must be"):
        make_slam(engine, **{setting: value})


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("resolution", [1e-9, 0.0, np.nan, 1e300])
def test_a_map_is_drawn_in_cells_of_some_size_only(name, resolution):
    engine = make_slam(name)
    engine.update(np.zeros(3), scan())
    with pytest.raises(InputError, match="`resolution` must be within"):
        engine.map_at(resolution)


def test_a_search_of_more_poses_than_can_be_tried_is_refused():
    coarse: dict[str, Any] = {"local.submaps.submap.resolution": 5e-3, "local.matcher.max_linear": 10.0}
    engine = make_slam("cartographer", **coarse, **{"local.extrapolator.translation_floor": 9.0})
    engine.update(np.zeros(3), scan(range_max=8.0))
    with pytest.raises(InputError, match="`max_linear`"):
        engine.update((0.3, 0.0, 0.0), scan(np.linspace(2.0, 3.0, 61)))


@dataclass(frozen=True, kw_only=True)
class Settings:
    share: Annotated[float, Within(0.0, 1.0)] = 0.5
    pair: tuple[float, float] = (1.0, 2.0)
    some: Annotated[tuple[int, ...], Within(1, 9)] = (1, 2, 3)
    maybe: float | None = None
    text: str = "a"

    def __post_init__(self) -> None:
        check_numbers(self)


@pytest.mark.parametrize(
    ("field", "value", "rule"),
    [
        ("share", 1.5, r"within 0 \.\. 1, got 1\.5"),
        ("share", "x", "a number, got 'x'"),
        ("pair", (1.0, np.nan), "0 or of a size"),
        ("pair", (1.0,), "2 numbers"),
        ("pair", (1e-300, 1.0), "0 or of a size"),
        ("some", (1, 10), r"within 1 \.\. 9"),
        ("some", (1.5,), "a whole number"),
        ("maybe", -np.inf, "0 or of a size"),
    ],
)
def test_the_type_of_a_setting_holds_its_bounds(field, value, rule):
    assert Settings().maybe is None
    with pytest.raises(InputError, match=f"`{field}` must be {rule}"):
        Settings(**{field: value})


def test_an_error_shows_the_beginning_of_what_is_long_in_one_line():
    text = shown(["x" * 5000] * 3)
    assert len(text) < 100
    assert "\n" not in shown(np.arange(500.0))


@pytest.mark.parametrize("value", [1e25, -1e25, np.inf, np.nan])
def test_no_place_out_of_bounds_becomes_an_index(value):
    with pytest.raises(InputError, match="no map reaches"):
        cell_numbers(np.array([0.0, value]))
    grid = OccupancyGrid(GridConfig())
    with pytest.raises(InputError, match=OUT):
        grid.write((value, 0.0, 0.0), scan())
    with pytest.raises(InputError, match=OUT):
        render_map(np.array([[0.0, value, 0.0]]), [scan()])
    with pytest.raises(InputError, match=OUT):
        TileMaps(2, 0.05, 0.1, Workers(1)).write(
            np.array([[0, 0, 0], [value, 0, 0]]), np.ones((3, 2)), np.ones(3, bool)
        )


@pytest.mark.parametrize("name", MATCHERS)
def test_a_matcher_refuses_a_guess_out_of_this_world(name):
    with pytest.raises(InputError, match="`guess`"):
        make_matcher(name).match(scan(), scan(), (0.0, np.nan, 0.0))


def test_returns_that_all_lie_at_the_laser_match_nothing_and_divide_by_nothing():
    nothing = scan(np.zeros(61), range_min=0.0)
    assert not make_matcher("global").match(nothing, nothing, (0.0, 0.0, 0.0)).converged


def test_tracking_refuses_odometry_and_sightings_out_of_this_world():
    with pytest.raises(InputError, match="`odometry`"):
        PeopleFilter(detector=NoLegs()).update(scan(), (1e25, 0.0, 0.0))
    with pytest.raises(InputError, match="`positions`"):
        SeenPeople(0.0, np.array([[np.inf, 0.0]]), np.ones(1))


def test_scores_refuse_points_poses_and_times_out_of_this_world():
    far, near = np.array([[1e300, 0.0]]), np.zeros((1, 2))
    with pytest.raises(InputError, match="within 1e\\+07 m"):
        adnn(far, near)
    with pytest.raises(InputError, match="`reference`"):
        absolute_error(np.zeros((1, 3)), np.full((1, 3), 1e300))
    with pytest.raises(InputError, match="`times_s`"):
        Trajectory(np.array([np.nan]), np.zeros((1, 3)))
    with pytest.raises(InputError, match="would grow"):
        common_cells(room(), room(), (1e6, 0.0, 0.0))


def test_a_pose_is_three_numbers():
    for value in ("abc", [1.0, 2.0], None, [[1, 2, 3]], {"x": 1}):
        with pytest.raises(InputError, match="`odometry` must be"):
            checked_pose(value)
    assert checked_pose([1, 2, 3 * math.pi]).tolist() == [1.0, 2.0, 3 * math.pi]


@pytest.mark.parametrize("threads", [0, 65, 100_000])
def test_threads_are_as_many_as_a_machine_has(threads):
    with pytest.raises(InputError, match="`threads` must be within"):
        Workers(threads)


def test_memory_that_runs_out_is_told_in_one_line():
    with pytest.raises(InputError, match="no memory is left for the map: none"), memory_for("the map"):
        raise MemoryError("none")
