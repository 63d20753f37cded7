"""Writes demonstrations as a dataset of LeRobot, version 3: Parquet and JSON, no video.

Layout of LeRobot v3.0: ROOT/meta/info.json, stats.json, tasks.parquet, episodes/chunk-000/file-000.parquet, and the
frames in ROOT/data/chunk-000/file-000.parquet and on. `lerobot_features` tells what the columns are.
"""

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np

from ...slam.errors import InputError, MissingExtraError
from ...slam.files.output import new_folder, write_json
from ..follow_env import FollowEnv
from .demonstration import Demonstration
from .lerobot_features import describe, frames_of, indexed
from .lerobot_statistics import Statistics, all_statistics, episode_statistics

VERSION = "v3.0"
_FILES = "chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
_FILES_A_CHUNK, _FILE_MB, _VIDEO_MB = 1000, 100, 200  # LeRobot's own
_FOLLOWING, _EXPLORING = "Follow the person ahead.", "Explore the building."


def check_lerobot() -> tuple[Any, Any]:
    """Return what writes tables: pyarrow and its Parquet part.

    Raises:
        MissingExtraError: If `pyarrow` is not installed.
    """
    try:
        import pyarrow  # pyright: ignore[reportMissingImports]
        import pyarrow.parquet  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise MissingExtraError("datasets of LeRobot", "datasets") from None
    return pyarrow, pyarrow.parquet


def write_lerobot(
    folder: str | os.PathLike[str], env: gym.Env[Any, Any], demonstrations: Iterable[Demonstration], follower: str = ""
) -> Path:
    """Write a dataset, whole or not at all, and return its folder.

    `LeRobotDataset("any/name", root=FOLDER)` reads it. Besides LeRobot's own columns, meta/episodes has `seed`,
    `options`, `ending` and `follower`. What was observed after an episode's last action is left out: LeRobot has one
    frame an action.

    Args:
        folder: Of this dataset; nothing is there yet.
        env: Where they were driven.
        demonstrations: The episodes, at least one; each is asked for when its turn comes.
        follower: Who drove.

    Raises:
        InputError: If there is something already, there are no episodes, `env` is no `FollowEnv`, or it does not take a
            whole number of steps a second, as LeRobot's frames do.
        MissingExtraError: If `pyarrow` is not installed.
    """
    check_lerobot()
    inner = env.unwrapped
    if not isinstance(inner, FollowEnv):
        raise InputError(f"`write_lerobot` needs a FollowEnv, got {inner!r}")
    if (rate := inner.interface.control_hz) % 1.0:
        raise InputError(f"LeRobot has whole frames a second: `control_hz` must be a whole number, got {rate}")
    with new_folder(folder) as temporary:
        _Writer(temporary, inner, follower).write(demonstrations)
    return Path(folder)


class _Writer:
    """Writes the episodes one after the other, and then what is known of all of them."""

    def __init__(self, folder: Path, env: FollowEnv, follower: str) -> None:
        self._pa, self._parquet = check_lerobot()
        self._folder, self._env, self._follower = folder, env, follower
        self._rows: list[dict[str, Any]] = []
        self._statistics: list[Statistics] = []
        self._features: dict[str, dict[str, Any]] = {}
        self._frames = self._file = self._bytes = 0
        self._table: Any = None

    def write(self, demonstrations: Iterable[Demonstration]) -> None:
        """Write everything."""
        try:
            for one in demonstrations:
                self._add(one)
        finally:
            if self._table is not None:
                self._table.close()
        if not self._rows:
            raise InputError("a dataset of LeRobot needs at least one episode, got none")
        meta = self._folder / "meta"
        write_json(meta / "info.json", self._info())
        write_json(meta / "stats.json", all_statistics(self._statistics))
        self._write_episodes(meta / "episodes" / _FILES.format(chunk_index=0, file_index=0))
        self._write_tasks(meta / "tasks.parquet")

    def _add(self, one: Demonstration) -> None:
        number = len(self._rows)
        frames = indexed(frames_of(one), number, self._frames, self._env.interface.control_hz)
        self._features = self._features or describe(one, frames, self._env.interface)
        table = self._pa.table({name: self._column(array) for name, array in frames.items()})
        if self._table is not None and self._bytes + table.nbytes > _FILE_MB * 2**20:
            self._table.close()
            self._table, self._bytes, self._file = None, 0, self._file + 1
        chunk, file = divmod(self._file, _FILES_A_CHUNK)
        if self._table is None:
            path = self._folder / "data" / _FILES.format(chunk_index=chunk, file_index=file)
            path.parent.mkdir(parents=True, exist_ok=True)
            self._table = self._parquet.ParquetWriter(path, table.schema)
        self._table.write_table(table)
        self._bytes += table.nbytes
        self._statistics.append(episode_statistics(frames))
        self._rows.append({
            "episode_index": number, "tasks": [self._task], "length": len(one),
            "data/chunk_index": chunk, "data/file_index": file,
            "dataset_from_index": self._frames, "dataset_to_index": self._frames + len(one),
            "meta/episodes/chunk_index": 0, "meta/episodes/file_index": 0,
            "seed": one.seed, "options": json.dumps(one.options), "ending": one.ending, "follower": self._follower,
        })  # fmt: skip
        self._frames += len(one)

    @property
    def _task(self) -> str:
        return _FOLLOWING if self._env.config.task.leader else _EXPLORING

    def _column(self, array: Any) -> Any:
        """Return a column: plain numbers, or lists of lists of fixed lengths."""
        column = self._pa.array(array.ravel())
        for length in reversed(array.shape[1:]):
            column = self._pa.FixedSizeListArray.from_arrays(column, length)
        return column

    def _info(self) -> dict[str, Any]:
        return {
            "codebase_version": VERSION,
            "robot_type": "tagalong",
            "total_episodes": len(self._rows),
            "total_frames": self._frames,
            "total_tasks": 1,
            "chunks_size": _FILES_A_CHUNK,
            "data_files_size_in_mb": _FILE_MB,
            "video_files_size_in_mb": _VIDEO_MB,
            "fps": round(self._env.interface.control_hz),
            "splits": {"train": f"0:{len(self._rows)}"},
            "data_path": f"data/{_FILES}",
            "video_path": None,
            "features": self._features,
        }

    def _write_episodes(self, path: Path) -> None:
        rows = [
            {**row, **{f"stats/{name}/{figure}": values.tolist() for name, figures in one.items()
                       for figure, values in figures.items()}}
            for row, one in zip(self._rows, self._statistics, strict=True)
        ]  # fmt: skip
        path.parent.mkdir(parents=True, exist_ok=True)
        self._parquet.write_table(self._pa.Table.from_pylist(rows), path)

    def _write_tasks(self, path: Path) -> None:
        """Write the tasks as pandas would: the words are the index of the table, which LeRobot looks them up by."""
        index = "__index_level_0__"
        kinds = [("task_index", "task_index", "int64", "int64"), (None, index, "unicode", "object")]
        keys = ("name", "field_name", "pandas_type", "numpy_type")
        told = {
            "index_columns": [index],
            "column_indexes": [],
            "columns": [{**dict(zip(keys, kind, strict=True)), "metadata": None} for kind in kinds],
        }
        table = self._pa.table({"task_index": np.zeros(1, dtype=np.int64), index: [self._task]})
        self._parquet.write_table(table.replace_schema_metadata({"pandas": json.dumps(told)}), path)
