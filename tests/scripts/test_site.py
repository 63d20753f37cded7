"""The site: every page is found, every program and command on it runs, and what is made of the code is made.

What takes longer than some seconds stands under `<!-- takes N minutes -->`, or under that and "and the recordings",
and is run where TAGALONG_SITE_MINUTES is at least N; what a machine may lack, under `<!-- needs WHAT -->`. What is not
run is read by the command's own parser.
"""

import ast
import math
import os
import re
import runpy
import shlex
import sys
import tomllib
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from tagalong.scripts import cli
from tagalong.scripts.site import environments, markers, pages, reference
from tagalong.slam import InputError, LaserScan, RecordedDrive
from tagalong.slam.logs import open_recording, write_carmen

ROOT = Path(__file__).resolve().parents[2]
NAV = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").partition("\nnav:\n")[2]
BLOCK = re.compile(
    r"(?:<!-- (?:takes (\d+) minutes?( and the recordings)?|(needs) [^>]+) -->\n+)?^```(python|console)\n(.*?)^```$",
    flags=re.M | re.S,
)
PATIENCE = float(os.environ.get("TAGALONG_SITE_MINUTES", "0"))
"""Blocks that take longer are not run [min]."""
RECORDINGS = os.environ.get("TAGALONG_DATA")
DOORS = {"tagalong", *(f"tagalong.{door}" for door in reference.DOORS)}
OTHER_PROGRAMS = {"export TAGALONG_DATA=DIR"}
"""Lines that are neither tagalong, make nor pip."""


class Block(NamedTuple):
    """A fence of a page."""

    page: str
    name: str
    minutes: float
    language: str
    text: str


def blocks() -> Iterator[Block]:
    """Every block of programs and commands of the pages that are written by hand, and of two that are made."""
    texts = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in hand_written()}
    made = [("environments/meetingroom-v0.md", environments.environment_page("tagalong/MeetingRoom-v0"))]
    for page, text in [*sorted(texts.items()), *made]:
        for number, found in enumerate(BLOCK.finditer(text), 1):
            lacks = found[3] or (found[2] and RECORDINGS is None)
            yield Block(
                page, f"{page}, block {number}", math.inf if lacks else float(found[1] or 0), found[4], found[5]
            )


def hand_written() -> list[Path]:
    return sorted((ROOT / "docs").rglob("*.md"))


BLOCKS = list(blocks())
PROGRAMS = [block for block in BLOCKS if block.language == "python"]
COMMANDS = [block for block in BLOCKS if block.language == "console"]


def room_drive() -> RecordedDrive:
    """A short drive along a square room, with time stamps."""
    bearings = np.linspace(-np.pi / 2, np.pi / 2, 181)
    odometry = np.stack((np.arange(12) * 0.1, np.zeros(12), np.zeros(12)), axis=-1)
    scans = []
    for number, x in enumerate(odometry[:, 0]):
        ahead = (4.0 - x) / np.maximum(np.cos(bearings), 1e-9)
        aside = 2.0 / np.maximum(np.abs(np.sin(bearings)), 1e-9)
        scans.append(LaserScan(np.minimum(ahead, aside), bearings, 0.1, 30.0, 0.1 * number))
    return RecordedDrive(odometry, scans, None, "drive")


@pytest.fixture
def folder(tmp_path):
    """A folder with a recorded drive, as a log and as a bag."""
    drive = room_drive()
    write_carmen(tmp_path / "drive.log.gz", drive)
    pytest.importorskip("rosbags")
    with open_recording(tmp_path / "drive.mcap") as recording:
        for odometry, scan in zip(drive.odometry, drive.scans, strict=True):
            recording.scan(scan)
            recording.odometry(scan.time_s, odometry)
    return tmp_path


@pytest.mark.parametrize("block", PROGRAMS, ids=lambda block: block.name)
def test_a_program_of_the_site_runs(block, folder, monkeypatch, capsys):
    if block.minutes > PATIENCE:
        return
    if "write_minari" in block.text:
        pytest.importorskip("minari")
    if "stable_baselines3" in block.text:
        pytest.importorskip("stable_baselines3")
    monkeypatch.chdir(folder)
    name = "my_module.py" if block.text.startswith("# my_module.py") else "program.py"
    (folder / name).write_text(block.text, encoding="utf-8")
    runpy.run_path(str(folder / name), run_name="__main__")
    assert capsys.readouterr().out or name == "my_module.py"


@pytest.mark.parametrize("block", PROGRAMS, ids=lambda block: block.name)
def test_a_program_of_the_site_comes_in_by_the_doors(block):
    used = set()
    for node in ast.walk(ast.parse(block.text)):
        if isinstance(node, ast.Import):
            used |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            used.add(node.module or "")
    assert {name for name in used if name.partition(".")[0] == "tagalong"} <= DOORS


@pytest.mark.parametrize("page", sorted({block.page for block in COMMANDS}))
def test_the_commands_of_a_page_run_one_after_the_other_or_are_at_least_understood(page, folder, monkeypatch):
    """A page is one test: its later commands read what the earlier ones wrote."""
    monkeypatch.chdir(folder)
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("TAGALONG_DATA", str(folder))
    if PATIENCE > 0.0 and RECORDINGS is not None:
        (folder / "DATA").symlink_to(RECORDINGS)
        (folder / "recordings").symlink_to(Path(RECORDINGS) / "legs")
    monkeypatch.delitem(sys.modules, "my_module", raising=False)  # another page's
    for block in BLOCKS:
        if block.page != page:
            continue
        if block.language == "console":
            follow(block)
        elif block.text.startswith("# my_module.py"):  # that the page has the reader write
            (folder / "my_module.py").write_text(block.text, encoding="utf-8")
        elif 0.0 < PATIENCE >= block.minutes:  # long commands may read what it writes
            exec(compile(block.text, block.name, "exec"), {"__name__": "__main__"})


def follow(block: Block) -> None:
    """Run, parse or look up every command of a block."""
    for line in block.text.splitlines():
        assert line.startswith("$ "), f"{block.name}: a command begins with `$ `: {line}"
        words = shlex.split(line.removeprefix("$ "), comments=True)
        if words[0] == "tagalong":
            run_or_parse(words[1:], block)
        elif words[0] == "make":
            assert re.search(rf"^{words[1]}:", (ROOT / "Makefile").read_text(), flags=re.M), line
        elif words[:2] == ["pip", "install"]:
            extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
            assert re.fullmatch(rf"\.(\[({'|'.join(extras)})\])?", words[2]), line
        else:
            assert " ".join(words) in OTHER_PROGRAMS, line


def run_or_parse(words: list[str], block: Block) -> None:
    """Run a command, or see whether it understands its words where it takes long or needs what is not here."""
    parser = cli.make_parser()
    parser.parse_args(words)
    if words[0] == "record" and find_spec("minari") is None:
        return
    if any(word.endswith(".rrd") for word in words) and find_spec("rerun") is None:
        return
    if words[0] == "data" and len(words) > 1:
        return
    slow = words[0] in ("demo", "doctor")
    if block.minutes <= PATIENCE and (PATIENCE > 0.0 or not slow):
        assert cli.main(words) == 0, (block.name, words)


def test_commands_within_a_sentence_name_what_there_is(capsys):
    """They may leave out what is clear; what they do name, a command or an option, must be one."""
    for path in [*hand_written(), ROOT / "README.md"]:
        text = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.M | re.S)
        for command in re.findall(r"`(tagalong [^`|\\]+)`", text):
            words = shlex.split(command)[1:]
            if words[0] == "ros":  # a node reads its own
                continue
            options = [word for word in words if word.startswith("--")]
            bare = words[: words.index(options[0])] if options else words
            with pytest.raises(SystemExit, match=r"^0$"):
                pytest.fail(f"{command}: {cli.make_parser().parse_args([*bare, '--help'])}")
            told = capsys.readouterr().out
            for option in options:
                assert re.search(rf"{option}\b(?!-)", told), (path.name, command)


def test_every_marker_is_one_that_is_understood():
    known = r"takes \d+ minutes?( and the recordings)?|needs .+|made: .+|fuzz table: (begin|end)"
    for path in hand_written():
        for marker in re.findall(r"<!-- ([^>]*) -->", path.read_text(encoding="utf-8")):
            assert re.fullmatch(known, marker), (path.name, marker)


def test_a_page_that_the_navigation_lacks_is_named_here():
    """A page that is in `docs/` but not in the nav of mkdocs.yml is built, and nobody finds it: add a line there."""
    listed = set(re.findall(r"([\w./-]+\.md)$", NAV, flags=re.M))
    written = {path.relative_to(ROOT / "docs").as_posix() for path in hand_written()}
    made = {environments.page_name(name).join(("environments/", "")) for name in environments.IDS}
    made |= {f"reference/{door}.md" for door in reference.DOORS}
    assert sorted((written | made) - listed) == []
    assert sorted(listed - written - made - set(pages.FROM_ROOT.values())) == [
        "environments/index.md",
        "reference/commands.md",
        "reference/index.md",
    ]


def test_every_extra_of_the_package_is_told_on_the_first_page_of_instructions():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    told = re.findall(r"^\| `(\w+)` \|", (ROOT / "docs" / "start.md").read_text(), flags=re.M)
    assert set(told) == set(extras) - {"dev"}


def test_every_public_door_has_a_page():
    files = [path for path in ROOT.glob("*/**/__init__.py") if path.relative_to(ROOT).parts[0] != "build"]
    lending = [path for path in files if "= lends(" in path.read_text()]
    found = {".".join(path.relative_to(ROOT).parts[:-1]) for path in lending} | {"envs.scenes"}
    assert set(reference.DOORS) == found


def test_markers_are_replaced_and_unknown_ones_refused():
    made = markers.with_made_parts("<!-- made: parameters tagalong.slam.GMappingConfig -->", ROOT)
    assert "| `particles` | `30` | 1 .. 1000 | Number of particles. |" in made
    assert "| `slam/gmapping/motion.py` |" in markers.with_made_parts("<!-- made: files slam/gmapping -->", ROOT)
    with pytest.raises(InputError, match="unknown kind"):
        markers.with_made_parts("<!-- made: nonsense slam -->", ROOT)
    with pytest.raises(InputError, match="no file or folder"):
        markers.with_made_parts("<!-- made: files slam/nonsense -->", ROOT)


def test_links_between_pages_lead_to_pages():
    """Also without mkdocs, which checks anchors, too."""
    made = {"environments/index.md", "reference/index.md", "reference/commands.md"}
    made |= {f"reference/{door}.md" for door in reference.DOORS}
    made |= {f"environments/{environments.page_name(name)}" for name in environments.IDS}
    known = {(ROOT / "docs" / name).resolve() for name in made | set(pages.FROM_ROOT.values())}
    wrong = []
    for path in hand_written():
        for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", path.read_text(encoding="utf-8")):
            target = (path.parent / link).resolve()
            if not target.is_file() and target not in known:
                wrong.append(f"{path.relative_to(ROOT)}: {link}")
    assert wrong == []


def test_every_environment_and_every_method_has_a_picture_that_is_there():
    for path in hand_written():
        for picture in re.findall(r"!\[[^]]*\]\(([^)]+)\)", path.read_text(encoding="utf-8")):
            assert (path.parent / picture).is_file(), f"{path.name}: {picture}"
    scenes = {str(arguments["scene"]) for arguments in environments.IDS.values()}
    assert {path.stem for path in (ROOT / "docs" / "images" / "environments").glob("*.webp")} == scenes
