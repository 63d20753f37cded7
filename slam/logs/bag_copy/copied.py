"""Copies a bag: everything as it is, and more topics."""

import os
from collections.abc import Generator, Iterator, Mapping
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path, PurePath
from typing import Any

from ...errors import InputError
from ...files.input import checked_name, named
from ...files.output import new_folder, replacing
from ..bag_messages import open_bag
from ..message_types import MessageTypes
from .description import NAME, described
from .mcap import McapCopy
from .ros1 import Ros1Copy
from .sqlite import SqliteCopy
from .storage import RawMessage, StorageCopy


class FileCopy:
    """One file of a bag on its way into another.

    Args:
        storage: What copies it.
        types: Of its messages.
        added: Topics that are added, and the type of each.
        counts: Where the added messages of each are counted.
    """

    def __init__(
        self, storage: StorageCopy, types: MessageTypes, added: Mapping[str, str], counts: dict[str, int]
    ) -> None:
        self._storage, self._types, self._added, self._counts = storage, types, added, counts
        for topic, kind in added.items():
            storage.add_topic(topic, kind, types)

    def messages(self) -> Iterator[RawMessage]:
        """Copy all messages, each before it is handed out."""
        return self._storage.messages()

    def write(self, topic: str, time_ns: int, message: Any) -> None:
        """Add a message of one of the added topics, recorded at `time_ns` [ns]."""
        self._storage.write(topic, time_ns, self._types.write(message, self._added[topic]))
        self._counts[topic] += 1


@contextmanager
def copied_bag(
    source: str | os.PathLike[str], target: str | os.PathLike[str], types: MessageTypes, added: Mapping[str, str]
) -> Iterator[Iterator[FileCopy]]:
    """Copy a bag to `target`, whole or not at all, with topics added; what it holds is as it was, byte for byte.

    Each file of the bag is handed out in turn; it is copied by going through its messages to the end.

    Args:
        source: A ROS 1 bag, an MCAP file, or the folder of a ROS 2 bag (sqlite or MCAP).
        target: Likewise; a folder must not be there yet.
        types: Of its messages.
        added: Topics to be added, and the type of each.

    Raises:
        InputError: If the bag cannot be read, is compressed file by file, or the target cannot be written.
        MissingExtraError: If a library is not installed.
    """
    source = checked_name(source)
    if source.is_dir():
        with new_folder(target) as folder, closing(_folder(source, folder, types, added)) as files:
            yield files
        return
    with replacing(target) as file:
        if source.suffix == ".mcap":
            with closing(_mcap(source, file, types, added, dict.fromkeys(added, 0))) as files:
                yield files
            return
        with open_bag(source) as bag:
            file.unlink()  # the library makes its own
            counts = dict.fromkeys(added, 0)
            with closing(_finished(Ros1Copy(bag, file), types, added, counts)) as files:
                yield files


def _finished(
    storage: StorageCopy, types: MessageTypes, added: Mapping[str, str], counts: dict[str, int]
) -> Generator[FileCopy, None, None]:
    """Yield the copy of one file; finish it, when it comes back."""
    with closing(storage):
        yield FileCopy(storage, types, added, counts)
        storage.finish()


def _mcap(
    source: Path, target: Path, types: MessageTypes, added: Mapping[str, str], counts: dict[str, int]
) -> Generator[FileCopy, None, None]:
    description = partial(described, added=added, types=types, counts=[counts])
    return _finished(McapCopy(source, target, description), types, added, counts)


def _folder(
    source: Path, folder: Path, types: MessageTypes, added: Mapping[str, str]
) -> Generator[FileCopy, None, None]:
    from ruamel.yaml import YAML

    text = (source / NAME).read_text(encoding="utf-8")
    bag = YAML(typ="safe").load(text)["rosbag2_bagfile_information"]
    packing = (bag.get("compression_mode") or "none").lower()
    if packing not in ("none", "storage"):
        raise InputError(f"{named(source)}: is compressed by {packing}: unpack it first (`ros2 bag convert`)")
    counts: list[dict[str, int]] = []
    for name in (PurePath(each).name for each in bag["relative_file_paths"]):
        counts.append(dict.fromkeys(added, 0))
        files = source / name, folder / name
        if bag["storage_identifier"] == "sqlite3":
            yield from _finished(SqliteCopy(*files), types, added, counts[-1])
        else:
            yield from _mcap(*files, types, added, counts[-1])
    (folder / NAME).write_text(described(text, added, types, counts), encoding="utf-8")
