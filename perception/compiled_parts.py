"""What is compiled together at the first use: people are looked for on a short drive round a room."""

from ..slam.first_use.parts import round_the_room
from .people_filter import PeopleFilter


def track_people() -> None:
    """Find legs, track people, take them out of scans."""
    people_filter, drive = PeopleFilter(), round_the_room(5)
    for odometry, scan in zip(drive.odometry, drive.scans, strict=True):
        _ = people_filter.update(scan, odometry).without_people
