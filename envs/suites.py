"""Test suites: which episodes a follower is judged by."""

from dataclasses import dataclass, field
from typing import Any

from ..slam.errors import unknown_name

FIRST_SEED = 1_000_000
"""Seeds of suites begin here; training takes smaller ones."""


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """One kind of episode.

    Attributes:
        name: In reports.
        env: Id of the environment.
        arguments: Keyword arguments of the environment.
        options: Options of `reset`.
    """

    name: str
    env: str
    arguments: dict[str, Any] = field(default_factory=dict)
    options: dict[str, Any] = field(default_factory=dict)


def _crowded(env: str, counts: range, **arguments: Any) -> tuple[Scenario, ...]:
    return tuple(
        Scenario(name=f"{count - 1} bystanders", env=env, arguments=arguments, options={"people": count})
        for count in counts
    )


SUITES: dict[str, tuple[Scenario, ...]] = {
    "corridor": (Scenario(name="corridor", env="tagalong/Corridor-v0", arguments={"people_count": None}),),
    "meeting_room": (Scenario(name="meeting_room", env="tagalong/MeetingRoom-v0", arguments={"people_count": None}),),
    "office": (Scenario(name="office", env="tagalong/Office-v0", arguments={"split": "test"}),),
    "floor_plan": (Scenario(name="floor_plan", env="tagalong/FloorPlan-v0"),),
    "hurried": (
        Scenario(
            name="hurried", env="tagalong/Office-v0", arguments={"split": "test"}, options={"leader_style": "hurried"}
        ),
    ),
    "crowd": _crowded("tagalong/Office-v0", range(9, 14), split="test"),
    "follow-bench": tuple(
        Scenario(name=name, env="tagalong/Office-v0", arguments={"scene": name}, options={"people": 9})
        for name in ("narrow_corridor", "doorway", "intersection", "clutter")
    ),
}
"""Name -> scenarios; episode k is of scenario k modulo their number, with seed `FIRST_SEED` + k."""


def suite(name: str) -> tuple[Scenario, ...]:
    """Return the scenarios of a suite.

    Raises:
        InputError: If there is none of that name.
    """
    if name not in SUITES:
        raise unknown_name("suite", name, tuple(SUITES))
    return SUITES[name]
