"""`python -m tagalong.scripts.site DIR`: writes all pages of the documentation into a folder, for `make docs`."""

import sys
from pathlib import Path

from .pages import write_pages

if __name__ == "__main__":
    write_pages(Path(__file__).resolve().parents[2], Path(sys.argv[1]))
