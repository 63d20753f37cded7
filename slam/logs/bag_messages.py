"""Opens ROS 1 bags (a file) and ROS 2 bags (a folder) and hands out their messages by topic; pure Python.

A bag brings the definitions of its messages along, and the library writes and runs a program for each definition that
it is given. It is never given those of a bag: messages are read as ROS itself defines their types.
"""

import bz2
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from ..errors import InputError, MissingExtraError, one_line, shown
from ..files.input import checked_name, named, require_regular, unreadable
from .message_types import MessageTypes

_MAGIC = b"#ROSBAG V"
_NS = 1e-9
MOST_CHUNK = 1 << 28  # bytes; recorders write chunks of one or a few MB, or one message that is larger
_MOST_DESCRIPTION = 1 << 24  # bytes of metadata.yaml: thousands of topics, with all that is said of their quality


class Message(NamedTuple):
    """A message: the time at which it was recorded [s] and its content, as the field names of its type say."""

    recorded_s: float
    content: Any


class Bag:
    """An open bag.

    Attributes:
        types: Of its messages.

    Args:
        reader: The library's reader, open.
        types: Of its messages.
        path: For errors.
    """

    def __init__(self, reader: Any, types: MessageTypes, path: Path) -> None:
        self._reader, self.types = reader, types
        self._path = path

    @property
    def connections(self) -> Sequence[Any]:
        """What the library knows of each topic and who sent it, also of those without messages."""
        return tuple(self._reader.connections)

    @property
    def compression(self) -> str:
        """How the chunks of a ROS 1 bag are compressed: "none", "bz2" or "lz4"; "none" for other bags."""
        chunks = getattr(self._reader, "chunks", None) or {}
        for name, unpack in (("bz2", unpacked_bz2), ("lz4", unpacked_lz4)):
            if any(chunk.decompressor is unpack for chunk in chunks.values()):
                return name
        return "none"

    @property
    def topics(self) -> Mapping[str, str]:
        """The type of each topic that has messages, e.g. {"/scan": "sensor_msgs/msg/LaserScan"}."""
        return {each.topic: each.msgtype for each in self._reader.connections if each.msgcount}

    def of_type(self, *types: str) -> list[str]:
        """Return the topics of one of `types`, in order of name."""
        return sorted(topic for topic, kind in self.topics.items() if kind in types)

    def choose(self, wanted: str | None, kinds: Sequence[str], option: str) -> str | None:
        """Return the one topic whose type is of `kinds`, or the `wanted` one; None: there is none.

        Args:
            wanted: Name that the user gave, or None.
            kinds: Types that its messages may have.
            option: Option of the command line that gives the name, for errors.

        Raises:
            InputError: If the wanted topic is not there, or there are several and none is wanted.
        """
        topics, kind = self.of_type(*kinds), " or ".join(kinds)
        if wanted is None:
            if len(topics) > 1:
                found = " or ".join(sorted({self.topics[topic] for topic in topics}))
                raise InputError(
                    f"{self._path}: several topics of type {found}: {', '.join(topics)}; choose by {option}"
                )
            return topics[0] if topics else None
        for topic in topics:
            if topic.strip("/") == wanted.strip("/"):
                return topic
        raise InputError(
            f"{self._path}: no topic {shown(wanted)} of type {kind}; it has: {', '.join(topics) or 'none'}"
        )

    def messages(self, *topics: str) -> Iterator[Message]:
        """Yield the messages of `topics` in the order of the recording.

        Raises:
            InputError: If the bag is damaged there, lacks all messages of which its index tells, or defines their type
                otherwise than ROS does.
        """
        for _, recorded_s, content in self.with_topics(*topics):
            yield Message(recorded_s, content)

    def with_topics(self, *topics: str) -> Iterator[tuple[str, float, Any]]:
        """Yield topic, time at which it was recorded [s] and content of each message, as `messages` does."""
        wanted, count = [each for each in self._reader.connections if each.topic in topics], 0
        with damage_told(self._path):
            read = self._as_ros_defines(wanted)
            for connection, time_ns, raw in self._reader.messages(wanted) if wanted else ():
                yield connection.topic, time_ns * _NS, read(raw, connection.msgtype)
                count += 1
        if wanted and count == 0:
            raise InputError(f"{self._path}: no readable ROS bag (there is no message of {', '.join(topics)} in it)")

    def raw(self) -> Iterator[tuple[Any, int, bytes]]:
        """Yield all messages as they stand there: connection, time of the recorder [ns], bytes.

        Raises:
            InputError: If the bag is damaged there.
        """
        with damage_told(self._path):
            yield from self._reader.messages(self._reader.connections) if self._reader.connections else ()

    def _as_ros_defines(self, connections: Sequence[Any]) -> Callable[[bytes, str], Any]:
        """Return what reads the messages of `connections`; in ROS 1 each says by a digest how its type is defined."""
        if self.types.ros1:
            for kind, digest in {(each.msgtype, each.digest) for each in connections}:
                if digest not in ("*", self.types.digest(kind)):
                    raise ValueError(f"it defines {kind} otherwise than ROS does")
        return self.types.read


def is_bag(path: str | os.PathLike[str]) -> bool:
    """Return whether `path` is a ROS 1 bag (by its first bytes) or the folder or the one mcap file of a ROS 2 bag."""
    try:
        path = checked_name(path)
        if path.is_dir():
            return (path / "metadata.yaml").is_file()
        if path.suffix in (".bag", ".mcap"):
            return path.is_file()
        require_regular(path)
        with path.open("rb") as file:
            return file.read(len(_MAGIC)) == _MAGIC
    except (OSError, InputError):  # the reader of whatever else it is will say so
        return False


@contextmanager
def open_bag(path: str | os.PathLike[str]) -> Iterator[Bag]:
    """Open a bag; what is wrong with its bytes is said in one line.

    Raises:
        InputError: If it is no bag, or damaged.
        MissingExtraError: If `rosbags` is not installed.
    """
    path = checked_name(path)
    try:
        from rosbags.rosbag1 import Reader as Reader1
        from rosbags.rosbag2 import Reader as Reader2
    except ImportError:
        raise MissingExtraError("ROS bags", "ros") from None
    _require_files(path)
    first = path.is_file() and path.suffix not in (".mcap", ".db3")
    types = MessageTypes(ros1=first)
    with damage_told(path):
        reader: Any = Reader1(path) if first else Reader2(path)
        reader.open()
        if not all(isinstance(name, str) for each in reader.connections for name in (each.topic, each.msgtype)):
            raise ValueError("the name of a topic or of a type is no text")
    try:
        if first:
            _bound_chunks(reader)
        yield Bag(reader, types, path)
    finally:
        reader.close()


def _require_files(path: Path) -> None:
    """Refuse a bag that is, or whose folder holds, anything but files: the library would wait for a pipe."""
    try:
        entries = [each.path for each in os.scandir(path) if not each.is_dir()] if path.is_dir() else [path]
        description = path / "metadata.yaml"
        if path.is_dir() and description.stat().st_size > _MOST_DESCRIPTION:
            raise InputError(f"{named(description)}: is too large; it has at most {_MOST_DESCRIPTION} bytes")
    except OSError as error:
        raise unreadable(path, error) from error
    for each in entries:
        require_regular(each)


def _bound_chunks(reader: Any) -> None:
    """Let no compressed chunk of a ROS 1 bag unpack to more than `MOST_CHUNK`."""
    for position, chunk in reader.chunks.items():
        if chunk.decompressor is bz2.decompress:
            reader.chunks[position] = chunk._replace(decompressor=unpacked_bz2)
        elif "lz4" in chunk.decompressor.__module__:
            reader.chunks[position] = chunk._replace(decompressor=unpacked_lz4)


def unpacked_bz2(data: bytes) -> bytes:
    """Return what bz2 `data` unpacks to, `MOST_CHUNK` bytes at most."""
    return _unpacked(bz2.BZ2Decompressor(), data)


def unpacked_lz4(data: bytes) -> bytes:
    """Return what lz4 `data` unpacks to, `MOST_CHUNK` bytes at most."""
    from lz4.frame import LZ4FrameDecompressor

    return _unpacked(LZ4FrameDecompressor(), data)


def _unpacked(unpacker: Any, data: bytes) -> bytes:
    result = unpacker.decompress(data, MOST_CHUNK)
    if not unpacker.eof:
        raise ValueError(f"a chunk is cut, or unpacks to more than {MOST_CHUNK} bytes")
    return result


@contextmanager
def as_defined(where: str) -> Iterator[None]:
    """Tell in one line that a message holds what its type does not allow."""
    try:
        yield
    except InputError:
        raise
    except (AttributeError, IndexError, OverflowError, TypeError, ValueError) as error:
        raise InputError(f"{where}: a message is not what its type says ({one_line(str(error), 100)})") from error


@contextmanager
def damage_told(path: Path) -> Iterator[None]:
    """Tell in one line what the library finds wrong with a bag; nothing but the library's code runs in here."""
    try:
        yield
    except Exception as error:  # damaged bytes raise whatever struct, lz4, sqlite and the library raise for them
        said = one_line(" ".join(str(error).split()), 200) or type(error).__name__
        hint = "; if it was cut, `rosbag reindex` restores what is there" if "index" in said.lower() else ""
        raise InputError(f"{named(path)}: no readable ROS bag ({said}){hint}") from error
