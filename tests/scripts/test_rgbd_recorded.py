"""What `bench rgbd-recorded` counts of one frame."""

from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.perception import PlaneFinder
from tagalong.perception.rgbd import Pinhole, RgbdFrame
from tagalong.scripts.benchmarks.rgbd_recorded import NEAR_M, Tally
from tagalong.scripts.training.rgbd_labels import FrameLabels
from tagalong.scripts.training.rgbd_recordings import boxes_of, cut_above

CAMERA = Pinhole(width=128, height=106, horizontal_fov=np.radians(70.0), vertical_fov=np.radians(60.0))
HEIGHT, PITCH = 0.8, np.radians(20.0)


def floor_alone():
    rays = CAMERA.rays
    down = rays[..., 0] * np.sin(PITCH) - rays[..., 2] * np.cos(PITCH)
    with np.errstate(divide="ignore"):
        depth = np.where(down > 0.0, HEIGHT / down, np.nan)
    return RgbdFrame(
        np.where(depth < 6.0, depth, np.nan).astype(np.float32), np.full((106, 128, 3), 128, np.uint8), CAMERA, 0.0
    )


@pytest.mark.parametrize("wrong_deg", [0.0, 2.0])
def test_a_reference_that_is_wrong_is_told_by_the_floor_being_off_it(wrong_deg):
    tilt = (PITCH + np.radians(wrong_deg), 0.0)
    frame = floor_alone()
    ahead = (CAMERA.rays @ (np.cos(PITCH), 0.0, np.sin(PITCH)) * frame.depth)[frame.depth < NEAR_M]
    labels = FrameLabels(True, False, HEIGHT, tilt, np.empty((0, 4)), "")
    tally = Tally()
    tally.add_floor(PlaneFinder().find(frame), labels)
    assert tally.tilt == pytest.approx([wrong_deg], abs=0.05)
    assert tally.off == pytest.approx([0.0], abs=0.001)
    assert tally.off_reference == pytest.approx([np.median(ahead) * np.sin(np.radians(wrong_deg))], abs=0.002)


def test_a_picture_cut_above_shows_its_other_pixels_at_the_same_places():
    whole = floor_alone()
    below = cut_above(whole, 26)
    assert below.depth.shape == below.colour.shape[:2] == (80, 128)
    points = [frame.camera.rays * frame.depth[..., None] for frame in (below, whole)]
    assert points[0] == pytest.approx(points[1][26:], nan_ok=True)


def test_boxes_of_people_move_up_with_what_is_cut_above():
    notes = {"floor_visible": True, "table_top_visible": False, "people_boxes_xyxy": [[10, 40, 30, 90]]}
    notes |= dict.fromkeys(("camera_height_m", "pitch_deg_nose_down", "roll_deg_left_up"))
    recorded = SimpleNamespace(name="a_1", frame=floor_alone(), notes=notes)
    assert boxes_of(recorded, 64, 26).tolist() == [[2.0, 4.0, 18.0, 35.0]]
