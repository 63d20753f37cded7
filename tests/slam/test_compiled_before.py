"""Kernels that an older version of the package has left compiled on the disk."""

import importlib
import os
import subprocess
import sys

import numba
import pytest
from tagalong.slam import view_kernel

MODULE = """
from typing import NamedTuple

from tagalong.slam.view_kernel import inner_view_kernel, view_kernel


class {name}(NamedTuple):
    value: float


@inner_view_kernel
def {inner}(numbers: {name}) -> float:
    return {factor} * numbers.value


@{decorator}
def outer(numbers: {name}) -> float:
    return {inner}(numbers)


def answer():
    return outer({name}(3.0))
"""


@pytest.mark.parametrize("decorator", ["view_kernel", "kernel"])
def test_a_type_that_is_gone_is_no_reason_to_stop(tmp_path, monkeypatch, decorator):
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "kept"))  # wherever this machine keeps kernels
    name = f"kernels_of_{decorator}"
    for k, (kind, factor) in enumerate((("Before", 2.0), ("After", 5.0))):
        words = MODULE.format(name=kind, inner="inner", factor=factor, decorator=decorator)
        file = tmp_path / f"{name}.py"
        file.write_text(
            words.replace("import inner_view_kernel, view_kernel", "import inner_view_kernel, kernel, view_kernel")
        )
        os.utime(file, (1e9 + k, 1e9 + k))
        sys.modules.pop(name, None)
        importlib.invalidate_caches()
        assert importlib.import_module(name).answer() == 3.0 * factor
    assert list((tmp_path / "kept").rglob("*.nbi"))
    sys.modules.pop(name)


CALLED = """
from tagalong.slam.view_kernel import inner_kernel


@inner_kernel
def called(x: float) -> float:
    return {factor} * x
"""
CALLS = """
import {called} as one
from tagalong.slam.view_kernel import kernel
from that_counts import STEP


@kernel
def between(x: float) -> float:
    return one.called(x)


@kernel
def outer(x: float) -> float:
    return between(x) + STEP
"""


def test_a_kernel_is_compiled_anew_where_what_it_calls_or_a_number_of_another_file_has_changed(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "that_calls.py").write_text(CALLS.format(called="that_is_called"))
    for k, (factor, step) in enumerate(((2.0, 1.0), (5.0, 1.0), (5.0, 4.0))):
        file = tmp_path / "that_is_called.py"
        file.write_text(CALLED.format(factor=factor))
        (tmp_path / "that_counts.py").write_text(f"STEP = {step}\n")
        for one in (file, tmp_path / "that_counts.py"):
            os.utime(one, (1e9 + k, 1e9 + k))
        for name in ("that_calls", "that_is_called", "that_counts"):
            sys.modules.pop(name, None)
        importlib.invalidate_caches()
        view_kernel._content.cache_clear()  # as a new process reads it
        assert importlib.import_module("that_calls").outer(3.0) == 3.0 * factor + step
    for name in ("that_calls", "that_is_called", "that_counts"):
        sys.modules.pop(name)


def test_the_same_files_are_the_same_kernels_to_every_process(tmp_path):
    words = (
        "from tagalong.slam.view_kernel import _stamp; from tagalong.perception.tracking import following; "
        "from tagalong.agents.planned import plan_kernel; "
        "print(_stamp(following.follow.py_func), _stamp(plan_kernel.plan_costs.py_func))"
    )
    told = [
        subprocess.run([sys.executable, "-c", words], capture_output=True, text=True, check=True, cwd=tmp_path).stdout
        for _ in range(2)
    ]
    assert told[0] == told[1]
    assert len(set(told[0].split())) == 2
