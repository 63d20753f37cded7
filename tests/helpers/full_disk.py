"""A disk that is full."""

import resource
from contextlib import contextmanager


@contextmanager
def full_disk():
    """No file may grow beyond 2 kB; the system says so as it says that a disk is full."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
