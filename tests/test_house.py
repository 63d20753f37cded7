"""The rules of the house that a program can check."""

import ast
import tomllib
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


def imported(path: Path) -> list[tuple[str, bool]]:
    """The absolute names that a file imports, and whether at import time (not inside a function)."""
    package = ["tagalong", *path.relative_to(ROOT).parts[:-1]]
    tree = ast.parse(path.read_text())
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


def test_no_source_file_is_longer_than_400_lines_and_no_function_longer_than_50():
    for path in SOURCES:
        text = path.read_text()
        assert text.count("\n") <= 400, path
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef):
                assert (node.end_lineno or 0) - node.lineno < 50, f"{path}: {node.name}"
