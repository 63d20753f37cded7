"""Where the cells of an experiment run: worker processes of this machine, or a cluster by way of joblib."""

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, cast

import joblib

from ...slam.errors import MissingExtraError, unknown_name
from ...slam.processes.crew import Crew, require_workers

BACKENDS = ("local", "ray", "dask")
"""Names for `runner`."""

MOST_CLUSTER_JOBS = 10_000
"""More processes than any experiment here has cells for."""

Run = Callable[[Callable[..., Any], Sequence[tuple[Any, ...]]], Iterator[Any]]
"""Yields what a function returns for each tuple of arguments, as they end."""


@contextmanager
def runner(name: str, jobs: int) -> Iterator[Run]:
    """Yield what runs calls on `name`.

    Args:
        name: "local": processes of this machine. "ray": the cluster that `RAY_ADDRESS` names, else a local one. "dask":
            the scheduler that `DASK_SCHEDULER_ADDRESS` names, else a local one.
        jobs: How many processes; 1 on this machine is this one.

    Raises:
        InputError: If there is no such backend, or `jobs` is more than it has use for.
        MissingExtraError: If its package is not installed.
        WorkerError: Later: if a process of this machine is lost.
    """
    if name not in BACKENDS:
        raise unknown_name("backend", name, BACKENDS)
    if name == "local" and jobs == 1:
        yield lambda function, calls: (function(*arguments) for arguments in calls)
    elif name == "local":
        require_workers(jobs, "--jobs")
        with Crew(jobs) as crew:
            yield lambda function, calls: (result for _, result in crew.results(function, calls))
    else:
        with _ray(jobs) if name == "ray" else _dask(jobs):
            yield lambda function, calls: _by_joblib(function, calls, jobs)


def _by_joblib(function: Callable[..., Any], calls: Sequence[tuple[Any, ...]], jobs: int) -> Iterator[Any]:
    """Yield what the calls return, as they end; Ray gives them only in batches, of four for each process."""
    tasks = [joblib.delayed(function)(*arguments) for arguments in calls]
    if _streams():
        yield from cast(Iterator[Any], joblib.Parallel(n_jobs=jobs, return_as="generator_unordered")(tasks))
        return
    size = 4 * jobs
    for start in range(0, len(tasks), size):
        yield from cast(list[Any], joblib.Parallel(n_jobs=jobs)(tasks[start : start + size]))


def _streams() -> bool:
    backend, _ = joblib.parallel.get_active_backend()
    return bool(getattr(backend, "supports_return_generator", False))


@contextmanager
def _ray(jobs: int) -> Iterator[None]:
    try:
        import ray  # pyright: ignore[reportMissingImports]
        from ray.util.joblib import register_ray  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise MissingExtraError("cells on Ray", "cluster") from None
    local = {} if "RAY_ADDRESS" in os.environ else {"num_cpus": jobs}
    ray.init(include_dashboard=False, log_to_driver=False, logging_level="error", **local)
    register_ray()
    try:
        with joblib.parallel_config(backend="ray", n_jobs=jobs):
            yield
    finally:
        ray.shutdown()


@contextmanager
def _dask(jobs: int) -> Iterator[None]:
    try:
        from distributed import Client, LocalCluster  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise MissingExtraError("cells on Dask", "cluster") from None
    address = os.environ.get("DASK_SCHEDULER_ADDRESS")
    where = address or LocalCluster(n_workers=jobs, threads_per_worker=1, dashboard_address=None)
    with Client(where), joblib.parallel_config(backend="dask", n_jobs=jobs):
        yield
