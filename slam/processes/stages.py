"""Work that is done in stages, so that several can take turns.

A step of an environment runs through more code and tables than a processor's caches hold. Where one process has several
environments to step, it is faster to run one stage of all of them before the next stage of any: what the stage needs is
still there. On this project's machine eight offices took 0.6 to 0.7 of the time that they took one after the other.

A piece of work is a generator. It pauses, yielding nothing, where a stage ends; what it returns is its result. Only the
environments' own steps are written so: a detector, a tracker, a filter is one call, and one stage, whoever wrote it.
"""

from collections.abc import Generator, Iterable
from typing import TypeVar

Result = TypeVar("Result")
Stages = Generator[None, None, Result]


def completed(work: Stages[Result]) -> Result:
    """Run all stages of `work`; return its result."""
    while True:
        try:
            next(work)
        except StopIteration as end:
            return end.value


def in_turn(works: Iterable[Stages[Result]]) -> list[Result]:
    """Run a stage of each of `works`, then the next stage of each, until all are done; return their results."""
    waiting = list(enumerate(works))
    results: dict[int, Result] = {}
    while waiting:
        still = []
        for number, work in waiting:
            try:
                next(work)
                still.append((number, work))
            except StopIteration as end:
                results[number] = end.value
        waiting = still
    return [results[number] for number in sorted(results)]
