"""Kernels that an older version of the package has left compiled on the disk."""

import importlib
import os
import sys

import pytest

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
    assert list((tmp_path / "__pycache__").glob("*.nbi"))
    sys.modules.pop(name)
