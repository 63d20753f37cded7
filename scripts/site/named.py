"""Modules of the package by the names that pages of the documentation, or tables here, give them."""

from importlib import import_module
from typing import Any

from ...slam.errors import InputError


def module_named(name: str) -> Any:
    """Return a module of the package, such as "slam.logs".

    Raises:
        InputError: If there is none.
    """
    try:
        return import_module(f"...{name}", __package__)
    except ModuleNotFoundError as error:
        raise InputError(f"no module {name!r} in the package") from error


def thing_named(name: str) -> Any:
    """Return what a module of the package holds, such as "slam.gmapping.config.GMappingConfig".

    Raises:
        InputError: If there is no such module, or nothing of the name in it.
    """
    module, _, last = name.rpartition(".")
    try:
        return getattr(module_named(module), last)
    except AttributeError as error:
        raise InputError(f"no {last!r} in the module {module!r}") from error
