"""What a measurement was made with."""

import hashlib
import platform
import sys
import time
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from ... import __version__

_ROOMS = ("slam", "perception", "envs", "agents", "scripts")
_DECIDING = (".py", ".npz", ".json", ".onnx", ".safetensors")
_PACKAGES = ("gymnasium", "mujoco", "numpy", "scipy", "scikit-learn", "numba")


def describe_machine() -> dict[str, Any]:
    """Return processor, cores, Python and versions of what decides speed and results."""
    return {
        "processor": _processor(),
        "cores": joblib_cores(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": sys.version.split()[0],
        "tagalong": __version__,
        "packages": {name: _version(name) for name in _PACKAGES},
    }


@cache
def code_fingerprint() -> str:
    """Return 16 hexadecimal digits that change with any byte of the package's code or of the models it ships."""
    package, digest = Path(__file__).parents[2], hashlib.sha256()
    for room in _ROOMS:
        for file in sorted((package / room).rglob("*")):
            if file.suffix in _DECIDING:
                digest.update(f"{file.relative_to(package).as_posix()}\n".encode() + file.read_bytes())
    return digest.hexdigest()[:16]


def joblib_cores() -> int:
    """Return how many cores this process may use."""
    import joblib

    return int(joblib.cpu_count())


def reference_kernel_s(repeats: int = 7) -> float:
    """Return the best time [s] of a fixed numpy kernel, so that figures of two machines can be compared.

    The kernel runs on one core: sort, running sum, Fourier transform and gather of 500 000 fixed numbers.
    """
    numbers = np.random.default_rng(0).random(500_000)
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        order = np.argsort(numbers)
        np.fft.rfft(np.cumsum(numbers[order]))
        times.append(time.perf_counter() - start)
    return min(times)


def _processor() -> str:
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        for line in cpuinfo.read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or "unknown"


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
