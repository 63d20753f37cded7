"""What people wear and how they hold themselves, as a camera sees it; the laser sees the shins alone.

There are two wardrobes without a pose of the arms, a pattern, a bag or hat, or a hue of a colour in common: the people
of the environment wear one, the people of the frames that a detector is trained on the other.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import unknown_name
from .pattern import SurfacePattern

Array = NDArray[np.float64]

ARMS: dict[str, tuple[tuple[float, ...], tuple[float, ...]]] = {
    "relaxed": ((-0.03, 0.07, -0.27, 0.07, 0.06, -0.5), (-0.03, 0.07, -0.27, 0.07, 0.06, -0.5)),
    "pockets": ((-0.09, 0.12, -0.25, 0.05, 0.02, -0.43), (-0.09, 0.12, -0.25, 0.05, 0.02, -0.43)),
    "hips": ((-0.06, 0.22, -0.18, 0.04, 0.02, -0.37), (-0.06, 0.22, -0.18, 0.04, 0.02, -0.37)),
    "crossed": ((0.05, 0.07, -0.26, 0.2, -0.18, -0.2), (0.05, 0.07, -0.26, 0.18, -0.2, -0.16)),
    "calls": ((-0.02, 0.05, -0.28, 0.03, 0.06, -0.53), (0.13, 0.12, -0.2, 0.05, -0.06, 0.09)),
    "cup": ((0.03, 0.05, -0.27, 0.26, -0.02, -0.2), (-0.05, 0.06, -0.27, 0.02, 0.06, -0.52)),
    "hanging": ((0.0, 0.04, -0.28, 0.03, 0.05, -0.54), (0.0, 0.04, -0.28, 0.03, 0.05, -0.54)),
    "swinging": ((0.11, 0.04, -0.26, 0.27, 0.04, -0.46), (-0.12, 0.05, -0.25, -0.2, 0.05, -0.48)),
    "reads": ((0.02, 0.06, -0.28, 0.28, -0.1, -0.16), (0.02, 0.06, -0.28, 0.28, -0.1, -0.16)),
    "behind": ((-0.11, 0.08, -0.25, -0.18, -0.14, -0.4), (-0.11, 0.08, -0.25, -0.18, -0.14, -0.42)),
    "waves": ((0.0, 0.05, -0.28, 0.02, 0.06, -0.53), (0.04, 0.22, 0.04, 0.08, 0.24, 0.31)),
    "carries": ((0.0, 0.08, -0.27, 0.28, 0.04, -0.27), (0.0, 0.08, -0.27, 0.28, 0.04, -0.27)),
}
"""Pose -> elbow and hand of the left and of the right arm, from the shoulder: forward, outward, up [m]."""


@dataclass(frozen=True, kw_only=True)
class Wardrobe:
    """What there is to choose from.

    Attributes:
        arms: Poses of the arms, keys of `ARMS`.
        garments: Below the waist and over it: "trousers", "shorts", "skirt", "coat".
        extras: "none" or something carried or worn on the head.
        patterns: Of the shirt.
        hues: Bands (from, to) of hues of shirts and trousers, in turns of the colour circle.
    """

    arms: tuple[str, ...]
    garments: tuple[str, ...]
    extras: tuple[str, ...]
    patterns: tuple[SurfacePattern, ...]
    hues: tuple[tuple[float, float], ...]


WARDROBES: dict[str, Wardrobe] = {
    "everyday": Wardrobe(
        arms=("relaxed", "pockets", "hips", "crossed", "calls", "cup"),
        garments=("trousers", "shorts", "coat"),
        extras=("none", "none", "backpack", "hat", "bun"),
        patterns=(SurfacePattern.PLAIN, SurfacePattern.CHECKS, SurfacePattern.PANEL),
        hues=((0.0, 1.0 / 6.0), (1.0 / 3.0, 0.5), (2.0 / 3.0, 5.0 / 6.0)),
    ),
    "training": Wardrobe(
        arms=("hanging", "swinging", "reads", "behind", "waves", "carries"),
        garments=("trousers", "skirt"),
        extras=("none", "none", "cap", "long hair", "bag"),
        patterns=(SurfacePattern.PLAIN, SurfacePattern.STRIPES, SurfacePattern.GRAIN),
        hues=((1.0 / 6.0, 1.0 / 3.0), (0.5, 2.0 / 3.0), (5.0 / 6.0, 1.0)),
    ),
}
"""Name -> wardrobe. People without any pattern, and without bag or hat, are in both."""


@dataclass(frozen=True, kw_only=True)
class Outfit:
    """One person's clothing and pose.

    Attributes:
        arms: Pose of the arms.
        mirrored: Whether left and right arm are exchanged.
        long_sleeves: Whether the sleeves reach the hands.
        garment: Below the waist.
        extra: What is carried, or worn on the head.
        shoulders: Half of the distance between the shoulders [m].
        depth: Half of the depth of the chest [m].
        pattern: Of the shirt.
        period: Of the pattern [m].
        shirt: (3,) colour.
        second: (3,) the other colour of its pattern.
        trousers: (3,) colour.
        extra_colour: (3,) of what is carried.
    """

    arms: str
    mirrored: bool
    long_sleeves: bool
    garment: str
    extra: str
    shoulders: float
    depth: float
    pattern: SurfacePattern
    period: float
    shirt: Array
    second: Array
    trousers: Array
    extra_colour: Array


def wardrobe(name: str) -> Wardrobe:
    """Return the wardrobe called `name`.

    Raises:
        InputError: If there is none of this name.
    """
    if name not in WARDROBES:
        raise unknown_name("wardrobe", name, tuple(WARDROBES))
    return WARDROBES[name]


def draw_outfit(rng: np.random.Generator, choice: Wardrobe) -> Outfit:
    """Return somebody's clothing out of `choice`."""
    return Outfit(
        arms=choice.arms[rng.integers(len(choice.arms))],
        mirrored=bool(rng.random() < 0.5),
        long_sleeves=bool(rng.random() < 0.6),
        garment=choice.garments[rng.integers(len(choice.garments))],
        extra=choice.extras[rng.integers(len(choice.extras))],
        shoulders=rng.uniform(0.15, 0.2),
        depth=rng.uniform(0.1, 0.15),
        pattern=choice.patterns[rng.integers(len(choice.patterns))],
        period=rng.uniform(0.05, 0.25),
        shirt=_colour(rng, choice.hues),
        second=_colour(rng, choice.hues),
        trousers=_colour(rng, choice.hues) * rng.uniform(0.3, 0.9),
        extra_colour=_colour(rng, choice.hues),
    )


def _colour(rng: np.random.Generator, hues: tuple[tuple[float, float], ...]) -> Array:
    """Return (3,) red, green, blue of a hue within `hues`, of any saturation and brightness."""
    low, high = hues[rng.integers(len(hues))]
    hue, saturation, value = rng.uniform(low, high), rng.uniform(0.1, 0.9), rng.uniform(0.1, 0.95)
    wheel = np.clip(np.abs((hue * 6.0 + np.array([0.0, 4.0, 2.0])) % 6.0 - 3.0) - 1.0, 0.0, 1.0)
    return value * (1.0 - saturation + saturation * wheel)
