"""How the door of a floor lends its public names: each module is imported when a name of it is first asked for."""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def lends(package: str, home: Mapping[str, str]) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Return `__getattr__` and `__dir__` of a package (PEP 562).

    Args:
        package: Its name.
        home: Public name -> module of the package.
    """

    def get(name: str) -> Any:
        if name not in home:
            listed = ", ".join(sorted(home))
            raise AttributeError(f"module {package!r} has no attribute {name!r}; public names: {listed}")
        return getattr(import_module(f".{home[name]}", package), name)

    return get, lambda: sorted(home)
