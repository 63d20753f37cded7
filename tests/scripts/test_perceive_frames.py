"""A folder of RGB-D frames, as `tagalong perceive` and `tagalong bench rgbd-recorded` take it."""

import csv
import json

import numpy as np
import pytest
from camera_bags import CameraBag, compressed_depth
from PIL import Image
from tagalong.perception.rgbd import read_frames
from tagalong.scripts.cli import main
from tagalong.slam import InputError

PITCH, HEIGHT, SIZE, FOCAL = np.radians(15.0), 1.2, (160, 120), 140.0
INTRINSICS = {"width": 160, "height": 120, "fx": FOCAL, "fy": FOCAL, "cx": 79.5, "cy": 59.5}
LABELS = {
    "camera_height_m": HEIGHT,
    "pitch_deg_nose_down": 15.0,
    "roll_deg_left_up": 0.0,
    "floor_visible": True,
    "table_top_visible": False,
    "people": 1,
    "people_boxes_xyxy": [[60, 0, 100, 119]],
}


def depths(floor=True):
    """Millimetres of a floor before a wall at 5 m, seen by a camera whose nose is 15 degrees down."""
    down = (np.arange(120) + 0.5 - 60.0) / FOCAL
    level, below = np.cos(PITCH) - np.sin(PITCH) * down, np.sin(PITCH) + np.cos(PITCH) * down
    depth = 5.0 / level
    if floor:
        depth = np.where(below > 0.0, np.minimum(depth, HEIGHT / np.maximum(below, 1e-6)), depth)
    return np.repeat((1000.0 * depth)[:, None], 160, axis=1).astype(np.uint16)


def write(folder, name, depth, **notes):
    folder.mkdir(exist_ok=True)
    Image.fromarray(depth).save(folder / f"{name}_depth.png")
    Image.fromarray(np.full((120, 160, 3), 90, np.uint8)).save(folder / f"{name}.png")
    (folder / f"{name}.json").write_text(json.dumps({**INTRINSICS, **notes}))


def rows_of(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_a_folder_of_frames_gives_planes_people_mounts_overlays_and_a_report(tmp_path, capsys):
    write(tmp_path / "in", "a", depths(), time_s=0.0)
    write(tmp_path / "in", "b", depths(floor=False), time_s=0.5)
    out = tmp_path / "out"
    assert main(["perceive", str(tmp_path / "in"), "--out", str(out), "--sequence"]) == 0
    first, second = rows_of(out / "mounts.csv")
    assert (first["floor"], second["floor"]) == ("seen", "held")
    assert float(first["height_m"]) == pytest.approx(HEIGHT, abs=0.02)
    assert float(first["pitch_deg"]) == pytest.approx(15.0, abs=0.3)
    assert second["height_m"] == first["height_m"]
    assert float(second["sd_pitch_deg"]) > float(first["sd_pitch_deg"])
    floor = next(row for row in rows_of(out / "planes.csv") if row["kind"] == "floor")
    assert float(floor["nz"]) == pytest.approx(1.0, abs=0.01)
    assert (out / "people.csv").read_text() == "frame,x,y,distance_m,likelihood,floor_known\n"
    with Image.open(out / "overlays" / "a.png") as picture:
        assert picture.size == (640, 480)
    assert "a      seen" in (out / "report.txt").read_text()
    assert json.loads((out / "config.json").read_text())["planes"]["noise"]["quadratic"] == 0.0014
    capsys.readouterr()
    alone = ["perceive", str(tmp_path / "in"), "--out", str(out), "--no-overlays"]
    assert main(alone) == 0
    assert rows_of(out / "mounts.csv")[1]["floor"] == "unknown"
    assert main([*alone, "--camera-height", "1.2", "--camera-tilt", "15", "0"]) == 0
    assert rows_of(out / "mounts.csv")[1]["floor"] == "held"


def test_one_camera_file_serves_all_and_depths_may_be_metres_of_an_npy(tmp_path):
    (tmp_path / "camera.json").write_text(json.dumps({**INTRINSICS, "principal_point": "pixel edges"}))
    np.save(tmp_path / "x_depth.npy", depths().astype(np.float32) / 1000.0)
    Image.fromarray(depths()).save(tmp_path / "y_depth.png")
    npy, png = (recorded.frame for recorded in read_frames(tmp_path))
    assert npy.depth == pytest.approx(png.depth, abs=1e-3)
    assert npy.camera.axis == (79.5, 59.5)
    assert (npy.colour == 128).all()
    assert npy.camera_height is None


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda place: (place / "a_depth.png").unlink(), "holds no frame"),
        (lambda place: (place / "a.json").unlink(), "write a.json or camera.json"),
        (lambda place: (place / "a.json").write_text('{"width": 160}'), "`height` must be a finite number, got None"),
        (lambda place: (place / "a.json").write_text("[]"), "must be an object"),
        (lambda place: (place / "a_depth.png").write_bytes(b"none"), "is no picture that can be read"),
        (lambda place: (place / "a.json").write_text(json.dumps({**INTRINSICS, "fx": -1.0})), "`fx` must be positive"),
        (lambda place: (place / "a.json").write_text(json.dumps({**INTRINSICS, "height": 99})), "must have shapes"),
        (
            lambda place: (place / "a.json").write_text(json.dumps({**INTRINSICS, "distortion": "no"})),
            "list of finite numbers",
        ),
        (
            lambda place: (place / "a.json").write_text(json.dumps({**INTRINSICS, "time_s": 10**400})),
            "`time_s` must be a finite number",
        ),
        (lambda place: Image.new("RGB", (160, 120)).save(place / "a_depth.png"), "one channel of 16 bit, got mode RGB"),
    ],
)
def test_what_is_wrong_with_a_folder_is_told_in_one_line(tmp_path, capsys, spoil, words):
    write(tmp_path / "in", "a", depths())
    spoil(tmp_path / "in")
    assert main(["perceive", str(tmp_path / "in"), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("words", ["--camera-height nan", "--camera-height -1", "--camera-tilt 100 0"])
def test_mounts_that_cannot_be_are_refused(tmp_path, capsys, words):
    write(tmp_path / "in", "a", depths())
    assert main(["perceive", str(tmp_path / "in"), "--out", str(tmp_path / "out"), *words.split()]) == 2
    assert words.split()[0] in capsys.readouterr().err


def test_a_recording_of_frames_is_refused_as_there_is_none(tmp_path, capsys):
    write(tmp_path / "in", "a", depths())
    words = ["perceive", str(tmp_path / "in"), "--out", str(tmp_path / "out"), "--record", str(tmp_path / "a.mcap")]
    assert main(words) == 2
    assert "--record is for scans" in capsys.readouterr().err


def test_an_array_of_depths_that_says_it_has_gigabytes_is_refused_before_room_is_made(tmp_path, capsys):
    write(tmp_path / "in", "a", depths())
    (tmp_path / "in" / "a_depth.png").unlink()
    np.save(tmp_path / "in" / "a_depth.npy", depths().astype(np.float32))
    array = tmp_path / "in" / "a_depth.npy"
    array.write_bytes(array.read_bytes().replace(b"(120, 160), }    ", b"(12000000, 160), }", 1))
    assert main(["perceive", str(tmp_path / "in"), "--out", str(tmp_path / "out")]) == 2
    assert "states (12000000, 160)" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("floor_visible", "left out", "`floor_visible` must be true or false"),
        ("people_boxes_xyxy", [[1]], "boxes of four numbers"),
        ("roll_deg_left_up", None, "pitch and roll must be numbers"),
        ("camera_height_m", "x", "`camera_height_m` must be a number within 100"),
    ],
)
def test_a_label_that_is_none_is_named_with_its_frame(tmp_path, capsys, name, value, words):
    labels = {key: said for key, said in {**LABELS, name: value}.items() if said != "left out"}
    write(tmp_path / "in", "one_a", depths(), **labels)
    assert main(["bench", "rgbd-recorded", str(tmp_path / "in"), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert "one_a.json: " in error
    assert words in error


def test_more_columns_than_any_camera_has_are_refused(tmp_path, capsys):
    write(tmp_path / "in", "one_a", depths(), **LABELS)
    words = ["bench", "rgbd-recorded", str(tmp_path / "in"), "--out", str(tmp_path / "out")]
    assert main([*words, "--columns", "8193"]) == 2
    assert "--columns: must be at most 8192" in capsys.readouterr().err


def test_labelled_frames_are_scored_by_source(tmp_path, capsys):
    write(tmp_path / "in", "one_a", depths(), **LABELS)
    blind = {"camera_height_m": None, "floor_visible": False, "people": 0, "people_boxes_xyxy": []}
    write(tmp_path / "in", "two_a", depths(floor=False), **{**LABELS, **blind})
    words = ["bench", "rgbd-recorded", str(tmp_path / "in"), "--out", str(tmp_path / "out"), "--columns", "80"]
    assert main(words) == 0
    printed = capsys.readouterr().out
    assert [line.split()[0] for line in printed.splitlines()[2:]] == ["one", "two", "all"]
    sources = json.loads((tmp_path / "out" / "results.json").read_text())["sources"]
    assert (sources["one"]["recognised"], sources["one"]["floors"], sources["two"]["floors"]) == (1, 1, 0)
    assert sources["one"]["tilt"][0] < 0.5
    assert sources["one"]["recall"][0] > 0.95
    assert sources["one"]["precision"][0] > 0.98
    assert (sources["one"]["people"], sources["one"]["found"], sources["two"]["false_floors"]) == (1, 0, 0)


def test_a_folder_that_is_none_is_told(tmp_path):
    with pytest.raises(InputError, match="is no folder of frames"):
        next(read_frames(tmp_path / "nowhere"))


def test_a_bag_of_a_camera_gives_what_a_folder_gives(tmp_path, capsys):
    with CameraBag(tmp_path / "camera.bag") as bag:
        bag.info("/cam/depth/camera_info", 100.0, SIZE)
        for time_s, floor in ((100.0, True), (100.2, True), (100.6, False)):
            bag.compressed("/cam/depth/image_raw/compressedDepth", time_s, *compressed_depth(depths(floor), "rvl"))
    out = tmp_path / "out"
    assert main(["perceive", str(tmp_path / "camera.bag"), "--out", str(out)]) == 0
    first, second = rows_of(out / "mounts.csv")
    assert (first["frame"], second["frame"]) == ("000000", "000002")
    assert (first["floor"], second["floor"]) == ("seen", "held")
    assert float(first["pitch_deg"]) == pytest.approx(15.0, abs=0.3)
    assert main(["perceive", str(tmp_path / "camera.bag"), "--out", str(out), "--every", "nan"]) == 2
    assert main(["perceive", str(tmp_path / "camera.bag"), "--out", str(out), "--depth-topic", "/nix"]) == 2
    assert "/cam/depth/image_raw/compressedDepth" in capsys.readouterr().err
