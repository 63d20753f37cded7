"""Builds the sdist, and the wheel from it, so that one commit gives the same bytes everywhere: `build_dist.py DIR`.

Every file has the time of the commit, or of `SOURCE_DATE_EPOCH`. Setuptools honours that in wheels; the sdist it writes
is packed anew here: in order, without owners, with that time in every entry and in gzip's header.
"""

import gzip
import io
import os
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
EARLIEST = 315532800
"""The first second that the zip format can say: 1980."""


def main(folder: Path) -> None:
    """Build both into `folder`."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH") or commit_time()
    os.environ["SOURCE_DATE_EPOCH"] = str(max(int(epoch), EARLIEST))
    os.umask(0o022)  # a wheel keeps the modes of its files
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as made:
        build("--sdist", "--outdir", made, str(ROOT))
        (sdist,) = Path(made).glob("*.tar.gz")
        target = folder / sdist.name
        target.write_bytes(packed_anew(sdist, int(os.environ["SOURCE_DATE_EPOCH"])))
        with tarfile.open(target) as content:
            content.extractall(made, filter="data")
        build("--wheel", "--outdir", str(folder), str(Path(made) / sdist.name.removesuffix(".tar.gz")))


def commit_time() -> str:
    """Return the time of the commit [s]; "0" where there is no repository."""
    words = ["git", "-C", str(ROOT), "log", "-1", "--format=%ct"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)  # noqa: S603 (words above)
    return done.stdout.strip() or "0"


def build(*words: str) -> None:
    """Run the program that builds distributions."""
    options = os.environ.get("BUILD_OPTIONS", "").split()
    subprocess.run([sys.executable, "-m", "build", *options, *words], check=True)  # noqa: S603 (this Python)


def packed_anew(sdist: Path, time_s: int) -> bytes:
    """Return the sdist with its entries in order, of nobody, and of one time."""
    out = io.BytesIO()
    with (
        tarfile.open(sdist) as old,
        gzip.GzipFile(fileobj=out, mode="wb", mtime=time_s, filename="") as zipped,
        tarfile.open(fileobj=zipped, mode="w", format=tarfile.PAX_FORMAT) as new,
    ):
        for entry in sorted(old.getmembers(), key=lambda each: each.name):
            entry.mtime, entry.uid, entry.gid, entry.uname, entry.gname, entry.pax_headers = time_s, 0, 0, "", "", {}
            entry.mode = 0o755 if entry.isdir() or entry.mode & 0o100 else 0o644
            new.addfile(entry, old.extractfile(entry) if entry.isfile() else None)
    return out.getvalue()


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
