"""What `tagalong bench joystick-calibration` measures."""

import math

import numpy as np
import pytest
from tagalong.scripts.benchmarks.joystick_calibration import driving_figures


def test_figures_of_a_drive_of_known_acceleration():
    time = np.arange(0.0, 20.0, 0.1)
    speed = 0.5 + 0.3 * np.sin(time)
    x = 0.5 * time + 0.3 * (1.0 - np.cos(time))
    figures = driving_figures(time, np.stack((x, np.zeros_like(x), np.zeros_like(x)), axis=-1))
    assert figures.acceleration_rms == pytest.approx(0.3 / math.sqrt(2.0), rel=0.1)
    assert figures.speed_95 == pytest.approx(float(np.quantile(speed, 0.95)), rel=0.05)
    assert figures.turn_acceleration_rms == 0.0
