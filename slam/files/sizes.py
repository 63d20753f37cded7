"""How large drives and maps in files may be: what they take in memory."""

import os

from ..bounds import MOST_BEAMS
from ..errors import InputError
from .input import named

MOST_SCANS = 1_000_000
"""28 hours at 10 Hz; a scan takes about 700 bytes beside its ranges."""
MOST_RANGES = 64_000_000
"""Of all scans together: 512 MB; 25 minutes of 1081 beams at 40 Hz, 10 hours of 180 beams at 10 Hz."""
MOST_PIXELS = 100_000_000
"""Of a map in a file: 500 m x 500 m in cells of 5 cm; 100 MB, and four times as much as a map."""


class DriveLength:
    """Counts the scans of a log as they are read, and stops a reader that would fill the memory.

    Args:
        path: The log, for errors.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._path, self._scans, self._ranges = path, 0, 0

    def add(self, beams: int, scans: int = 1) -> None:
        """Count a scan of so many beams, or some.

        Raises:
            InputError: If it has too many, or they are too many now.
        """
        self._scans += scans
        self._ranges += beams * scans
        if beams > MOST_BEAMS:
            raise InputError(f"{named(self._path)}: a scan has at most {MOST_BEAMS} beams, got {beams}")
        if self._scans > MOST_SCANS or self._ranges > MOST_RANGES:
            raise InputError(
                f"{named(self._path)}: a drive has at most {MOST_SCANS} scans and {MOST_RANGES} ranges, got "
                f"{self._scans} and {self._ranges} or more: cut it into parts"
            )
