"""How much memory this process holds, or held; NaN where the system does not tell."""

import gc
import math
import os
import sys
from pathlib import Path

_STATM = Path("/proc/self/statm")


def memory_mb() -> float:
    """Return the memory that this process holds now, garbage collected [MB]; the peak where no system tells."""
    gc.collect()
    if _STATM.exists():
        return int(_STATM.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
    return peak_memory_mb()


def peak_memory_mb() -> float:
    """Return the largest memory that this process ever held [MB]; NaN on Windows."""
    try:
        import resource
    except ImportError:
        return math.nan
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1e6 if sys.platform == "darwin" else 1e3 / 1.024)  # bytes there, KiB elsewhere
