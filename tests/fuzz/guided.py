"""A reader of texts fed by atheris, which looks for input that reaches new branches; not part of the tests.

    pip install atheris
    python tests/fuzz/guided.py logs.carmen -max_total_time=600 -artifact_prefix=out/fuzz/

What it finds it writes as a file of bytes; the verdict is that of the suite. It takes borders whose input is one file.
"""

import sys
import tempfile
from pathlib import Path

import atheris

sys.path.insert(0, str(Path(__file__).resolve().parent))

import tagalong.slam.grid
from tagalong.perception import LegForest  # noqa: F401 (kernels are loaded before anything is instrumented)

with atheris.instrument_imports(include=["tagalong.slam.logs"]):
    import tagalong.slam.drives.log  # noqa: F401

from borders.areas import AREAS
from fuzzer.verdict import judge
from fuzzer.worker import draws

_SEEDS = 200


def main() -> None:
    """Feed the border that the command line names until something is found, or the options say that it is enough."""
    name = sys.argv.pop(1)
    border = next(border for area in AREAS.values() for border in area.borders if border.name == name)
    with tempfile.TemporaryDirectory() as folder:
        corpus, scratch = Path(folder) / "corpus", Path(folder) / "scratch"
        corpus.mkdir()
        scratch.mkdir()
        for number in range(_SEEDS):
            (corpus / f"{number}").write_bytes(border.make(draws(border, 1, number)))

        def one(data: bytes) -> None:
            verdict = judge(border, data, scratch)
            if verdict.is_finding:
                raise RuntimeError(f"{verdict.kind}: {verdict.told}")

        atheris.Setup([*sys.argv, str(corpus)], one)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
