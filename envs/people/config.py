"""Who walks in the building of an environment, and how the robot comes to know of them."""

from dataclasses import dataclass

from ...slam.bounds import Share
from ...slam.errors import InputError, shown
from ..limits.field_checks import People, check_fields
from .behaviours.behaviour import Behaviour, checked_behaviours

PEOPLE_SOURCES = ("tracker", "camera", "truth", "modelled")
"""How the robot comes to know of people."""


@dataclass(frozen=True, kw_only=True)
class PeopleConfig:
    """The people.

    Attributes:
        source: How people reach the onboard stack: "tracker" by their legs in the scans and, if there is a camera, by
            what it sees; "camera" by that alone; "truth" from the simulator; "modelled" from the simulator with the
            errors that the tracker makes, by a statistical model of them.
        people_count: Walking people in the building, the leader included; may be 0 without one. None draws it.
        standing: Further people who come to stand still beside the route.
        heedless: Share of the bystanders who do not see the robot, 0 to 1: they make no room for it and do not wait
            for it, but step aside where they would walk into it. Those of `behaviours` are not among them.
        behaviours: Further people, one for each behaviour, see `tagalong.envs.people`; each begins an
            episode with a copy of the object that stands here.
        leader_style: Manner of the leader: "steady", "hurried", "waits"; None draws one from the seed.
        tracker_errors: Numbers of "modelled": "shipped", or a file that `tagalong train tracker-errors` wrote.
    """

    source: str = "tracker"
    people_count: People | None = 2
    standing: People = 0
    leader_style: str | None = None
    heedless: Share = 0.0
    behaviours: tuple[Behaviour, ...] = ()
    tracker_errors: str = "shipped"

    def __post_init__(self) -> None:
        if not isinstance(self.source, str) or self.source not in PEOPLE_SOURCES:
            raise InputError(
                f"`people` says how people are perceived, one of {', '.join(PEOPLE_SOURCES)}; got {shown(self.source)} "
                "(their number is `people_count`)"
            )
        check_fields(self)
        object.__setattr__(self, "behaviours", checked_behaviours(self.behaviours))
