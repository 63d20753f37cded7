"""Says that the first call compiles, to who waits for it at a terminal."""

import os
import sys
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[2]
HINT = "the first call compiles kernels, which takes up to some minutes, once; they are kept"


def kernels_are_kept() -> bool:
    """Return whether any compiled kernel is found where numba keeps them: its own folder, or beside the sources.

    Kept in a third place, where neither can be written to, they are not found; then the hint is given too often.
    """
    own = os.environ.get("NUMBA_CACHE_DIR")
    places = [Path(own)] if own else [_PACKAGE / room for room in ("slam", "perception", "envs")]
    return any(next(place.rglob("*.nbi"), None) is not None for place in places if place.is_dir())


def tell_first_call() -> None:
    """Write the hint to stderr, if nothing was compiled yet and somebody reads it."""
    if sys.stderr is not None and sys.stderr.isatty() and not kernels_are_kept():
        print(f"tagalong: {HINT}", file=sys.stderr, flush=True)
