"""What the copies of all kinds of bags have in common."""

from collections.abc import Iterator
from typing import NamedTuple, Protocol

from ..message_types import MessageTypes


class RawMessage(NamedTuple):
    """A message as it stands in a bag.

    Attributes:
        topic: Its name.
        kind: Type, e.g. "sensor_msgs/msg/LaserScan".
        time_ns: When it was recorded [ns].
        raw: Its bytes.
    """

    topic: str
    kind: str
    time_ns: int
    raw: bytes


class StorageCopy(Protocol):
    """A file of messages on its way into another file: all that it holds goes there as it is, and more is added."""

    def add_topic(self, topic: str, kind: str, types: MessageTypes) -> None:
        """Declare a topic of messages of type `kind`, which is one of `types`."""
        ...

    def messages(self) -> Iterator[RawMessage]:
        """Copy all messages, each before it is handed out, in the order of the file."""
        ...

    def write(self, topic: str, time_ns: int, raw: bytes) -> None:
        """Add a message of a topic that was added."""
        ...

    def finish(self) -> None:
        """Write what closes the file."""
        ...

    def close(self) -> None:
        """Let go of both files, finished or not."""
        ...


def standard_name(kind: str) -> str:
    """Return the name of a type with its middle part, which some recorders leave out."""
    package, _, name = kind.rpartition("/")
    return kind if not package or "/" in package else f"{package}/msg/{name}"
