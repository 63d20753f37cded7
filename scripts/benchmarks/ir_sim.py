"""How many steps a second IR-SIM (Han et al., `pip install ir-sim`) makes beside ours, where it is installed."""

import contextlib
import io
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any

import numpy as np

WALKERS, BEAMS = 5, 360
NAME = f"IR-SIM, empty room, {WALKERS} bystanders, {BEAMS} beams"
_LEAST = 20  # steps before and in a measurement
_WORLD = f"""\
world: {{width: 20, height: 20, step_time: 0.1, sample_time: 0.1, collision_mode: stop}}
robot:
  kinematics: {{name: diff}}
  shape: {{name: circle, radius: 0.3}}
  state: [10, 10, 0]
  goal: [18, 18, 0]
  vel_min: [-0.5, -1.5]
  vel_max: [1.3, 1.5]
  sensors:
    - {{type: lidar2d, number: {BEAMS}, range_max: 30, angle_range: 4.712389, noise: true, std: 0.01, angle_std: 0.0}}
obstacle:
  - number: {WALKERS}
    kinematics: {{name: omni}}
    distribution: {{name: random, range_low: [1, 1, -3.14], range_high: [19, 19, 3.14]}}
    behavior: {{name: rvo, wander: true, range_low: [1, 1, -3.14], range_high: [19, 19, 3.14], vxmax: 1.3, vymax: 1.3}}
    shape: {{name: circle, radius: 0.25}}
"""
"""As many bystanders and beams as in our office, and no walls: what it can do at best."""


def ir_sim_speed(seconds: float) -> dict[str, float] | None:
    """Return steps a second by the processor's time and by the clock's; None where IR-SIM is not installed.

    Args:
        seconds: For how long to measure [s].
    """
    if find_spec("irsim") is None:
        return None
    import irsim  # pyright: ignore[reportMissingImports]

    with TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):  # it tells of windows it has not
        file = Path(folder) / "world.yaml"
        file.write_text(_WORLD, encoding="utf-8")
        env: Any = irsim.make(str(file), display=False, disable_all_plot=True, log_level="ERROR", seed=0)
        rng = np.random.default_rng(0)
        _step(env, rng, 0.0)
        steps, used, clock = _step(env, rng, seconds)
        env.end()
    return {"per_core": steps / used, "per_clock": steps / clock}


def _step(env: Any, rng: np.random.Generator, seconds: float) -> tuple[int, float, float]:
    """Step for `seconds` [s]; return how many steps, and the time of the processor and of the clock [s]."""
    steps, begun, used = 0, perf_counter(), process_time()
    while perf_counter() - begun < seconds or steps < _LEAST:
        env.step(rng.uniform((-0.5, -1.5), (1.3, 1.5)).reshape(2, 1))
        if env.done():
            env.reset()
        steps += 1
    return steps, process_time() - used, perf_counter() - begun
