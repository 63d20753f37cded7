"""Who calls a command for the first time is told why it takes so long."""

import io
import sys

from tagalong.scripts.console.first_call import HINT, kernels_are_kept, tell_first_call


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_the_hint_is_given_at_a_terminal_until_something_was_compiled(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(sys, "stderr", Terminal())
    assert not kernels_are_kept()
    tell_first_call()
    assert sys.stderr.getvalue() == f"tagalong: {HINT}\n"
    (tmp_path / "slam").mkdir()
    (tmp_path / "slam" / "kernel.nbi").write_bytes(b"")
    tell_first_call()
    assert sys.stderr.getvalue().count(HINT) == 1


def test_no_hint_is_given_where_nobody_reads_it(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    tell_first_call()
    assert capsys.readouterr().err == ""
