"""Where the cells of an experiment run: processes of this machine, or a cluster, behind joblib's one interface."""

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, cast

import joblib

from ...slam.errors import MissingExtraError, unknown_name

BACKENDS = ("loky", "ray", "dask")
"""Names for `parallel_backend`."""


@contextmanager
def parallel_backend(name: str, jobs: int) -> Iterator[None]:
    """Let `joblib.Parallel` inside the block run on `name`.

    Args:
        name: "loky": processes of this machine. "ray": the cluster that `RAY_ADDRESS` names, else a local one. "dask":
            the scheduler that `DASK_SCHEDULER_ADDRESS` names, else a local one.
        jobs: How many processes.

    Raises:
        InputError: If there is no such backend.
        MissingExtraError: If its package is not installed.
    """
    if name == "loky":
        yield
    elif name == "ray":
        with _ray(jobs):
            yield
    elif name == "dask":
        with _dask(jobs):
            yield
    else:
        raise unknown_name("backend", name, BACKENDS)


def results_of(tasks: Sequence[tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]], jobs: int) -> Iterator[Any]:
    """Yield what `joblib.delayed` tasks return, as they end, on the backend of the block around.

    Ray gives results only when a whole batch is done, so it gets them in batches of four for each process.
    """
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
