"""Starts commands, kills them, and looks at what they leave: processes, files, words, what a second run makes of it."""

import gzip
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import zipfile
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from PIL import Image

ORPHAN_S = 5.0
"""Every process of a command that was killed is gone after this time [s]."""
UNWIND_S = 60.0
"""A command that is asked to end has done so after this time [s], on a machine that does much else."""
STATUS = {signal.SIGKILL: -signal.SIGKILL, signal.SIGTERM: 143, signal.SIGINT: 130}
TIMES = frozenset({"timing", "minutes", "wall_s", "timing.json"})
"""Names under which stands what depends on the clock."""
UNEQUAL = re.compile(
    r"(timing|bench)\.json|report\.html|.*tfevents.*|checkpoint\.json|model_.*|.*\.gif|.*\.rrd|.*[-_]times?\.png|settings\.json"
)
"""Files that may differ between two runs: they hold times, or serve only to go on."""


@dataclass(kw_only=True)
class Killed:
    """What was seen of one command that was killed.

    Attributes:
        kills: How often it was.
        late: Of them, how often it had ended before.
        orphans: Processes that were there after `ORPHAN_S`.
        broken: Files that cannot be read.
        leftovers: Temporary files after a signal that lets it tidy up.
        said: Exit statuses and words that are not as promised.
        slowest_s: The longest time that it took to end [s].
    """

    kills: int = 0
    late: int = 0
    orphans: int = 0
    broken: list[str] = field(default_factory=list)
    leftovers: list[str] = field(default_factory=list)
    said: list[str] = field(default_factory=list)
    slowest_s: float = 0.0

    @property
    def faults(self) -> list[str]:
        """Everything that must not be, in words."""
        orphans = [f"{self.orphans} orphans"] if self.orphans else []
        return orphans + self.broken + self.leftovers + self.said


def start(words: list[str], folder: Path, preexec_fn=None) -> subprocess.Popen[str]:
    """Start `python WORDS` in a session of its own, in `folder`; its temporary files go to `scratch_of(folder)`."""
    scratch_of(folder).mkdir(exist_ok=True)

    def begin():
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # a background shell has it ignored
        if preexec_fn is not None:
            preexec_fn()

    return subprocess.Popen(
        [sys.executable, *words],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=begin,
        env=os.environ | {"TMPDIR": str(scratch_of(folder))},
    )


def scratch_of(folder: Path) -> Path:
    """Return the folder of the temporary files of what runs in `folder`."""
    return folder.with_name(f"{folder.name}.tmp")


def left_in(scratch: Path) -> list[Path]:
    """Return what a command left in the folder of its temporary files, but for the cache that importing torch makes."""
    return sorted(path for path in scratch.iterdir() if not path.name.startswith("torchinductor_"))


def members(session: int) -> list[int]:
    """Return the processes of a session that have not ended."""
    found = []
    for entry in Path("/proc").iterdir():
        with suppress(OSError, ValueError):
            words = (entry / "stat").read_text().rsplit(")", 1)[1].split()
            if int(words[3]) == session and words[0] != "Z":
                found.append(int(entry.name))
    return found


def kill_once(words: list[str], folder: Path, end: signal.Signals, after_s: float, seen: Killed) -> None:
    """Start a command, send it `end` after a while, and note in `seen` what is left.

    SIGINT goes to all its processes, as from a terminal; the others to the first alone. The time counts from when it
    has begun to take signals; before, it is Python that has them.
    """
    process = start(words, folder)
    try:
        while process.poll() is None and not _takes_signals(process.pid):
            time.sleep(0.01)
        with suppress(subprocess.TimeoutExpired):
            process.wait(after_s)
        seen.kills += 1
        seen.late += process.poll() is not None
        promised = {STATUS[end]} if process.poll() is None else {0, 1}
        with suppress(ProcessLookupError):
            (os.killpg if end == signal.SIGINT else os.kill)(process.pid, end)
        began = time.monotonic()
        _, said = process.communicate(timeout=UNWIND_S)
        seen.slowest_s = max(seen.slowest_s, time.monotonic() - began)
        _note_words(process.returncode, said, end, promised, seen)
        deadline = time.monotonic() + ORPHAN_S
        while members(process.pid) and time.monotonic() < deadline:
            time.sleep(0.05)
        seen.orphans += len(members(process.pid))
    finally:
        for pid in members(process.pid):
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        process.wait()
    seen.broken += [str(path.relative_to(folder)) for path in files(folder) if not is_whole(path)]
    scratch = scratch_of(folder)
    hidden = [path for path in folder.rglob("*") if path.is_file() and is_hidden(path, folder)]
    if end != signal.SIGKILL:  # nobody can tidy up after that
        seen.leftovers += [str(path.relative_to(folder.parent)) for path in (*hidden, *left_in(scratch))]
    for path in hidden:
        path.unlink(missing_ok=True)  # so that those of another signal are told from them
    shutil.rmtree(scratch)


def _note_words(status: int, said: str, end: signal.Signals, promised: set[int], seen: Killed) -> None:
    """Note an exit status that is not promised, a traceback, or more than one line."""
    if status in {0, 1} and "tagalong:" not in said and "Traceback" not in said:
        return  # it had ended by itself
    if end != signal.SIGKILL and status == -end and "tagalong:" not in said and "Traceback" not in said:
        seen.late += 1  # its work was done and its handlers gone: Python was closing down; a shell says 130 or 143
        return
    if status not in promised | {STATUS[end]}:
        seen.said.append(f"exit status {status} after {end.name}: {said[-300:]!r}")
    lines = [line for line in said.splitlines() if "tagalong: " in line and "finished cells" not in line]
    if "Traceback" in said or "Exception ignored" in said or len(lines) != (end != signal.SIGKILL):
        seen.said.append(f"after {end.name}: {said[-1500:]!r}")


def _takes_signals(pid: int) -> bool:
    """Return whether a process has a handler for SIGTERM."""
    with suppress(OSError):
        for line in Path(f"/proc/{pid}/status").read_text().splitlines():
            if line.startswith("SigCgt:"):
                return bool(int(line.split()[1], 16) >> (signal.SIGTERM - 1) & 1)
    return False


def files(folder: Path) -> list[Path]:
    """Return the files of `folder` that are not hidden, in order."""
    return sorted(path for path in folder.rglob("*") if path.is_file() and not is_hidden(path, folder))


def is_hidden(path: Path, folder: Path) -> bool:
    """Return whether a file of `folder`, or a folder of it that the file lies in, has a hidden name."""
    return any(part.startswith(".") for part in path.relative_to(folder).parts)


def is_whole(path: Path) -> bool:
    """Return whether a result file can be read to its end."""
    try:
        if path.suffix == ".json":
            json.loads(path.read_text())
        elif path.suffix == ".npz":
            with np.load(path, allow_pickle=False) as arrays:
                return all(arrays[name] is not None for name in arrays.files)
        elif path.suffix == ".zip":
            return zipfile.ZipFile(path).testzip() is None
        elif path.suffix in {".png", ".pgm", ".gif"}:
            with Image.open(path) as image:
                image.load()
        elif path.suffix == ".gz":
            gzip.decompress(path.read_bytes())
        elif path.suffix == ".mcap":
            return path.read_bytes().endswith(b"\x89MCAP0\r\n")
        elif path.suffix == ".tum" and not path.stat().st_size:
            return True  # of a robot that was never sure where it was
        elif path.suffix in {".tum", ".csv", ".txt", ".yaml", ".html", ".log"}:
            return path.read_bytes().endswith(b"\n") or "</html>" in path.read_text()[-20:]
        return path.stat().st_size > 0
    except Exception:  # whatever a reader thinks of it, it is not whole
        return False


def digests(folder: Path, times: frozenset[str] = frozenset()) -> dict[str, str]:
    """Return a hash of every file of `folder` whose content does not depend on the clock; `times` as in a plan."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(_timeless(path, TIMES | times)).hexdigest()[:16]
        for path in files(folder)
        if not UNEQUAL.fullmatch(path.name)
    }


def _timeless(path: Path, times: frozenset[str]) -> bytes:
    if path.suffix != ".json":
        return path.read_bytes()
    return json.dumps(_without_times(json.loads(path.read_text()), times)).encode()


def _without_times(value, times: frozenset[str]):
    if isinstance(value, dict):
        return {key: _without_times(item, times) for key, item in value.items() if key not in times}
    return [_without_times(item, times) for item in value] if isinstance(value, list) else value
