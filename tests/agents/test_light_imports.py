"""Importing the package, and its followers, loads nothing heavy."""

import subprocess
import sys

import pytest

HEAVY = ("mujoco", "torch", "stable_baselines3", "numba", "sklearn", "matplotlib")


@pytest.mark.parametrize("module", ["tagalong", "tagalong.agents"])
def test_importing_is_light(module):
    code = f"import sys, {module}; print([name for name in {HEAVY} if name in sys.modules])"
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == "[]"
