import io
import struct
import zlib

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import transform_points
from tagalong.slam.logs.flat_yaml import read_flat_yaml
from tagalong.slam.logs.ros_map import read_ros_map, write_ros_map
from tagalong.slam.occupancy_map import OccupancyMap

GRID = OccupancyMap(np.array([[0.9, 0.1, np.nan], [0.5, 0.2, 0.8]], dtype=np.float32), 0.05, (-1.25, 3.5))
YAML = (
    "image: m.pgm\nresolution: 0.05\norigin: [-1.25, 3.5, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
)


@settings(deadline=None, max_examples=30)
@given(st.integers(1, 9), st.integers(1, 9), st.integers(0, 999))
def test_a_trinary_map_comes_back_as_it_was(tmp_path_factory, rows, cols, seed):
    path = tmp_path_factory.mktemp("map") / "map"
    probability = np.random.default_rng(seed).choice([0.0, 1.0, np.nan], (rows, cols)).astype(np.float32)
    write_ros_map(path, OccupancyMap(probability, 0.02, (-3.0, 4.5)))
    back = read_ros_map(path.with_suffix(".yaml"))
    np.testing.assert_array_equal(back.probability, probability)
    assert back.resolution == 0.02
    assert back.origin == (-3.0, 4.5)


def test_the_image_is_what_map_server_expects(tmp_path):
    write_ros_map(tmp_path / "map.pgm", GRID)
    # row 0 of a map is the lowest: the last of the image
    assert (tmp_path / "map.pgm").read_bytes() == b"P5\n3 2\n255\n" + bytes([205, 254, 0, 0, 254, 205])
    by_yaml = yaml.safe_load((tmp_path / "map.yaml").read_text())
    assert by_yaml == {
        "image": "map.pgm",
        "mode": "trinary",
        "resolution": 0.05,
        "origin": [-1.25, 3.5, 0],
        "negate": 0,
        "occupied_thresh": 0.65,
        "free_thresh": 0.196,
    }
    assert sorted(p.name for p in tmp_path.iterdir()) == ["map.pgm", "map.yaml"]


def test_text_images_comments_negation_and_block_lists_are_read(tmp_path):
    (tmp_path / "m.pgm").write_text("P2\n# made by hand\n2 1\n255\n0 254\n")
    (tmp_path / "m.yaml").write_text(
        '---\n# a map\nimage: "m.pgm"   # the image\nresolution: 0.1\norigin:\n  - -1.0\n  - 2\n- 0.0\n'
        "negate: true\noccupied_thresh: 0.65\nfree_thresh: 0.25\n"
    )
    grid = read_ros_map(tmp_path / "m.yaml")
    assert grid.probability.tolist() == [[0.0, 1.0]]
    assert grid.origin == (-1.0, 2.0)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("resolution: 0.05\n", "", "`resolution` needs a number, got nothing"),
        ("resolution: 0.05", "resolution: fine", "`resolution` needs a number, got 'fine'"),
        ("resolution: 0.05", "resolution: -1", r"m\.yaml: `resolution` must lie in \[0.001, 10\] m, got -1"),
        ("resolution: 0.05", "resolution: 0.000005", r"`resolution` must lie in \[0.001, 10\] m, got 5e-06"),
        ("resolution: 0.05", "resolution: 50", r"`resolution` must lie in \[0.001, 10\] m, got 50"),
        ("[-1.25, 3.5, 0.0]", "[-1.25, 3.5]", r"`origin` needs \[x, y, yaw\]"),
        ("[-1.25, 3.5, 0.0]", "[-1.25, 3.5, 0.3", r"m\.yaml:3: a list must end"),
        ("[-1.25, 3.5, 0.0]", "nowhere", "`origin` needs"),
        ("[-1.25, 3.5, 0.0]", "[nan, 3.5, 0.0]", r"m\.yaml: the key `origin` needs \[x, y, yaw\]"),
        ("free_thresh: 0.196", "free_thresh: 0.9", "free_thresh <= occupied_thresh"),
        ("negate: 0", "mode: fine", r"`mode` must be one of trinary, scale, raw, got 'fine'"),
        ("negate: 0", "negate: 0\nnegate: 1", r"m\.yaml:5: the key 'negate' comes twice"),
        ("negate: 0", "just words", r"m\.yaml:4: expected `key: value`"),
        ("image: m.pgm\n", "", "needs the key `image`"),
        ("m.pgm", "none.pgm", "none.pgm: cannot be read"),
        ("m.pgm", "m.yaml", r"m\.yaml: is no picture that can be read"),
        ("m.pgm", "cut.png", r"cut\.png: is no picture that can be read \("),
        ("m.pgm", "vast.png", r"vast\.png: a picture has at most 100000000 pixels here, got 20000 x 5001"),
        ("m.pgm", "cut.pgm", "the image is cut: needs 3 x 2 pixels, got 5"),
        ("m.pgm", "deep.pgm", "8-bit image"),
        ("m.pgm", "huge.pgm", "must be a PGM"),
        ("m.pgm", "pale.pgm", "whole numbers from 0 to the image's maximum 255, got '999'"),
        ("m.pgm", "far.pgm", "shades are whole numbers"),
    ],
)
@pytest.mark.filterwarnings("ignore::PIL.Image.DecompressionBombWarning")
def test_mistakes_are_named(tmp_path, old, new, message):
    (tmp_path / "m.pgm").write_bytes(b"P5\n3 2\n255\n" + bytes(6))
    (tmp_path / "cut.pgm").write_bytes(b"P5\n3 2\n255\n" + bytes(5))
    (tmp_path / "deep.pgm").write_bytes(b"P5\n3 2\n65535\n" + bytes(12))
    (tmp_path / "huge.pgm").write_bytes(b"P5\n" + b"9" * 5000 + b" 2\n255\n")
    picture = io.BytesIO()
    Image.fromarray(np.random.default_rng(0).integers(0, 256, (50, 50), np.uint8)).save(picture, "PNG")
    (tmp_path / "cut.png").write_bytes(picture.getvalue()[:1000])
    header = struct.pack(">II5B", 20_000, 5_001, 8, 0, 0, 0, 0)
    chunk = struct.pack(">I", 13) + b"IHDR" + header + struct.pack(">I", zlib.crc32(b"IHDR" + header))
    (tmp_path / "vast.png").write_bytes(picture.getvalue()[:8] + chunk + picture.getvalue()[33:])
    (tmp_path / "pale.pgm").write_text("P2\n3 2\n255\n0 1 2 3 4 999\n")
    (tmp_path / "far.pgm").write_text(f"P2\n3 2\n255\n0 1 2 3 4 {10**30}\n")
    assert YAML.count(old) == 1
    (tmp_path / "m.yaml").write_text(YAML.replace(old, new))
    with pytest.raises(InputError, match=message):
        read_ros_map(tmp_path / "m.yaml")


def test_flat_yaml_agrees_with_a_yaml_library_on_a_map_file(tmp_path):
    (tmp_path / "m.yaml").write_text(YAML)
    ours, theirs = read_flat_yaml(tmp_path / "m.yaml"), yaml.safe_load(YAML)
    assert list(ours) == list(theirs)
    assert ours["image"] == theirs["image"]
    assert [float(v) for v in ours["origin"]] == theirs["origin"]


SHADES = np.array([[0, 254, 205], [254, 100, 60]], dtype=np.uint8)
AS_READ = [[0.0, np.nan, 1.0], [1.0, 0.0, np.nan]]  # lowest row first


def pictured(path, picture, lines=""):
    """Return the map that a picture makes, with more lines of YAML."""
    picture.save(path / "m.png", "PNG")
    (path / "m.yaml").write_text(YAML.replace("m.pgm", "m.png") + lines)
    return read_ros_map(path / "m.yaml")


@pytest.mark.parametrize("mode", ["L", "RGB", "RGBA", "LA", "P", "I;16"])
def test_a_png_of_any_kind_is_read_as_the_pgm(tmp_path, mode):
    grey = Image.fromarray(SHADES)
    picture = Image.fromarray(SHADES.astype(np.uint16) * 257) if mode == "I;16" else grey.convert(mode)
    assert picture.mode == mode
    np.testing.assert_array_equal(pictured(tmp_path, picture).probability, np.array(AS_READ, dtype=np.float32))


@pytest.mark.parametrize("ending", ["bmp", "tif"])
def test_other_pictures_are_read_by_what_is_in_them(tmp_path, ending):
    Image.fromarray(SHADES).save(tmp_path / f"m.{ending}")
    (tmp_path / "m.yaml").write_text(YAML.replace("m.pgm", f"m.{ending}"))
    np.testing.assert_array_equal(read_ros_map(tmp_path / "m.yaml").probability, np.array(AS_READ, dtype=np.float32))


def test_nothing_is_known_where_a_picture_is_transparent(tmp_path):
    picture = Image.fromarray(SHADES).convert("RGBA")
    picture.putpixel((0, 0), (0, 0, 0, 0))
    picture.putpixel((1, 0), (254, 254, 254, 254))
    probability = pictured(tmp_path, picture, "mode: scale\n").probability
    assert np.isnan(probability[1]).tolist() == [True, True, False]
    assert np.isfinite(probability[0]).all()


def test_the_mode_scale_knows_shades_between_and_raw_knows_per_cents(tmp_path):
    picture = Image.fromarray(np.array([[0, 255, 100, 128]], dtype=np.uint8))
    scaled = pictured(tmp_path, picture, "mode: scale\n").probability[0]
    between = [((1 - shade / 255) - 0.196) / (0.65 - 0.196) for shade in (100, 128)]
    np.testing.assert_allclose(scaled, [1.0, 0.0, *between], rtol=1e-6)
    assert between[1] < between[0] < 1.0
    picture = Image.fromarray(np.array([[0, 37, 100, 101, 255]], dtype=np.uint8))
    np.testing.assert_allclose(pictured(tmp_path, picture, "mode: raw\n").probability[0], [0, 0.37, 1, np.nan, np.nan])
    (tmp_path / "m.yaml").write_text(YAML.replace("m.pgm", "m.png").replace("negate: 0", "negate: 1") + "mode: raw\n")
    np.testing.assert_allclose(read_ros_map(tmp_path / "m.yaml").probability[0], [np.nan, np.nan, np.nan, np.nan, 0.0])


@pytest.mark.parametrize("yaw", [0.4, -2.0, np.pi / 2, np.pi])
def test_a_map_that_is_turned_against_its_frame_is_drawn_along_it(tmp_path, yaw):
    rng = np.random.default_rng(4)
    probability = rng.choice([0.0, 1.0, np.nan], (30, 20)).astype(np.float32)
    probability = np.kron(probability, np.ones((3, 3), dtype=np.float32))
    write_ros_map(tmp_path / "m", OccupancyMap(probability, 0.05, (-1.25, 3.5)))
    text = (tmp_path / "m.yaml").read_text()
    (tmp_path / "m.yaml").write_text(text.replace("[-1.25, 3.5, 0]", f"[-1.25, 3.5, {yaw}]"))
    turned = read_ros_map(tmp_path / "m.yaml")
    rows, cols = np.mgrid[1:90:3, 1:60:3].reshape(2, -1)  # the middle cells of the squares of nine
    places = transform_points(np.array((-1.25, 3.5, yaw)), (np.stack((cols, rows), axis=-1) + 0.5) * 0.05)
    x, y = np.floor((places - turned.origin) / 0.05).astype(int).T
    np.testing.assert_array_equal(turned.probability[y, x], probability[rows, cols])
    assert abs(np.nansum(turned.probability) / np.nansum(probability) - 1.0) < 0.02


def test_a_map_that_would_be_too_large_when_it_is_turned_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("tagalong.slam.logs.ros_map.MOST_PIXELS", 7)
    write_ros_map(tmp_path / "m", GRID)
    text = (tmp_path / "m.yaml").read_text()
    (tmp_path / "m.yaml").write_text(text.replace("3.5, 0]", "3.5, 0.5]"))
    with pytest.raises(InputError, match="must have 7 cells at most, got 4 x 4 when it is turned"):
        read_ros_map(tmp_path / "m.yaml")
