"""What only Linux and macOS have is not needed: it is looked for where it is used, and there is another way."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
ROOMS = ("slam", "perception", "envs", "agents", "scripts")
SOURCES = sorted(path for room in ROOMS for path in (ROOT / room).rglob("*.py"))
POSIX = ("fcntl", "grp", "pwd", "resource", "syslog", "termios", "tty", "pty")
MISSING_ON_WINDOWS = {"os": {"fork", "forkpty", "getuid", "O_NONBLOCK", "mkfifo"}, "signal": {"SIGKILL", "SIGHUP"}}
GUARDED = {"slam/processes/inside.py"}
"""Files that use such a name under `sys.platform == "linux"`."""
WITHOUT = f"""
import sys
for name in {POSIX!r}:
    sys.modules[name] = None
"""


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_no_file_uses_what_windows_has_not(path):
    used = {
        f"{node.value.id}.{node.attr}"
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)
        if node.attr in MISSING_ON_WINDOWS.get(node.value.id, ())
    }
    assert used == set() or path.relative_to(ROOT).as_posix() in GUARDED


def test_everything_but_training_can_be_imported_without_what_only_posix_has():
    names = [".".join(("tagalong", *path.relative_to(ROOT).with_suffix("").parts)) for path in SOURCES]
    wanted = [name for name in names if not name.endswith("__main__") and ".training." not in name]
    program = f"{WITHOUT}from importlib import import_module\nfor name in {wanted!r}:\n    import_module(name)\n"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-1000:]


def test_a_log_is_mapped_without_what_only_posix_has(tmp_path):
    log = "\n".join(f"FLASER 5 2 2 3 2 2 {0.1 * k} 0 0 {0.1 * k} 0 0 {k} host {k}" for k in range(5))
    (tmp_path / "drive.log").write_text(log + "\n")
    program = f"{WITHOUT}from tagalong.scripts.cli import main\n"
    program += "sys.exit(main(['slam', 'drive.log', '--out', 'out', '--quiet']))"
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-1000:]
    assert '"peak_memory_mb": null' in (tmp_path / "out" / "timing.json").read_text()


def test_no_file_names_a_fixed_temporary_folder():
    named = [path for path in SOURCES if '"/tmp' in path.read_text(encoding="utf-8")]
    assert named == []
