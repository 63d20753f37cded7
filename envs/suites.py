"""Test suites: which episodes a follower is judged by."""

from dataclasses import dataclass, field, replace
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


def _cell(name: str, scene: str, people: int, lidar: dict[str, Any] | None = None, **options: Any) -> Scenario:
    arguments = {"scene": scene, "split": "test", **(lidar or {})}
    return Scenario(name=name, env="tagalong/Office-v0", arguments=arguments, options={"people": people + 1, **options})


_HURRIED: dict[str, Any] = {"leader_style": "hurried"}
_SHORT: dict[str, Any] = {"lidar.range_max": 4.0}
HARD_CELLS = (
    _cell("doors 0.9 m, 6", "tight_office", 6),
    _cell("doors 0.9 m, 10 hurried", "tight_office", 10, **_HURRIED),
    _cell("doors 0.9 m, 10 hurried slipping", "tight_office", 10, odometry="slipping", **_HURRIED),
    _cell("doors 0.9 m, 10 hurried laser 4 m", "tight_office", 10, _SHORT, **_HURRIED),
    _cell("office 12 hurried laser 4 m", "office", 12, _SHORT, **_HURRIED),
    _cell("rooms in a row 0.9 m, 6 hurried", "narrow_doors", 6, **_HURRIED),
    _cell("doorway 0.9 m, 10 hurried", "tight_doorway", 10, **_HURRIED),
    _cell("doorway 0.9 m, 14", "tight_doorway", 14),
    _cell("corridor 1.9-2.4 m, 12", "narrow_corridor", 12),
    _cell("corridor 5.6 m, 28", "wide_corridor", 28),
    _cell("crossing 4.8 m, 18", "busy_crossing", 18),
    _cell("clutter 30, 20", "packed_clutter", 20),
)
"""Where following is hardest; fixed: a change of a cell is a new suite with a new number."""
HEEDLESS = 1.0
"""Share of the bystanders in the second suite who do not see the robot. Where everybody makes room for it, crowds are
easy: who does not see it stands in the doors, too."""


def _heedless(cell: Scenario) -> Scenario:
    return replace(cell, options={**cell.options, "heedless": HEEDLESS})


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
    "hard-v1": HARD_CELLS,
    "hard-v2": tuple(_heedless(cell) for cell in HARD_CELLS),
    "follow-bench-printed": (
        _heedless(_cell("crossing 4.8 m, 20", "busy_crossing", 20)),
        _heedless(_cell("clutter 20, 30", "clutter", 30)),
    ),
}
"""Name -> scenarios; episode k is of scenario k modulo their number, with seed `FIRST_SEED` + k. Of the crowds of
"follow-bench-printed" its paper has figures (20 people who cross; 20 obstacles, 30 people); a change is a new name."""


def suite(name: str) -> tuple[Scenario, ...]:
    """Return the scenarios of a suite.

    Raises:
        InputError: If there is none of that name.
    """
    if name not in SUITES:
        raise unknown_name("suite", name, tuple(SUITES))
    return SUITES[name]
