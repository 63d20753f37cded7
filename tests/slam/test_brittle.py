"""A signal that comes where an exception would break more than what runs is sent again until it does not."""

import os
import signal
import subprocess
import sys
import time

import pytest
from tagalong.slam.processes.brittle import is_brittle, send_again

ASKED = "asked = is_brittle(sys._getframe())"


@pytest.mark.parametrize(
    ("path", "brittle"),
    [
        (os.path.join("site-packages", "numba", "core", "serialize.py"), True),
        (os.path.join("site-packages", "llvmlite", "binding", "executionengine.py"), True),
        (os.path.join("site-packages", "llvmlite", "binding", "ffi.py"), True),
        (os.path.join("multiprocessing", "popen_spawn_posix.py"), True),
        (os.path.join("site-packages", "serialize.py"), False),
        (os.path.join("site-packages", "llvmlite", "ir", "values.py"), False),
    ],
)
def test_what_others_run_for_c_is_brittle(path, brittle):
    found = {"sys": sys, "is_brittle": is_brittle}
    exec(compile(ASKED, path, "exec"), found)
    assert found["asked"] == brittle


def test_an_import_is_brittle(tmp_path, monkeypatch):
    (tmp_path / "asks.py").write_text(f"import sys\nfrom tagalong.slam.processes.brittle import is_brittle\n{ASKED}\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert __import__("asks").asked
    assert not is_brittle(None)


@pytest.mark.skipif(not hasattr(signal, "SIGUSR1"), reason="signals of POSIX")
def test_a_signal_that_is_sent_again_comes_a_little_later():
    came = []
    before = signal.signal(signal.SIGUSR1, lambda number, _: came.append(number))
    try:
        send_again(signal.SIGUSR1)
        assert came == []
        time.sleep(0.5)
        assert came == [signal.SIGUSR1]
    finally:
        signal.signal(signal.SIGUSR1, before)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="signals of POSIX")
def test_a_worker_lets_an_import_end_before_it_ends(tmp_path):
    (tmp_path / "module_of_c.py").write_text("""
import os, signal
try:
    os.kill(os.getpid(), signal.SIGTERM)
    sum(range(1000))
except BaseException:
    os.abort()
""")
    program = """
import time
from tagalong.slam.processes.inside import _take_signals
came = _take_signals()
import module_of_c
print("imported", flush=True)
time.sleep(10.0)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (143, "imported\n")


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="signals of POSIX")
@pytest.mark.parametrize("killed", [True, False])
def test_what_a_signal_leaves_half_made_in_a_worker_says_nothing_of_it(tmp_path, killed):
    program = f"""
import os, signal
from tagalong.slam.processes.inside import _take_signals
class Half:
    def __init__(self):
        if {killed}:
            os.kill(os.getpid(), signal.SIGTERM)
            sum(range(1000))
    def __del__(self):
        self.never_made
_take_signals()
Half()
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == (143 if killed else 0)
    assert ("never_made" in done.stderr) is not killed
