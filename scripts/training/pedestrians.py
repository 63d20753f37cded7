"""Random people as the laser sees them at shin height: two legs, shoes, trousers, now and then a skirt."""

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from ...envs.simulation2d.outlines import LEG, STATIC, Outlines, cast, turned


def draw_people(rng: Generator, building: Outlines, reach: float, heading: float) -> Outlines:
    """Draw nobody, single people or groups, within `reach` [m] of the laser where `building` does not hide them.

    Args:
        rng: Source of all draws.
        building: What stands around the laser, which is at the origin.
        reach: Farthest place [m].
        heading: Where the middle of the laser's field of view points [rad].
    """
    people = Outlines()
    for _ in range(int(rng.choice([0, 1, 2, 3, 5], p=[0.1, 0.45, 0.3, 0.1, 0.05]))):
        directions = heading + rng.uniform(-2.2, 2.2, 3)
        seen, _ = cast(np.zeros((3, 2)), directions, reach, *building.arrays())
        direction = directions[seen.argmax()]
        distance = rng.uniform(0.35, max(min(seen.max(), reach) - 0.1, 0.5))
        place = distance * np.array([np.cos(direction), np.sin(direction)])
        walking = rng.uniform(-np.pi, np.pi) if rng.random() < 0.5 else direction + rng.normal(0.0, 0.3)
        company = int(rng.choice([1, 2, 3], p=[0.9, 0.08, 0.02]))
        for k in range(company):
            aside = turned(np.array([[0.0, 0.55 * k]]), walking)[0] + rng.normal(0.0, 0.08, 2) * (k > 0)
            draw_person(rng, place + aside, walking, people)
    return people


def draw_person(rng: Generator, place: NDArray[np.float64], heading: float, out: Outlines) -> None:
    """Add one person at `place` (2,) walking or standing towards `heading`."""
    if rng.random() < 0.04:  # a long skirt or coat hides both legs
        out.ellipse(place, rng.uniform(0.12, 0.25), rng.uniform(0.12, 0.22), heading, LEG)
        return
    size = rng.uniform(0.95, 1.5)
    if rng.random() < 0.4:  # walking: feet apart along the way, close together across it
        stride, stance = rng.uniform(0.0, 0.75), rng.uniform(0.0, 0.22)
    elif rng.random() < 0.8:  # the legs almost touch
        stride, stance = abs(rng.normal(0.0, 0.1)), size * rng.uniform(0.12, 0.19)
    else:
        stride, stance = abs(rng.normal(0.0, 0.12)), rng.uniform(0.08, 0.4)
    feet = turned(np.array([[stride, stance], [-stride, -stance]]) * 0.5 * rng.choice([-1.0, 1.0]), heading)
    style, lost = int(rng.choice(4, p=[0.2, 0.4, 0.2, 0.2])), float(rng.choice([0.0, 0.05, 0.25], p=[0.8, 0.12, 0.08]))
    for foot in feet:
        _leg(rng, place + foot, heading + rng.normal(0.0, 0.3), style, size, lost, out)
    if rng.random() < 0.05:  # a stick, a bag
        out.ellipse(place + rng.normal(0.0, 0.35, 2), rng.uniform(0.01, 0.15), rng.uniform(0.01, 0.1), heading, STATIC)


def _leg(
    rng: Generator, place: NDArray[np.float64], heading: float, style: int, size: float, lost: float, out: Outlines
) -> None:
    if style == 0:  # a bare shin or tight trousers
        radius = size * rng.uniform(0.042, 0.06)
        out.ellipse(place, radius, radius * rng.uniform(0.8, 1.0), heading, LEG, lost)
    elif style == 1:  # trousers, flat in any direction
        long = size * rng.uniform(0.06, 0.09)
        out.ellipse(place, long, long * rng.uniform(0.35, 1.0), heading + rng.choice([0.0, np.pi / 2]), LEG, lost)
    elif style == 2:  # folds and flares
        out.ellipse(place, size * rng.uniform(0.05, 0.08), size * rng.uniform(0.045, 0.065), heading, LEG, lost)
        fold = place + rng.normal(0.0, 0.03, 2)
        out.ellipse(fold, size * rng.uniform(0.03, 0.07), size * rng.uniform(0.02, 0.05), heading, LEG, lost)
    else:  # an ankle with its shoe, or the shoe alone
        ahead = turned(np.array([[rng.uniform(0.02, 0.07), 0.0]]), heading)[0]
        out.ellipse(place + ahead, size * rng.uniform(0.09, 0.13), size * rng.uniform(0.038, 0.052), heading, LEG, lost)
        out.ellipse(place, size * rng.uniform(0.04, 0.06), size * rng.uniform(0.04, 0.055), heading, LEG, lost)
