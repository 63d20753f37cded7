"""ROS 1 bags, message by message."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..bag_messages import Bag
from ..message_types import MessageTypes
from .storage import RawMessage


class Ros1Copy:
    """A ROS 1 bag on its way into another, compressed as it was.

    The library keeps the index of both in memory: some 300 bytes a message.

    Args:
        source: The bag, open.
        target: Where the copy goes; nothing must be there.
    """

    def __init__(self, source: Bag, target: Path) -> None:
        from rosbags.rosbag1 import Writer

        self._source, self._writer = source, Writer(target)
        if source.compression != "none":
            self._writer.set_compression(Writer.CompressionFormat[source.compression.upper()])
        self._writer.open()
        self._added: dict[str, Any] = {}
        known: dict[Any, Any] = {}  # a publisher that came twice has two connections that say the same
        self._copies = {each.id: known.get(_said(each)) or self._copy(each, known) for each in source.connections}

    def _copy(self, connection: Any, known: dict[Any, Any]) -> Any:
        topic, kind, text, digest, caller, latching = said = _said(connection)
        known[said] = self._writer.add_connection(
            topic, kind, msgdef=text, md5sum=digest, callerid=caller, latching=latching
        )
        return known[said]

    def add_topic(self, topic: str, kind: str, types: MessageTypes) -> None:
        """Declare a topic."""
        text, digest = types.definition(kind)
        self._added[topic] = self._writer.add_connection(topic, kind, msgdef=text, md5sum=digest)

    def messages(self) -> Iterator[RawMessage]:
        """Copy all messages, in the order of their times."""
        for connection, time_ns, raw in self._source.raw():
            self._writer.write(self._copies[connection.id], time_ns, raw)
            yield RawMessage(connection.topic, connection.msgtype, time_ns, raw)

    def write(self, topic: str, time_ns: int, raw: bytes) -> None:
        """Add a message."""
        self._writer.write(self._added[topic], time_ns, raw)

    def finish(self) -> None:
        """Write the index."""
        self._writer.close()

    def close(self) -> None:
        """Let go of the copy."""
        self._writer.abort()


def _said(connection: Any) -> tuple[Any, ...]:
    ext = connection.ext
    return connection.topic, connection.msgtype, connection.msgdef.data, connection.digest, ext.callerid, ext.latching
