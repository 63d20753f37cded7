"""The table of matchers."""

from collections.abc import Callable
from typing import Any

from ..errors import InputError, unknown_name
from ..settings import with_settings
from .genetic import SIZES
from .global_matcher import GlobalConfig, GlobalMatcher
from .hybrid import HybridConfig, HybridMatcher
from .iterative import ICP, MBICP, PLICP, IterativeMatcher
from .lookup import LookupConfig
from .match import Matcher

_HYBRIDS = {
    "pga": HybridConfig(fitness="polar", refine=False),
    "glasm": HybridConfig(lookup=LookupConfig(pattern="square"), refine=False),
    "glasm-g": HybridConfig(refine=False),
    **{f"hglasm-g-{size}": HybridConfig(genetic=genetic) for size, genetic in SIZES.items()},
}

_MATCHERS: dict[str, tuple[Callable[[Any], Matcher], Any]] = {
    "icp": (IterativeMatcher, ICP),
    "plicp": (IterativeMatcher, PLICP),
    "mbicp": (IterativeMatcher, MBICP),
    **{name: (HybridMatcher, config) for name, config in _HYBRIDS.items()},
    "global": (GlobalMatcher, GlobalConfig()),
}

MATCHERS = tuple(_MATCHERS)


def make_matcher(name: str, **config: Any) -> Matcher:
    """Return a new scan matcher.

    Args:
        name: "icp", "plicp", "mbicp"; "pga", "glasm", "glasm-g" (genetic searches alone, in the large space),
            "hglasm-g-small", "hglasm-g-medium", "hglasm-g-large"; "global".
        config: Fields of the matcher's configuration that differ from its preset, e.g. `polish=True`; those of a part
            of it by their path, e.g. `**{"lookup.cell": 0.05}`.

    Raises:
        InputError: If the name or a field is unknown, or a value is out of its range.
    """
    if name not in _MATCHERS:
        raise unknown_name("scan matcher", name, MATCHERS)
    make, preset = _MATCHERS[name]
    try:
        return make(with_settings(preset, config))
    except InputError as error:
        raise InputError(f"scan matcher {name!r}: {error}") from error
