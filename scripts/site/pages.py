"""Writes the folder of pages: what stands in `docs/`, completed, and what is made of the code."""

import re
import shutil
from collections.abc import Iterator
from pathlib import Path

from ...slam.errors import InputError
from .commands import commands_page
from .environments import environment_pages
from .equations import with_equations
from .markers import with_made_parts
from .reference import reference_pages

FROM_ROOT = {"CHANGELOG.md": "changelog.md", "CONTRIBUTING.md": "contributing.md", "SECURITY.md": "security.md"}
"""Page in the root of the repository -> its name in the documentation."""


def write_pages(root: Path, folder: Path) -> None:
    """Write all pages.

    Args:
        root: Folder of the repository.
        folder: Where to; what is in it is removed.

    Raises:
        InputError: If two pages have one name, or a marker names what is not there.
    """
    if folder.exists():
        shutil.rmtree(folder)
    shutil.copytree(root / "docs", folder, ignore=shutil.ignore_patterns("*.md", "__pycache__"))
    for path, text in all_pages(root):
        target = folder / path
        if target.exists():
            raise InputError(f"two pages of the documentation are called {path}")
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(with_equations(text), encoding="utf-8")


def all_pages(root: Path) -> Iterator[tuple[str, str]]:
    """Yield (path, Markdown) of every page."""
    yield from written_pages(root)
    yield from environment_pages()
    yield from reference_pages()
    yield commands_page()


def written_pages(root: Path) -> Iterator[tuple[str, str]]:
    """Yield (path, Markdown) of the pages that are written by hand, those of the root among them."""
    for path in sorted((root / "docs").rglob("*.md")):
        name = path.relative_to(root / "docs").as_posix()
        yield name, _linked(with_made_parts(path.read_text(encoding="utf-8"), root), "../" * (name.count("/") + 1), "")
    for name, page in FROM_ROOT.items():
        yield page, _linked((root / name).read_text(encoding="utf-8"), "", "docs/")


def _linked(text: str, up: str, below: str) -> str:
    """Return a page whose links to and from pages of the root lead to where those stand in the documentation.

    Args:
        text: Markdown.
        up: What leads from the page to the root of the repository.
        below: What stands before the names of other pages, "docs/" in pages of the root.
    """
    depth = "../" * max(up.count("../") - 1, 0)
    for name, page in FROM_ROOT.items():
        text = re.sub(rf"\]\({re.escape(up + name)}(#[^)]*)?\)", rf"]({depth}{page}\1)", text)
    return re.sub(rf"\]\({re.escape(below)}", "](", text) if below else text
