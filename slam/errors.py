"""Errors that a user can cause; the command line prints them in one line and exits with 2."""


class InputError(ValueError):
    """Bad input from outside (file, argument, configuration). The message names the thing, the rule, what was got."""


class WorkerError(RuntimeError):
    """A worker process is gone, or gives no sign of life. The message says which one, and how it ended."""


class MissingExtraError(ImportError):
    """An optional dependency is needed that is not installed.

    Args:
        what: The feature that needs it, e.g. "figures".
        extra: The name of the extra in pyproject.toml that brings it, e.g. "viz".
    """

    def __init__(self, what: str, extra: str) -> None:
        super().__init__(f'{what} need the extra "{extra}": pip install "tagalong[{extra}]"')
        self.what, self.extra = what, extra

    def __reduce__(self) -> tuple[object, ...]:
        """Come whole through a pipe between processes."""
        return type(self), (self.what, self.extra), self.__dict__


def unknown_name(kind: str, name: object, known: "list[str] | tuple[str, ...]") -> InputError:
    """Return the error for a name that is not in a table, listing those that are."""
    return InputError(f"unknown {kind} {name!r}; {kind}s: {', '.join(sorted(known))}")
