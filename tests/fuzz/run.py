"""Sends hostile input through every public door; says what crashed, hung, or was accepted and should not have been.

    python tests/fuzz/run.py --minutes 2 --seed 1 --out out/fuzz     a table, out/fuzz/summary.json, findings as files
    python tests/fuzz/run.py --replay out/fuzz/logs.carmen           these findings again (a file, or a folder of them)

Input number k of a border under a seed is always the same bytes, and the numbers of inputs follow from --minutes by
what each border's inputs cost, not from the clock: the same options send the same inputs on every machine.
"""

import os

for _threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(_threads, "1")  # children are forked: threads would not come along

import argparse  # noqa: E402
import sys  # noqa: E402
import tempfile  # noqa: E402
import warnings  # noqa: E402
from contextlib import suppress  # noqa: E402
from pathlib import Path  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parent))

from borders.areas import AREAS  # noqa: E402
from fuzzer.border import Border  # noqa: E402
from fuzzer.codec import read_finding  # noqa: E402
from fuzzer.report import printed, put_table, rows, write_findings, write_summary  # noqa: E402
from fuzzer.supervisor import Tally, sent  # noqa: E402
from fuzzer.worker import Inputs  # noqa: E402


def main() -> int:
    """Run; return 1 if there is any finding."""
    options = _options()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory(dir="/dev/shm" if Path("/dev/shm").is_dir() else None, prefix="fuzz-") as folder:
        tallies = _replayed(options, Path(folder)) if options.replay else _fuzzed(options, Path(folder))
    table = rows(tallies)
    print(printed(table))
    write_summary(options.out / "summary.json", tallies, {"seed": options.seed, "minutes": options.minutes})
    if options.table is not None:
        put_table(options.table, table, f"make fuzz MINUTES={options.minutes:g} SEED={options.seed}")
    return 1 if any(tally.findings for tally in tallies) else 0


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=2.0, help="about how long; sets the number of inputs")
    parser.add_argument("--seed", type=int, default=1, help="of all inputs")
    parser.add_argument("--only", default="", metavar="NAMES", help="borders whose name begins so, with commas between")
    parser.add_argument("--count", type=int, help="inputs a border, instead of --minutes")
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    parser.add_argument("--replay", type=Path, nargs="+", help="files of findings, or folders of them")
    parser.add_argument("--out", type=Path, default=Path("out/fuzz"), help="where the findings go")
    parser.add_argument("--table", type=Path, help="documentation page to put the table into")
    return parser.parse_args()


def _fuzzed(options: argparse.Namespace, folder: Path) -> list[Tally]:
    wanted = tuple(options.only.split(","))
    every = sum(len(area.borders) for area in AREAS.values())
    tallies: list[Tally] = []
    with suppress(KeyboardInterrupt):  # what is done is shown
        for area in AREAS.values():
            borders = [border for border in area.borders if border.name.startswith(wanted)]
            if borders:
                area.warm()
            for border in borders:
                count = options.count or inputs_for(border, options.minutes, every)
                inputs = Inputs(options.seed, range(options.first, options.first + count))
                tallies.append(_told(sent(border, inputs, folder / border.name), options))
    return tallies


def inputs_for(border: Border, minutes: float, borders: int) -> int:
    """Return how many inputs a border gets: each border has an equal share of the time, and 5 inputs at least."""
    return max(5, round(minutes * 60e3 / borders / border.ms))


def _replayed(options: argparse.Namespace, folder: Path) -> list[Tally]:
    files = [f for path in options.replay for f in (sorted(path.rglob("*.json")) if path.is_dir() else [path])]
    by_border: dict[str, list] = {}
    for file in files:
        name, value = read_finding(file)
        by_border.setdefault(name, []).append(value)
    tallies = []
    for area in AREAS.values():
        borders = [border for border in area.borders if border.name in by_border]
        if borders:
            area.warm()
        for border in borders:
            given = by_border[border.name]
            tallies.append(_told(sent(border, Inputs(0, range(len(given)), given), folder / border.name), options))
    return tallies


def _told(tally: Tally, options: argparse.Namespace) -> Tally:
    """Say how a border fared, and write its findings at once: what comes after it may take an hour."""
    lines = write_findings(options.out / "findings", tally, options.seed)
    head = f"{tally.border}: {tally.inputs} inputs, {len(tally.findings)} findings in {tally.seconds:.0f} s"
    print("\n".join([head, *lines]), file=sys.stderr, flush=True)
    return tally


if __name__ == "__main__":
    sys.exit(main())
