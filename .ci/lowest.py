"""Prints the oldest dependencies that pyproject.toml promises to work with, as constraints: `lowest.py EXTRA...`."""

import re
import sys
import tomllib
from pathlib import Path

PROJECT = tomllib.loads((Path(__file__).resolve().parents[1] / "pyproject.toml").read_text())["project"]


def lowest(requirement: str) -> str:
    """Return `requirement`, such as "numpy>=2.0", as the releases with which its promise begins: "numpy==2.0.*"."""
    found = re.match(r"([\w-]+)(?:\[[\w,]+\])?>=([\d.]+)", requirement)
    if found is None:
        raise SystemExit(f"pyproject.toml: {requirement!r} has no lower bound")
    return f"{found[1]}=={found[2]}.*"


if __name__ == "__main__":
    extras = PROJECT["optional-dependencies"]
    wanted = [*PROJECT["dependencies"], *(each for name in sys.argv[1:] for each in extras[name])]
    print("\n".join(sorted({lowest(each) for each in wanted})))
