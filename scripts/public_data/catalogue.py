"""The catalogue of recordings, `catalogue.json`: whose they are, where they come from, what rests on them."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from .digest import content_digest

_FILE = Path(__file__).with_name("catalogue.json")
OK, DAMAGED, MISSING = "ok", "damaged", "missing"
"""How a file is found."""


@dataclass(frozen=True)
class RecordedFile:
    """A file of a collection.

    Attributes:
        path: Below the folder of the data, with slashes.
        sha256: Checksum of what it holds, as `content_digest` takes it.
        made_from: What it derives from; "" for an original.
        how: In which way; "" for an original.
    """

    path: str
    sha256: str
    made_from: str = ""
    how: str = ""

    def state_in(self, folder: Path) -> str:
        """Return how the file is found in a folder: `OK`, `DAMAGED` (it holds something else) or `MISSING`."""
        place = folder / self.path
        if not place.is_file():
            return MISSING
        return OK if content_digest(place) == self.sha256 else DAMAGED


@dataclass(frozen=True)
class Collection:
    """Recordings of one place by the same people.

    Attributes:
        name: What it is called here.
        collector: Who recorded it.
        origin: Where it can be had.
        licence: On what terms.
        figures: What rests on it.
        files: Its files.
    """

    name: str
    collector: str
    origin: str
    licence: str
    figures: str
    files: tuple[RecordedFile, ...]


def catalogue() -> Iterator[Collection]:
    """Yield all collections."""
    for each in json.loads(_FILE.read_text(encoding="utf-8"))["collections"]:
        files = tuple(
            RecordedFile(f"{each['folder']}/{file['name']}", file["sha256"], file.get("from", ""), file.get("how", ""))
            for file in each["files"]
        )
        yield Collection(each["name"], each["collector"], each["origin"], each["licence"], each["figures"], files)
