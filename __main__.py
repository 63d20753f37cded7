"""`python -m tagalong` is the same as the command `tagalong`."""

import sys

from .scripts.cli import main

if __name__ == "__main__":
    sys.exit(main())
