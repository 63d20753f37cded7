"""RGB-D frames out of ROS 1 and ROS 2 bags, as drivers record them."""

import numpy as np
import pytest
from camera_bags import OPTICAL, CameraBag, compressed_depth, png
from tagalong.perception.rgbd import Pinhole, read_bag_frames
from tagalong.perception.rgbd.bag_topics import CameraTopics
from tagalong.perception.rgbd.registration import registered_colour
from tagalong.slam import InputError

RNG = np.random.default_rng(0)
DEPTH = np.where(RNG.random((60, 80)) < 0.2, 0, RNG.integers(400, 9000, (60, 80))).astype(np.uint16)
COLOUR = RNG.integers(0, 256, (60, 80, 3), dtype=np.uint8)
METRES = np.where(DEPTH > 0, DEPTH * np.float32(1e-3), np.nan)
START_S = 1.5e9


def write_depth(bag, how, time_s=START_S, topic="/cam/depth/image_raw", frame=OPTICAL):
    if how == "16UC1":
        bag.image(topic, time_s, DEPTH, how, frame, step=176)
    elif how == "raw 32FC1":
        bag.image(topic, time_s, METRES.astype(np.float32), "32FC1", frame)
    else:
        bag.compressed(f"{topic}/compressedDepth", time_s, *compressed_depth(DEPTH, how), frame)


@pytest.mark.parametrize("ros1", [True, False])
@pytest.mark.parametrize("how", ["16UC1", "raw 32FC1", "png", "rvl", "32FC1"])
def test_depth_of_all_kinds_is_read_to_the_pixel(tmp_path, ros1, how):
    with CameraBag(tmp_path / "it", ros1=ros1) as bag:
        bag.info("/cam/depth/camera_info", START_S, (80, 60))
        write_depth(bag, how)
    (found,) = read_bag_frames(tmp_path / "it")
    np.testing.assert_array_equal(np.isnan(found.frame.depth), DEPTH == 0)
    # inverse depth of 16 bit, scale 10100: half a step is 0.5 z^2 / 10100
    tolerance = 0.6 / 10100 * 81.0 if how == "32FC1" else 1e-6
    np.testing.assert_allclose(found.frame.depth, METRES, atol=tolerance)
    assert found.frame.camera.focal == pytest.approx((140.0, 140.0))
    assert found.frame.camera.axis == pytest.approx((40.0, 30.0))
    assert found.frame.time_s == pytest.approx(START_S)
    assert found.notes["colour"] == "none"


def test_an_mcap_file_alone_is_a_bag_too(tmp_path):
    with CameraBag(tmp_path / "it", ros1=False) as bag:
        bag.info("/cam/depth/camera_info", START_S, (80, 60))
        write_depth(bag, "png")
    assert len(list(read_bag_frames(next((tmp_path / "it").glob("*.mcap"))))) == 1


@pytest.mark.parametrize("encoding", ["rgb8", "bgr8", "bgra8", "compressed"])
def test_colour_of_the_same_camera_is_taken_as_it_is_and_from_the_nearest_picture(tmp_path, encoding):
    with CameraBag(tmp_path / "it") as bag:
        bag.info("/cam/depth/camera_info", START_S, (80, 60))
        for time_s, pixels in ((START_S - 0.03, 255 - COLOUR), (START_S + 0.01, COLOUR)):
            if encoding == "compressed":
                bag.compressed("/cam/rgb/image_raw/compressed", time_s, "bgr8; png compressed bgr8", png(pixels))
            else:
                order = (0, 1, 2) if encoding == "rgb8" else (2, 1, 0) if encoding == "bgr8" else (2, 1, 0, 0)
                bag.image("/cam/rgb/image_raw", time_s, pixels[..., order], encoding)
            if time_s < START_S:
                write_depth(bag, "16UC1")
    (found,) = read_bag_frames(tmp_path / "it")
    np.testing.assert_array_equal(found.frame.colour, COLOUR)
    assert found.notes["colour"] == "aligned"


def test_colour_of_another_moment_is_left_out(tmp_path):
    with CameraBag(tmp_path / "it") as bag:
        bag.info("/cam/depth/camera_info", START_S, (80, 60))
        write_depth(bag, "16UC1")
        bag.image("/cam/rgb/image_raw", START_S + 0.5, COLOUR, "rgb8")
    (found,) = read_bag_frames(tmp_path / "it")
    assert found.notes["colour"] == "none"


def test_colour_of_a_camera_beside_it_is_brought_over_by_tf(tmp_path):
    wall = np.full((60, 80), 2000, np.uint16)
    with CameraBag(tmp_path / "it", ros1=False) as bag:
        bag.transform(START_S, "rig", "depth_optical", (0.0, 0.0, 0.0))
        bag.transform(START_S, "rig", "colour_optical", (0.1, 0.0, 0.0))  # to the right
        bag.info("/cam/depth/camera_info", START_S, (80, 60))
        bag.info("/cam/rgb/camera_info", START_S, (80, 60))
        bag.image("/cam/depth/image_raw", START_S, wall, "16UC1", "depth_optical")
        bag.image("/cam/rgb/image_raw", START_S, COLOUR, "rgb8", "colour_optical")
    (found,) = read_bag_frames(tmp_path / "it")
    assert found.notes["colour"] == "registered"
    # at 2 m, 0.1 m to the right are 7 pixels of 140
    np.testing.assert_array_equal(found.frame.colour[:, 7:], COLOUR[:, :-7])
    assert (found.frame.colour[:, :7] == 128).all()


def test_distortion_of_the_colour_camera_counts():
    camera = Pinhole.from_intrinsics((80, 60), (140.0, 140.0), (39.5, 29.5))
    bent = Pinhole.from_intrinsics((80, 60), (140.0, 140.0), (39.5, 29.5), (0.5, 0.0, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0))
    depth = np.full((60, 80), np.nan, np.float32)
    depth[30, 70] = 1.0
    colour = np.zeros((60, 80, 3), np.uint8)
    x, y = 30.5 / 140.0, 0.5 / 140.0
    factor = (1.0 + 0.5 * (x * x + y * y)) / (1.0 + 0.1 * (x * x + y * y))
    colour[int(30.0 + 140.0 * y * factor), int(40.0 + 140.0 * x * factor)] = 200
    assert (registered_colour(depth, camera, colour, bent, np.eye(4))[30, 70] == 200).all()
    row, col = 30, 70
    right, below = -bent.rays[row, col, 1], -bent.rays[row, col, 2]
    r2 = right * right + below * below
    assert right * (1.0 + 0.5 * r2) / (1.0 + 0.1 * r2) == pytest.approx(x, abs=1e-9)


def test_intrinsics_shrink_with_pictures_that_were_shrunk(tmp_path):
    with CameraBag(tmp_path / "it") as bag:
        bag.info("/cam/depth/camera_info", START_S, (160, 120), focal=280.0)
        write_depth(bag, "16UC1")
    (found,) = read_bag_frames(tmp_path / "it")
    assert found.frame.camera.focal == pytest.approx((140.0, 140.0))
    assert found.frame.camera.axis == pytest.approx((40.0, 30.0))


def test_frames_that_follow_too_soon_are_left_out(tmp_path):
    with CameraBag(tmp_path / "it") as bag:
        bag.info("/cam/depth/camera_info", START_S, (80, 60))
        for number in range(10):
            write_depth(bag, "16UC1", START_S + 0.1 * number)
    assert [each.name for each in read_bag_frames(tmp_path / "it", every_s=0.3)] == [
        "000000", "000003", "000006", "000009"
    ]  # fmt: skip


def test_depth_registered_to_colour_is_taken_before_other_depth_and_infrared_is_none(tmp_path):
    with CameraBag(tmp_path / "it") as bag:
        for topic, frame in (("/cam/depth", "depth"), ("/cam/aligned_depth_to_color", "colour"), ("/cam/ir", "ir")):
            bag.info(f"{topic}/camera_info", START_S, (80, 60), frame=frame)
            write_depth(bag, "16UC1", topic=f"{topic}/image_raw", frame=frame)
        bag.image("/cam/color/image_raw", START_S, COLOUR, "rgb8", "colour")
    (found,) = read_bag_frames(tmp_path / "it")
    assert found.notes["depth_topic"] == "/cam/aligned_depth_to_color/image_raw"
    (found,) = read_bag_frames(tmp_path / "it", CameraTopics(depth="/cam/depth/image_raw"))
    assert found.notes["depth_topic"] == "/cam/depth/image_raw"


def damaged(bag, what):
    if what != "info":
        model = "equidistant" if what == "model" else "plumb_bob"
        size = (100, 60) if what == "shape" else (80, 60)
        bag.info("/cam/depth/camera_info", START_S, size, model, (0.1, 0.0, 0.0, 0.0))
    if what == "two":
        for name in ("/left/depth/image", "/right/depth/image"):
            write_depth(bag, "16UC1", topic=name)
    elif what in ("png", "rvl"):
        said, data = compressed_depth(DEPTH, what)
        bag.compressed("/cam/depth/image_raw/compressedDepth", START_S, said, data[: len(data) // 2])
    elif what == "header":
        bag.compressed("/cam/depth/image_raw/compressedDepth", START_S, "16UC1; compressedDepth", b"abc")
    elif what == "depth":
        bag.image("/cam/rgb/image_raw", START_S, COLOUR, "rgb8")
    else:
        write_depth(bag, "16UC1")


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ("info", "no camera_info"),
        ("model", "equidistant"),
        ("shape", "100 x 60"),
        ("two", "--depth-topic"),
        ("png", "no picture"),
        ("rvl", "RVL"),
        ("header", "12 bytes"),
        ("depth", "no topic of depth"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(tmp_path, what, words):
    with CameraBag(tmp_path / "it") as bag:
        damaged(bag, what)
    with pytest.raises(InputError, match=words) as error:
        list(read_bag_frames(tmp_path / "it"))
    assert "\n" not in str(error.value)
