"""MCAP files, record by record: messages, channels, attachments, metadata."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from ...errors import MissingExtraError
from ..bag_messages import MOST_CHUNK, damage_told, unpacked_lz4
from ..message_types import MessageTypes
from .storage import RawMessage, standard_name

DESCRIPTION = ("rosbag2", "serialized_metadata")
"""Name of the record, and key in it, by which ROS 2 keeps a copy of metadata.yaml in the file."""


class McapCopy:
    """An MCAP file on its way into another: records in the same order, compressed as the first chunk was.

    Schemas and channels may get other numbers.

    Args:
        source: The file.
        target: Where the copy goes.
        described: Turns the description that ROS 2 keeps in the file into that of the copy.

    Raises:
        MissingExtraError: If `mcap` is not installed.
    """

    def __init__(self, source: Path, target: Path, described: Callable[[str], str]) -> None:
        try:
            from mcap import records, stream_reader, writer
        except ImportError:
            raise MissingExtraError("MCAP files to be written", "ros") from None
        self._records, self._stream, self._library = records, stream_reader, writer
        self._path, self._described = source, described
        self._source, self._target = source.open("rb"), target.open("wb")
        self._writer: Any = None
        self._wanted: list[tuple[str, str, MessageTypes]] = []
        self._schemas: dict[int, tuple[int, str]] = {0: (0, "")}  # old number -> new one, name
        self._channels: dict[int, tuple[int, str, str]] = {}  # old number -> new one, topic, type
        self._added: dict[str, int] = {}
        self._later: list[Any] = []

    def add_topic(self, topic: str, kind: str, types: MessageTypes) -> None:
        """Declare a topic; its channel is written before the first message."""
        self._wanted.append((topic, kind, types))

    def messages(self) -> Iterator[RawMessage]:
        """Copy all records; hand out the messages, in the order of the file."""
        with damage_told(self._path):
            for record in self._unpacked_records():
                message = self._copy(record)
                if message is not None:
                    yield message

    def _unpacked_records(self) -> Iterator[Any]:
        limit = 2 * MOST_CHUNK
        reader = self._stream.StreamReader(self._source, emit_chunks=True, record_size_limit=limit)
        header: Any = None
        for record in reader.records:
            if isinstance(record, self._records.Header):
                header = record
                continue
            if self._writer is None:
                packing = record.compression if isinstance(record, self._records.Chunk) else ""
                self._begin(header, packing)
            if isinstance(record, self._records.Chunk):
                record.data, record.compression = _unpacked(record), ""
                yield from self._stream.breakup_chunk(record)
            elif isinstance(record, self._records.DataEnd):  # what follows is the index
                return
            else:
                yield record

    def _begin(self, header: Any, packing: str) -> None:
        kinds = self._library.CompressionType
        kind = {"zstd": kinds.ZSTD, "lz4": kinds.LZ4}.get(packing, kinds.NONE)
        self._writer = self._library.Writer(self._target, compression=kind)
        self._writer.start(header.profile, header.library)
        for topic, name, types in self._wanted:
            schema = self._writer.register_schema(name, "ros2msg", types.definition(name)[0].encode())
            self._added[topic] = self._writer.register_channel(topic, "cdr", schema, {"offered_qos_profiles": ""})

    def _copy(self, record: Any) -> RawMessage | None:
        kinds, writer = self._records, self._writer
        if isinstance(record, kinds.Message):
            number, topic, kind = self._channels[record.channel_id]
            writer.add_message(number, record.log_time, record.data, record.publish_time, record.sequence)
            return RawMessage(topic, kind, record.log_time, record.data)
        if isinstance(record, kinds.Schema) and record.id not in self._schemas:
            number = writer.register_schema(record.name, record.encoding, record.data)
            self._schemas[record.id] = number, standard_name(record.name)
        elif isinstance(record, kinds.Channel) and record.id not in self._channels:
            schema, kind = self._schemas[record.schema_id]
            number = writer.register_channel(record.topic, record.message_encoding, schema, record.metadata)
            self._channels[record.id] = number, record.topic, kind
        elif isinstance(record, kinds.Attachment):
            said = record.name, record.media_type, record.data
            writer.add_attachment(record.create_time, record.log_time, *said)
        elif isinstance(record, kinds.Metadata):
            self._later.append(record)
        return None

    def write(self, topic: str, time_ns: int, raw: bytes) -> None:
        """Add a message."""
        self._writer.add_message(self._added[topic], time_ns, raw, time_ns)

    def finish(self) -> None:
        """Write the metadata, the description of the bag among them, and the index."""
        if self._writer is None:
            with damage_told(self._path):
                raise ValueError("there is nothing in it")
        for record in self._later:
            name, key = DESCRIPTION
            if record.name == name and key in record.metadata:
                record.metadata[key] = self._described(record.metadata[key])
            self._writer.add_metadata(record.name, record.metadata)
        self._writer.finish()

    def close(self) -> None:
        """Let go of both files."""
        self._source.close()
        self._target.close()


def _unpacked(chunk: Any) -> bytes:
    """Return the records of a chunk, which unpack to no more than `MOST_CHUNK` bytes."""
    if chunk.uncompressed_size > MOST_CHUNK:
        raise ValueError(f"a chunk unpacks to more than {MOST_CHUNK} bytes")
    if chunk.compression == "lz4":
        return unpacked_lz4(chunk.data)
    if chunk.compression == "zstd":
        import zstandard

        with zstandard.ZstdDecompressor().stream_reader(chunk.data) as stream:
            data = stream.read(chunk.uncompressed_size + 1)
        if len(data) != chunk.uncompressed_size:
            raise ValueError("a chunk does not unpack to the size that it says")
        return data
    if chunk.compression:
        raise ValueError(f"a chunk is compressed by {chunk.compression!r}")
    return bytes(chunk.data)
