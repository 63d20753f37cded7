"""How smooth the robot's motion was, from its true velocity."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from ...slam.geometry import wrap_angle
from .history import History, run_lengths

Array = NDArray[np.float64]

CUTOFF_HZ = 2.0
"""Cut-off of the low-pass before differentiating (Butterworth, 2nd order, forwards and backwards: no phase) [Hz]."""
MOVING_MPS = 0.05
"""Speed above which the robot moves [m/s]."""
WINDOW_S = 10.0
"""Length of the windows of motion for SPARC and LDLJ: figures of windows of unequal length do not compare [s]."""


def smoothness_metrics(history: History) -> dict[str, float]:
    """Return the figures of smoothness. Velocity is true, low-passed at 2 Hz without phase for jerk and acceleration.

    - `jerk_rms_mps3`, `turn_jerk_rms_rps3`: root mean square of the second difference of forward speed and turn rate.
    - `peak_acceleration_mps2`: of forward speed.
    - `sparc`, `ldlj`: medians over consecutive windows of 10 s; windows that are not in motion (above 0.05 m/s for
      four fifths of the time) do not count. Closer to zero is smoother, for both.
    - `stops`: times the robot came to rest; `heading_change_rad_per_m`: sum of heading changes over the path's length;
      `path_length_m`.
    """
    rate = 1.0 / history.step_s
    forward = low_pass(history.robot_velocity[:, 0], rate)
    turn = low_pass(history.robot_velocity[:, 2], rate)
    speed = np.linalg.norm(history.robot_velocity[:, :2], axis=1)
    path = float(np.sum(np.linalg.norm(np.diff(history.robot_pose[:, :2], axis=0), axis=1)))
    turned = float(np.sum(np.abs(wrap_angle(np.diff(history.robot_pose[:, 2])))))
    windows = _moving_windows(speed, round(WINDOW_S * rate))
    return {
        "jerk_rms_mps3": _jerk_rms(forward, rate),
        "turn_jerk_rms_rps3": _jerk_rms(turn, rate),
        "peak_acceleration_mps2": float(np.max(np.abs(np.diff(forward)), initial=0.0) * rate),
        "sparc": float(np.median([sparc(window, rate) for window in windows])) if windows else float("nan"),
        "ldlj": float(np.median([ldlj(window, rate) for window in windows])) if windows else float("nan"),
        "stops": float(sum(start > 0 for start, _ in run_lengths(speed < MOVING_MPS))),
        "heading_change_rad_per_m": turned / path if path > 0.0 else float("nan"),
        "path_length_m": path,
    }


def low_pass(values: Array, rate_hz: float) -> Array:
    """Return `values` (n,) below 2 Hz without phase shift; unchanged where the series is too short or too slow."""
    if rate_hz <= 2.0 * CUTOFF_HZ or len(values) < 12:
        return values
    return sosfiltfilt(butter(2, CUTOFF_HZ, fs=rate_hz, output="sos"), values)


def sparc(speed: Array, rate_hz: float, cutoff_hz: float = 10.0, threshold: float = 0.05) -> float:
    """Return the spectral arc length of `speed` (n,); Balasubramanian et al. 2015.

    Minus the length of the normalised amplitude spectrum from 0 to the last frequency below `cutoff_hz` whose
    amplitude is at least `threshold`; at most half of `rate_hz` can be seen. Zero padding to 2^(ceil(log2 n) + 4).
    """
    size = 2 ** (int(np.ceil(np.log2(len(speed)))) + 4)
    amplitude = np.abs(np.fft.rfft(speed, size))
    frequency = np.fft.rfftfreq(size, 1.0 / rate_hz)
    peak = amplitude.max()
    if peak <= 0.0:
        return float("nan")
    amplitude = amplitude[frequency <= cutoff_hz] / peak
    last = int(np.flatnonzero(amplitude >= threshold)[-1])
    steps = np.hypot(np.full(last, 1.0 / max(last, 1)), np.diff(amplitude[: last + 1]))
    return -float(np.sum(steps))


def ldlj(speed: Array, rate_hz: float) -> float:
    """Return the log dimensionless jerk of `speed` (n,): -ln(T^3 / v_peak^2 * integral of (d2v/dt2)^2 dt)."""
    jerk = np.diff(speed, 2) * rate_hz**2
    peak = float(np.max(np.abs(speed)))
    energy = float(np.sum(jerk**2)) / rate_hz
    if peak <= 0.0 or energy <= 0.0:
        return float("nan")
    return -float(np.log((len(speed) / rate_hz) ** 3 / peak**2 * energy))


def _moving_windows(speed: Array, length: int) -> list[Array]:
    whole = [speed[start : start + length] for start in range(0, len(speed) - length + 1, length)]
    return [window for window in whole if np.mean(window > MOVING_MPS) >= 0.8]


def _jerk_rms(velocity: Array, rate_hz: float) -> float:
    if len(velocity) < 3:
        return float("nan")
    return float(np.sqrt(np.mean((np.diff(velocity, 2) * rate_hz**2) ** 2)))
