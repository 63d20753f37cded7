"""Where the cells of an experiment run: processes of this machine, or a cluster, behind joblib's one interface."""

from collections.abc import Iterator
from contextlib import contextmanager

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


@contextmanager
def _ray(jobs: int) -> Iterator[None]:
    try:
        import ray  # pyright: ignore[reportMissingImports]
        from ray.util.joblib import register_ray  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise MissingExtraError("the backend ray", "cluster") from None
    import os

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
        raise MissingExtraError("the backend dask", "cluster") from None
    import os

    address = os.environ.get("DASK_SCHEDULER_ADDRESS")
    where = address or LocalCluster(n_workers=jobs, threads_per_worker=1, dashboard_address=None)
    with Client(where), joblib.parallel_config(backend="dask", n_jobs=jobs):
        yield
