"""A follower of one's own, by the name of its module and class."""

import os
import sys
from collections.abc import Callable
from importlib import import_module
from inspect import signature
from typing import Any

from ...envs.task.interface import FollowInterface
from ...slam.errors import InputError, one_line, shown
from .follower import Follower


def load_follower(path: str, interface: FollowInterface) -> Follower:
    """Return a new follower of the class, or from the function, at `path`.

    Args:
        path: "module:name" or "package.module:name"; modules in the current folder are found, too.
        interface: Scales of the environment; handed over if there is a parameter called `interface`.

    Raises:
        InputError: If there is no such module or name, or what it makes cannot `reset` and `act`.
    """
    module_name, _, name = path.partition(":")
    if os.getcwd() not in sys.path:
        sys.path.insert(0, os.getcwd())
    try:
        if module_name.startswith("."):
            raise ValueError("a module's name does not begin with a dot")
        make = getattr(import_module(module_name), name)
    except (ImportError, AttributeError, ValueError, SyntaxError, OSError) as error:
        told = one_line(str(error), 200)
        raise InputError(f"a follower of your own is named as module:class, got {shown(path)} ({told})") from error
    if not callable(make):
        what = f"{shown(path)}: {shown(make)}"
        raise InputError(f"a follower of your own is a class or a function that makes one, got {what}")
    follower = _made(make, path, interface)
    if not (callable(getattr(follower, "reset", None)) and callable(getattr(follower, "act", None))):
        raise InputError(f"a follower has `reset()` and `act(observation)`; {path} has not")
    return follower


def _made(make: Callable[..., Any], path: str, interface: FollowInterface) -> Any:
    try:
        asked = signature(make)
        arguments = {"interface": interface} if "interface" in asked.parameters else {}
        asked.bind(**arguments)
    except (TypeError, ValueError) as error:  # ValueError: some built-in things do not tell what they take
        raise InputError(f"{path} is made without arguments, or with `interface` alone ({error})") from error
    return make(**arguments)
