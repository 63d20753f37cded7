"""Small valid texts of each format, drawn anew every time; mutations make them hostile."""

import io

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from PIL import Image


def _words(values: np.ndarray, digits: int = 3) -> str:
    return " ".join(f"{value:.{digits}f}" for value in np.asarray(values).ravel())


def poses(rng: Generator, count: int) -> np.ndarray:
    """Return (count, 3) poses of a drive in steps of some decimetres."""
    return np.cumsum(rng.normal(0.0, (0.3, 0.3, 0.2), (count, 3)), axis=0)


def ranges(rng: Generator, count: int, farthest: float = 8.0) -> np.ndarray:
    """Return (count,) distances to smooth walls."""
    return np.clip(rng.uniform(1.0, farthest) + np.cumsum(rng.normal(0.0, 0.1, count)), 0.3, farthest)


def carmen(rng: Generator) -> bytes:
    """Return a CARMEN log of 1 to 5 scans with FLASER, ROBOTLASER1, ODOM and PARAM lines."""
    lines, beams = ["# message_name n", "PARAM robot_frontlaser_offset 0.1"], int(rng.integers(1, 24))
    new = rng.random() < 0.4
    for k, pose in enumerate(poses(rng, int(rng.integers(1, 6)))):
        p, r = _words(pose), _words(ranges(rng, beams))
        if rng.random() < 0.3:
            lines.append(f"ODOM {p} 0.1 0.0 0.0 {k} h {k}")
        if new:
            lines.append(f"ROBOTLASER1 0 -1.57 3.14 0.1 8.1 0.01 0 {beams} {r} 0 {p} {p} 0.1 0 0.5 0.5 1e9 {k} h {k}")
        else:
            lines.append(f"FLASER {beams} {r} {p} {p} {k} h {k}")
    return "\n".join(lines).encode() + b"\n"


def beesoft(rng: Generator) -> bytes:
    """Return a BeeSoft log of 1 to 3 scans."""
    lines = []
    for k, pose in enumerate(poses(rng, int(rng.integers(1, 4)))):
        p = _words(pose * (100.0, 100.0, 1.0))
        lines += [f"O {p} {k}", f"L {p} {p} {_words(100.0 * ranges(rng, 180), 0)} {k}"]
    return "\n".join(lines).encode() + b"\n"


def beesoft_map(rng: Generator) -> bytes:
    """Return a small BeeSoft map."""
    rows, cols = (int(n) for n in rng.integers(1, 8, 2))
    cells = [_words(rng.choice([-1.0, 0.0, 0.5, 1.0], cols), 2) for _ in range(rows)]
    head = ["robot_specifications->resolution 10", f"global_map[0]: {rows} {cols}"]
    return "\n".join([*head, *cells]).encode() + b"\n"


def dpslam(rng: Generator) -> bytes:
    """Return a DP-SLAM log of 1 to 4 scans."""
    lines, beams = [], int(rng.integers(2, 30))
    for pose in poses(rng, int(rng.integers(1, 5))):
        lines += [f"Odometry {_words(pose)}", f"Laser {beams} {_words(ranges(rng, beams))}"]
    return "\n".join(lines).encode() + b"\n"


def tinyslam(rng: Generator) -> bytes:
    """Return a tinySLAM log of 1 or 2 scans, of either layout."""
    lines, long = [], rng.random() < 0.5
    for k in range(int(rng.integers(1, 3))):
        head = [f"{k}00000", "0", f"{90 * k}", f"{100 * k}", *["0"] * 20] if long else [f"{k}00000", *["0"] * 11]
        lines.append(" ".join([*head, _words(1e3 * ranges(rng, 683, 5.0), 0)]))
    return "\n".join(lines).encode() + b"\n"


def tum(rng: Generator) -> bytes:
    """Return a trajectory of 1 to 6 poses."""
    rows = poses(rng, int(rng.integers(1, 7)))
    lines = [f"{k} {x:.3f} {y:.3f} 0 0 0 {np.sin(t / 2):.9f} {np.cos(t / 2):.9f}" for k, (x, y, t) in enumerate(rows)]
    return "\n".join(["# t x y z qx qy qz qw", *lines]).encode() + b"\n"


def relations(rng: Generator) -> bytes:
    """Return relations by time or by reading."""
    long, lines = rng.random() < 0.5, []
    for k, pose in enumerate(poses(rng, int(rng.integers(1, 6)))):
        x, y, turn = pose
        lines.append(
            f"{k} {k + 1} {x:.3f} {y:.3f} 0 0 0 {turn:.3f}" if long else f"{k} {k + 1} {x:.3f} {y:.3f} {turn:.3f}"
        )
    return "\n".join(lines).encode() + b"\n"


def readings(rng: Generator) -> bytes:
    """Return the odometry of readings."""
    rows = poses(rng, int(rng.integers(1, 8)))
    return "\n".join(f"{k} {0.5 * k} {0.5 * k} {_words(pose)}" for k, pose in enumerate(rows)).encode() + b"\n"


def g2o(rng: Generator) -> bytes:
    """Return a pose graph of 1 to 6 poses and a loop."""
    rows = poses(rng, int(rng.integers(1, 7)))
    lines = [f"VERTEX_SE2 {k} {_words(pose)}" for k, pose in enumerate(rows)]
    ends = [(k, k + 1) for k in range(len(rows) - 1)] + [(0, len(rows) - 1)]
    lines += [f"EDGE_SE2 {i} {j} {_words(rng.normal(0, 0.3, 3))} 44 0 0 44 0 400" for i, j in ends]
    return "\n".join([*lines, "FIX 0"]).encode() + b"\n"


def pedestrians(rng: Generator) -> bytes:
    """Return walks of 1 to 3 people, in either form."""
    lines, long = [], rng.random() < 0.5
    for person in range(int(rng.integers(1, 4))):
        for k, (x, y, _) in enumerate(poses(rng, int(rng.integers(6, 12)))):
            lines.append(
                f"{10 * k} {person} {x:.3f} 0 {y:.3f} 0.1 0 0.1" if long else f"{10 * k} {person} {x:.3f} {y:.3f}"
            )
    return "\n".join(lines).encode() + b"\n"


def map_yaml(rng: Generator) -> bytes:
    """Return the YAML file of a ROS map."""
    yaw = 0 if rng.random() < 0.7 else round(float(rng.normal()), 2)
    listed = f"[0.0, -1.5, {yaw}]" if rng.random() < 0.7 else f"\n- 0.0\n- -1.5\n- {yaw}"
    mode = rng.choice(["trinary", "trinary", "scale", "raw"])
    lines = ["image: map.pgm", f"mode: {mode}", "resolution: 0.05", f"origin: {listed}", "negate: 0"]
    return "\n".join([*lines, "occupied_thresh: 0.65", "free_thresh: 0.196 # as map_server"]).encode() + b"\n"


def map_image(rng: Generator, side: int = 12) -> bytes:
    """Return a picture of a room: a PGM, binary or text, or a PNG."""
    rows, cols = (int(n) for n in rng.integers(3, side, 2))
    shades = np.full((rows, cols), 254, dtype=np.uint8)
    shades[[0, -1]], shades[:, [0, -1]] = 0, 0
    shades[rng.random((rows, cols)) < 0.1] = 205
    if rng.random() < 0.2:
        return _png(shades, str(rng.choice(["L", "RGBA", "P"])))
    if rng.random() < 0.6:
        return f"P5\n# a room\n{cols} {rows}\n255\n".encode() + shades.tobytes()
    return f"P2\n{cols} {rows}\n255\n{_words(shades, 0)}\n".encode()


def _png(shades: NDArray[np.uint8], mode: str) -> bytes:
    file = io.BytesIO()
    Image.fromarray(shades).convert(mode).save(file, "PNG")
    return file.getvalue()


def straight_walks(rng: Generator) -> bytes:
    """Return walks of 1 to 3 people along the first axis, at a walking pace."""
    lines = []
    for person in range(int(rng.integers(1, 4))):
        pace = rng.uniform(0.3, 0.6)
        lines += [f"{10 * k} {person} {pace * k:.3f} {0.3 * person:.3f}" for k in range(int(rng.integers(10, 20)))]
    return "\n".join(lines).encode() + b"\n"


def floor_plan(rng: Generator) -> bytes:
    """Return a PGM of a hall with a pillar, large enough to walk about at 0.1 m a pixel."""
    rows, cols = (int(n) for n in rng.integers(100, 180, 2))
    shades = np.full((rows, cols), 254, dtype=np.uint8)
    shades[[0, -1]], shades[:, [0, -1]] = 0, 0
    shades[rows // 2 : rows // 2 + 9, cols // 2 : cols // 2 + 9] = 0
    return f"P5\n{cols} {rows}\n255\n".encode() + shades.tobytes()


def joystick(rng: Generator) -> bytes:
    """Return a joystick log of some commands."""
    steps = int(rng.integers(0, 60))
    moves = sorted({int(k) for k in rng.integers(0, max(steps, 1), int(rng.integers(0, 8)))}) if steps else []
    head = ["tagalong joystick log 1", "made by: keyboard", "env: tagalong/Corridor-v0", 'kwargs: {"slam": null}']
    head += [f"seed: {int(rng.integers(9))}", "step_s: 0.1", f"steps: {steps}", "step forward turn"]
    return "\n".join([*head, *(f"{k} {_words(rng.uniform(-1, 1, 2), 4)}" for k in moves)]).encode() + b"\n"
