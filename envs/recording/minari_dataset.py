"""Writes demonstrations as a dataset of Minari, the Farama foundation's format for offline reinforcement learning.

Layout of Minari: ROOT/ID/data with metadata.json (spaces, the environment's spec) and a folder for each episode, which
holds an Arrow table and a metadata.json with its seed and options. Arrow and JSON only: nothing in it is code.
"""

import os
import re
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import gymnasium as gym

from ...slam.errors import InputError, MissingExtraError, shown
from ...slam.files.output import new_folder
from .demonstration import Demonstration

_ID = re.compile(r"[\w-]+(/[\w-]+)*-v\d+")


def check_minari() -> Any:
    """Return Minari's storage and what it takes.

    Raises:
        MissingExtraError: If `minari` or `pyarrow` is not installed.
    """
    try:
        import minari  # pyright: ignore[reportMissingImports]
        import pyarrow.dataset  # noqa: F401  # pyright: ignore[reportMissingImports]
        from minari.dataset.minari_storage import MinariStorage  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise MissingExtraError("datasets of Minari", "datasets") from None
    return minari, MinariStorage


def write_minari(
    root: str | os.PathLike[str],
    dataset_id: str,
    env: gym.Env[Any, Any],
    demonstrations: Iterable[Demonstration],
    follower: str = "",
) -> Path:
    """Write a dataset, whole or not at all, and return its folder.

    With `MINARI_DATASETS_PATH=ROOT`, `minari.load_dataset(ID)` finds it; `recover_environment()` makes its environment.

    Args:
        root: Folder of the datasets.
        dataset_id: Minari's name for it: NAMESPACE/NAME-vNUMBER.
        env: Where they were driven; made by `gymnasium.make`, so that it has a spec.
        demonstrations: The episodes; each is asked for when its turn comes.
        follower: Who drove, as the dataset's algorithm.

    Raises:
        InputError: If the name is none of Minari's, there is something at its place, or the environment cannot be told
            as text (e.g. because an argument of it is a function).
        MissingExtraError: If `minari` or `pyarrow` is not installed.
    """
    minari, storage_class = check_minari()
    if not _ID.fullmatch(dataset_id):
        raise InputError(f"a Minari dataset is called NAMESPACE/NAME-vNUMBER, got {shown(dataset_id)}")
    require_kept(env)
    target = Path(root) / dataset_id
    with new_folder(target) as temporary:
        storage = storage_class.new(
            temporary / "data", env.observation_space, env.action_space, env.spec, "arrow", jpeg_encoding=False
        )
        known = {"dataset_id": dataset_id, "minari_version": minari.__version__, "algorithm_name": follower}
        storage.update_metadata({**known, "description": "Episodes in tagalong's simulated buildings."})
        storage.update_episodes(_buffer(minari, one) for one in demonstrations)
    return target


def require_kept(env: gym.Env[Any, Any]) -> None:
    """Make sure that Minari can keep how the environment was made; it only warns where it cannot.

    Raises:
        InputError: If it has no spec, or one of its arguments is no text, number or table of such.
    """
    if env.spec is None:
        raise InputError("a dataset keeps how its environment was made: make it by `gymnasium.make`")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            env.spec.to_json()
    except (TypeError, ValueError, UserWarning) as error:
        raise InputError(f"the environment's arguments cannot be kept as text: {error}") from None


def _buffer(minari: Any, one: Demonstration) -> Any:
    return minari.data_collector.EpisodeBuffer(
        seed=one.seed,
        options=one.options,
        observations=one.observations,
        actions=one.actions,
        rewards=one.rewards.tolist(),
        terminations=one.terminated.tolist(),
        truncations=one.truncated.tolist(),
        # its reader stumbles over columns of plain numbers that came as arrays
        infos={name: array if array.ndim > 1 else array.tolist() for name, array in one.infos.items()},
    )
