"""The rules of the house that a program can check."""

import ast
import re
import tomllib
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FLOORS = ["slam", "perception", "envs", "agents", "scripts"]
SOURCES = sorted(p for room in FLOORS for p in (ROOT / room).rglob("*.py"))
HEAVY = {
    "mujoco": {"envs"},
    "torch": {"agents"},
    "stable_baselines3": {"agents"},
    "sb3_contrib": {"agents"},
    "matplotlib": {"scripts"},
}


OF_FOLDERS = {"tagalong.envs.recording", "tagalong.envs.scenes"}
DOORS = {"tagalong", *OF_FOLDERS, *(f"tagalong.{room}" for room in FLOORS if room != "scripts")}
PATHS = [("tagalong", *path.relative_to(ROOT).with_suffix("").parts) for path in SOURCES]
MODULES = {".".join(path).removesuffix(".__init__") for path in PATHS}
MOST_METHODS = 20


@cache
def read(path: Path) -> ast.Module:
    """What a file says."""
    return ast.parse(path.read_text())


def imported(path: Path) -> list[tuple[str, bool]]:
    """The absolute names that a file imports, and whether at import time (not inside a function)."""
    package = ["tagalong", *path.relative_to(ROOT).parts[:-1]]
    tree = read(path)
    top_level = set(map(id, tree.body))
    names = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names += [(alias.name, id(node) in top_level) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            names.append((".".join([*base, *((node.module or "").split("."))]).strip("."), id(node) in top_level))
    return names


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_imports_run_downwards_only(path):
    room = path.relative_to(ROOT).parts[0]
    for name, _ in imported(path):
        parts = name.split(".")
        if parts[0] == "tagalong" and len(parts) > 1 and parts[1] in FLOORS:
            assert FLOORS.index(parts[1]) <= FLOORS.index(room), f"{path} imports {name}"
        if parts[0] in HEAVY:
            assert room in HEAVY[parts[0]], f"{path} imports {name}"


def test_packages_in_pyproject_are_the_folders_with_an_init_file():
    listed = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]
    found = ["tagalong"] + [
        ".".join(["tagalong", *init.parent.relative_to(ROOT).parts])
        for room in FLOORS
        for init in (ROOT / room).rglob("__init__.py")
    ]
    assert sorted(listed) == sorted(found)


def test_tests_are_no_packages():
    assert list((ROOT / "tests").rglob("__init__.py")) == []


def modules_named(path: Path) -> set[str]:
    """The modules of the package that a file imports, or names in a text (as `monkeypatch.setattr` takes them)."""
    names = []
    for node in ast.walk(read(path)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names += [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            names += re.findall(r"^tagalong(?:\.\w+)+$", node.value)
    found = set()
    for name in names:
        while name and name not in MODULES:
            name = name.rpartition(".")[0]
        found.add(name)
    return found - {""}


def test_only_the_tests_of_a_floor_reach_below_its_doors():
    """`tagalong.floor.folder` is as deep as others go; `tagalong.floor.folder.file` is for the tests of that floor.

    The twins in `reference` and the borders in `fuzz` are tests of private parts: each file is about one floor.
    """
    wrong = {}
    for path in sorted((ROOT / "tests").rglob("*.py")):
        folder = path.relative_to(ROOT / "tests").parts[0]
        deep = {name for name in modules_named(path) if name.count(".") > 2}
        floors = {name.split(".")[1] for name in deep} - {folder}
        if len(floors) > (folder in ("reference", "fuzz")):
            wrong[str(path.relative_to(ROOT))] = sorted(name for name in deep if name.split(".")[1] in floors)
    assert wrong == {}


def test_no_source_file_is_longer_than_400_lines_and_no_function_longer_than_50():
    for path in SOURCES:
        assert path.read_text().count("\n") <= 400, path
        for node in ast.walk(read(path)):
            if isinstance(node, ast.FunctionDef):
                assert (node.end_lineno or 0) - node.lineno < 50, f"{path}: {node.name}"


def folders_imported(path: Path) -> set[str]:
    """The folders of the package that a file imports from, its own left out.

    A floor's door only names what it lends, for type checkers, and loads it when it is asked for: that ties nothing.
    """
    tree = read(path)
    of_door = [node for node in tree.body if isinstance(node, ast.If) and path.parent.name in FLOORS]
    left_out = {id(inner) for node in of_door if path.name == "__init__.py" for inner in ast.walk(node)}
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.level and id(node) not in left_out:
            base = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
            for target in (base / alias.name for alias in node.names):
                lies_in = target if target.is_dir() else base if base.is_dir() else base.parent
                found.add(lies_in.relative_to(ROOT).as_posix())
    return found - {path.parent.relative_to(ROOT).as_posix(), "."}


def test_folders_do_not_import_each_other_in_a_circle():
    ties: dict[str, dict[str, str]] = {}
    for path in SOURCES:
        for folder in folders_imported(path):
            ties.setdefault(path.parent.relative_to(ROOT).as_posix(), {})[folder] = path.name

    def reached(start: str) -> set[str]:
        seen, ahead = set(), [start]
        while ahead:
            new = set(ties.get(ahead.pop(), ())) - seen
            seen |= new
            ahead += new
        return seen

    below = {folder: reached(folder) for folder in ties}
    circles = [f"{a}/{name} -> {b}" for a in ties for b, name in ties[a].items() if a in below.get(b, ())]
    assert circles == []


def classes() -> list[tuple[Path, ast.ClassDef]]:
    """Every class of the package, but for those inside functions and classes."""
    nodes = [(path, node) for path in SOURCES for node in read(path).body]
    return [(path.relative_to(ROOT), node) for path, node in nodes if isinstance(node, ast.ClassDef)]


def test_no_class_has_more_than_20_methods():
    counts = {
        f"{path}: {node.name}": sum(isinstance(part, ast.FunctionDef) for part in node.body) for path, node in classes()
    }
    assert {name: count for name, count in counts.items() if count > MOST_METHODS} == {}


def test_no_two_classes_have_the_same_name():
    where: dict[str, list[str]] = {}
    for path, node in classes():
        where.setdefault(node.name, []).append(str(path))
    assert {name: paths for name, paths in where.items() if len(paths) > 1} == {}


README_PROGRAMS = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
SHOWN = {
    **{f"README, program {k}": text for k, text in enumerate(README_PROGRAMS, 1)},
    **{path.name: path.read_text() for path in sorted((ROOT / "examples").rglob("*.py"))},
}


@pytest.mark.parametrize("name", SHOWN)
def test_what_is_shown_to_users_comes_in_by_the_doors(name):
    used = set()
    for node in ast.walk(ast.parse(SHOWN[name])):
        if isinstance(node, ast.Import):
            used |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            used.add(node.module or "")
    assert {module for module in used if module.partition(".")[0] == "tagalong"} <= DOORS
