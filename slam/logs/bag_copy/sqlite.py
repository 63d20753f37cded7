"""The sqlite files of ROS 2 bags: the copy is the file itself, with rows added."""

import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from ...errors import InputError, one_line
from ...files.input import named
from ..message_types import MessageTypes
from .storage import RawMessage, standard_name


@contextmanager
def _damage_told(path: Path) -> Iterator[None]:
    """Tell in one line what sqlite finds wrong with a file, or with the copy of it."""
    try:
        yield
    except sqlite3.Error as error:
        raise InputError(f"{named(path)}: no readable ROS bag ({one_line(str(error), 200)})") from error


class SqliteCopy:
    """A sqlite file on its way into another.

    Args:
        source: The file.
        target: Where the copy goes.
    """

    def __init__(self, source: Path, target: Path) -> None:
        self._path = source
        shutil.copyfile(source, target)
        self._file = sqlite3.connect(target, isolation_level=None)
        with _damage_told(source):
            self._file.execute("PRAGMA journal_mode=OFF")  # a copy that is not finished is thrown away
            self._file.execute("PRAGMA synchronous=OFF")
            self._file.execute("BEGIN")
        self._added: dict[str, int] = {}

    def add_topic(self, topic: str, kind: str, types: MessageTypes) -> None:
        """Declare a topic."""
        with _damage_told(self._path):
            self._add_topic(topic, kind, types)

    def _add_topic(self, topic: str, kind: str, types: MessageTypes) -> None:
        text, digest = types.definition(kind)
        row = {"name": topic, "type": kind, "serialization_format": "cdr", "offered_qos_profiles": ""}
        self._added[topic] = self._insert("topics", {**row, "type_description_hash": digest})
        known = self._columns("message_definitions")
        if (
            known
            and not self._file.execute("SELECT 1 FROM message_definitions WHERE topic_type = ?", (kind,)).fetchone()
        ):
            row = {"topic_type": kind, "encoding": "ros2msg", "encoded_message_definition": text}
            self._insert("message_definitions", {**row, "type_description_hash": digest})

    def _insert(self, table: str, row: dict[str, str]) -> int:
        """Insert what of `row` the table has columns for, older versions have fewer; return the number of the row."""
        names = [name for name in self._columns(table) if name in row]
        places = ", ".join("?" * len(names))
        command = f"INSERT INTO {table} ({', '.join(names)}) VALUES ({places})"  # noqa: S608  (names of our own)
        done = self._file.execute(command, [row[name] for name in names])
        return int(done.lastrowid or 0)

    def _columns(self, table: str) -> list[str]:
        return [str(row[1]) for row in self._file.execute(f"PRAGMA table_info({table})")]

    def messages(self) -> Iterator[RawMessage]:
        """Hand out all messages, in the order of their times; the copy has them already."""
        wanted = (
            "SELECT topics.name, topics.type, messages.timestamp, messages.data FROM messages "
            "JOIN topics ON messages.topic_id = topics.id ORDER BY messages.timestamp"
        )
        address = f"{self._path.resolve().as_uri()}?immutable=1"
        with _damage_told(self._path), closing(sqlite3.connect(address, uri=True)) as source:
            for topic, kind, time_ns, raw in source.execute(wanted):
                yield RawMessage(topic, standard_name(kind), time_ns, raw)

    def write(self, topic: str, time_ns: int, raw: bytes) -> None:
        """Add a message."""
        row = self._added[topic], time_ns, raw
        with _damage_told(self._path):
            self._file.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)", row)

    def finish(self) -> None:
        """Commit what was added."""
        with _damage_told(self._path):
            self._file.execute("COMMIT")

    def close(self) -> None:
        """Let go of the copy."""
        self._file.close()
