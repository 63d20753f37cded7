"""Kills every command that writes, many times: `python tests/kill_all.py [--kills 20] [--only NAME ...]`.

Each is started in a folder of its own, killed at random moments by SIGKILL, SIGTERM and SIGINT, five times in the same
folder (long ones: every time); then it runs to its end, and its files are compared with those of a run that nobody
disturbed. Prints a table.
"""

import argparse
import ctypes
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import replace
from functools import partial
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "helpers"))

import kill_plans
from kills import Killed, digests, files, is_whole, kill_once, left_in, scratch_of, start

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
COLUMNS = ("kills", "late", "orphans", "half files", "temporaries", "words", "resumed equal", "slowest end [s]")


def main() -> int:
    """Kill, print the table as it grows; 1 if anything is not as promised."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=20, help="of each command (default: %(default)s)")
    parser.add_argument("--only", nargs="+", choices=kill_plans.PLANS, metavar="NAME", help="these commands")
    parser.add_argument("--seed", type=int, default=0, help="of the moments (default: %(default)s)")
    parser.add_argument("--within", type=float, metavar="S", help="kill within so many seconds, and compare nothing")
    parser.add_argument("--hazards", action="store_true", help="full disks and such instead of kills")
    options = parser.parse_args()
    if not options.hazards:
        print(f"{'command':26s}" + "  ".join(COLUMNS), flush=True)
    failed = False
    with tempfile.TemporaryDirectory() as scratch:
        with redirect_stdout(sys.stderr):
            kill_plans.prepare(Path(scratch) / "in")
        for name in options.only or kill_plans.PLANS if not options.hazards else ():
            draw = random.Random(f"{options.seed} {name}")
            plan = kill_plans.PLANS[name]
            if options.within is not None:
                plan = replace(plan, within_s=options.within, compared=False)
            seen, equal = killed(plan, Path(scratch), options.kills, draw)
            cells = (seen.kills, seen.late, seen.orphans, len(seen.broken), len(seen.leftovers), len(seen.said), equal)
            padded = zip((*cells, f"{seen.slowest_s:.1f}"), COLUMNS, strict=True)
            print(f"{name:26s}" + "  ".join(str(cell).rjust(len(title)) for cell, title in padded), flush=True)
            for fault in seen.faults:
                print(f"    {fault}", flush=True)
            done, tries = (int(word) for word in equal.split("/")) if "/" in equal else (0, 0)
            failed |= bool(seen.faults) or done != tries
        for name in options.only or kill_plans.PLANS if options.hazards else ():
            for hazard, faults in hazards(kill_plans.PLANS[name], Path(scratch)):
                print(f"{name:26s}{hazard:20s}{'; '.join(faults) or 'as promised'}", flush=True)
                failed |= bool(faults)
    return int(failed)


def hazards(plan: kill_plans.Plan, scratch: Path) -> Iterator[tuple[str, list[str]]]:
    """Yield what went wrong: full disk, a file in the way, folders deleted and read-only, two writers at once."""
    words = placed(plan, scratch)
    full = {"preexec_fn": partial(resource.setrlimit, resource.RLIMIT_FSIZE, (200, 200))}
    yield "full disk", told(start(words, fresh(scratch / "full"), **full), {2}, scratch / "full")
    folder = fresh(scratch / "file")
    (folder / "out").write_text("in the way")
    yield "file in the way", told(start(words, folder), {2}, folder)
    folder = fresh(scratch / "gone")
    process = start(words, folder)
    while process.poll() is None and not (folder / "out").exists():
        time.sleep(0.05)
    time.sleep(0.5)
    shutil.rmtree(folder / "out", ignore_errors=True)
    yield "folder deleted", told(process, {0, 1, 2}, folder)
    folder = fresh(scratch / "locked")
    (folder / "out").mkdir(mode=0o555)
    yield "read-only folder", told(start(words, folder, preexec_fn=obey_modes), {2}, folder)
    folder = fresh(scratch / "both")
    both = [start(words, folder) for _ in range(2)]
    faults = [fault for process in both for fault in told(process, {0, 1, 2}, folder, ended=False)]
    faults += ["nobody wrote"] if all(process.returncode == 2 for process in both) else []
    yield "two writers", faults + [f"half file {path.name}" for path in files(folder) if not is_whole(path)]


def obey_modes() -> None:
    """Take from the superuser, in the program that is started next, the right to write where nobody may."""
    drop_from_bounding_set, override = 24, 1  # PR_CAPBSET_DROP, CAP_DAC_OVERRIDE
    ctypes.CDLL(None).prctl(drop_from_bounding_set, override, 0, 0, 0)


def told(process: subprocess.Popen[str], promised: set[int], folder: Path, ended: bool = True) -> list[str]:
    """Return what is not as promised: status, one line, and, where nobody else writes, no temporary files."""
    _, said = process.communicate(timeout=1800)
    faults = [f"exit status {process.returncode}: {said[-300:]!r}"] if process.returncode not in promised else []
    lines = [line for line in said.splitlines() if "tagalong: " in line and "finished cells" not in line]
    if "Traceback" in said or len(lines) != (process.returncode == 2):
        faults.append(f"words: {said[-1500:]!r}")
    return faults + [f"left {path.name}" for path in folder.rglob(".*") if ended and path.is_file()]


def placed(plan: kill_plans.Plan, scratch: Path) -> list[str]:
    """Return a plan's words with the folder of what they read."""
    return [word.replace("IN", str(scratch / "in"), 1) if word.startswith("IN/") else word for word in plan.words]


def killed(plan: kill_plans.Plan, scratch: Path, kills: int, draw: random.Random) -> tuple[Killed, str]:
    """Return what was seen of `kills` kills, and how many of the runs that followed were equal."""
    words = placed(plan, scratch)
    seen, equal, tries, within_s, wanted = Killed(), 0, 0, plan.within_s or 0.0, {}
    if plan.compared:
        wanted = whole(words, fresh(scratch / "whole"), seen, plan)
        if plan.within_s is None:  # the first run compiled, perhaps
            began = time.monotonic()
            whole(words, fresh(scratch / "whole"), seen, plan)
            within_s = time.monotonic() - began
    folder, done = fresh(scratch / "killed"), False
    for k in range(kills):
        folder = folder if k % plan.in_a_row and not done else fresh(folder)
        kill_once(words, folder, SIGNALS[k % len(SIGNALS)], draw.uniform(0.0, within_s), seen)
        done = plan.once is not None and (folder / plan.once).exists()
        if plan.compared and (k % plan.in_a_row == plan.in_a_row - 1 or k == kills - 1):
            tries += 1
            found = digests(folder, plan.times) if done else whole(words, folder, seen, plan)
            equal += found == wanted
            if found != wanted:
                different = {name for name in found.keys() | wanted.keys() if found.get(name) != wanted.get(name)}
                print(f"    not equal: {sorted(different)}", flush=True)
    return seen, f"{equal}/{tries}" if tries else "-"


def whole(words: list[str], folder: Path, seen: Killed, plan: kill_plans.Plan) -> dict[str, str]:
    """Return the digests of what a run makes that nobody disturbs; one that does not end well is noted in `seen`."""
    process = start(words, folder)
    _, said = process.communicate(timeout=1800)
    if process.returncode not in {0, 1}:
        seen.said.append(f"exit status {process.returncode} of a whole run: {said[-1500:]!r}")
    seen.leftovers += [f"{path.name} after a whole run" for path in left_in(scratch_of(folder))]
    shutil.rmtree(scratch_of(folder))
    return digests(folder, plan.times)


def fresh(folder: Path) -> Path:
    """Return `folder`, empty."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    return folder


if __name__ == "__main__":
    sys.exit(main())
