"""What things look like: paint, wood, clothing, skin, and the light in the room.

A geom's look is one colour, or two in a pattern. Patterns are solid: they are cut out of a field that fills the space
of the geom, so that no texture has to be laid on any shape.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..people.body import PARTS
from ..physics.mj import MjModel
from .pattern import SurfacePattern
from .wardrobe import Outfit, draw_outfit, wardrobe

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Looks:
    """Colours of g geoms; red, green, blue in [0, 1].

    Attributes:
        first: (g, 3) colour.
        second: (g, 3) the other colour of a pattern.
        pattern: (g,) `SurfacePattern`.
        period: (g,) how often the pattern repeats [m].
    """

    first: Array
    second: Array
    pattern: NDArray[np.int64]
    period: Array


_SKINS = np.array([(0.94, 0.78, 0.67), (0.86, 0.66, 0.52), (0.71, 0.50, 0.36), (0.50, 0.33, 0.23), (0.33, 0.22, 0.16)])
_HAIR = np.array([(0.08, 0.07, 0.06), (0.25, 0.16, 0.09), (0.45, 0.30, 0.16), (0.75, 0.62, 0.38), (0.6, 0.6, 0.6)])


def dress(model: MjModel, rng: np.random.Generator, outfits: tuple[Outfit, ...] | None = None) -> Looks:
    """Draw paint for the building and clothing for its people, light the room, and write both into `model`.

    OpenGL then shows the first colours; patterns are seen by the ray caster alone.

    Args:
        model: The compiled world; its geoms' colours are where the drawing starts.
        rng: Source of all draws.
        outfits: What the people wear whose shapes are in the model; None draws colours for bodies without.
    """
    count = model.ngeom
    first = np.array(model.geom_rgba[:, :3], dtype=np.float64)
    first = np.clip(first * rng.uniform(0.8, 1.15, (count, 1)) + rng.normal(0.0, 0.03, (count, 3)), 0.03, 0.97)
    looks = Looks(first, first.copy(), np.zeros(count, dtype=np.int64), np.full(count, 0.3))
    for geom in np.flatnonzero(rng.random(count) < 0.4).tolist():
        _pattern(looks, geom, SurfacePattern.GRAIN, first[geom] * rng.uniform(0.7, 0.9), rng.uniform(0.3, 0.9))
    people = [body for body in range(model.nbody) if model.body(body).name.startswith("person")]
    for person in range(len(people) // len(PARTS)):
        outfit = outfits[person] if outfits is not None else draw_outfit(rng, wardrobe("everyday"))
        _dress_person(model, people[person * len(PARTS) : (person + 1) * len(PARTS)], looks, outfit, rng)
    model.geom_rgba[:, :3] = looks.first
    _light(model, rng)
    return looks


def _pattern(looks: Looks, geom: int, pattern: SurfacePattern, second: Array, period: float) -> None:
    looks.pattern[geom], looks.second[geom], looks.period[geom] = pattern, second, period


def _dress_person(model: MjModel, bodies: list[int], looks: Looks, outfit: Outfit, rng: np.random.Generator) -> None:
    """Dress one person: shirt with a pattern, trousers, shoes, skin, hair."""
    skin = np.clip(_SKINS[rng.integers(len(_SKINS))] * rng.uniform(0.92, 1.05), 0.0, 1.0)
    hair = np.clip(_HAIR[rng.integers(len(_HAIR))] * rng.uniform(0.8, 1.2), 0.0, 1.0)
    shoes = np.full(3, rng.uniform(0.05, 0.5))
    plain = {"skin": skin, "hair": hair, "trousers": outfit.trousers, "shoes": shoes, "extra": outfit.extra_colour}
    for part, body in zip(PARTS, bodies, strict=True):
        geoms = np.arange(model.ngeom)[model.geom_bodyid == body]
        for number, geom in enumerate(geoms.tolist()):
            cloth = _cloth(model.geom(geom).name, part, number, outfit)
            looks.pattern[geom] = SurfacePattern.PLAIN
            if cloth == "head":
                looks.first[geom] = skin
                _pattern(looks, geom, SurfacePattern.HEAD, hair, 1.0)
            elif cloth == "shirt":
                looks.first[geom] = outfit.shirt
                _pattern(looks, geom, outfit.pattern, outfit.second, outfit.period)
            else:
                looks.first[geom] = plain[cloth]


def _cloth(name: str, part: str, number: int, outfit: Outfit) -> str:
    """Return what covers a geom: the third word of its name where an outfit brought it, else by its part."""
    if len(name.split()) > 3:
        return name.split()[2]
    if part in ("head", "torso"):
        return "head" if part == "head" else "shirt"
    if part.endswith("shin") and number == 1:
        return "shoes"
    return "skin" if outfit.garment == "shorts" and part.endswith("shin") else "trousers"


def _light(model: MjModel, rng: np.random.Generator) -> None:
    """Set the strength and the direction of the room's light; nothing shines or casts a shadow."""
    ambient = rng.uniform(0.3, 0.5)
    model.vis.headlight.ambient[:] = ambient
    model.vis.headlight.diffuse[:] = rng.uniform(0.1, 0.35)
    model.vis.headlight.specular[:] = 0.0
    tint = rng.uniform(0.9, 1.0, 3)
    for light in range(model.nlight):
        tilt, turn = rng.uniform(0.1, 0.9), rng.uniform(-np.pi, np.pi)
        model.light_dir[light] = (np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), -np.cos(tilt))
        model.light_diffuse[light] = rng.uniform(0.3, 0.6) * tint
        model.light_ambient[light] = 0.0
        model.light_specular[light] = 0.0
        model.light_castshadow[light] = False


def colours(looks: Looks, geom: NDArray[np.int32], local: Array) -> Array:
    """Return (k, 3) the colour of k points.

    Args:
        looks: Colours of all geoms.
        geom: (k,) the geom of each point.
        local: (k, 3) the points in their geoms' own frames [m].
    """
    pattern, period = looks.pattern[geom], looks.period[geom]
    share = np.zeros(len(geom))
    cells = np.floor(local / period[:, None] * 2.0).astype(np.int64)
    share = np.where(pattern == SurfacePattern.STRIPES, cells[:, 2] % 2, share)
    share = np.where(pattern == SurfacePattern.CHECKS, cells.sum(axis=1) % 2, share)
    scaled = local / period[:, None]
    grain = np.sin(9.0 * scaled[:, 0] + 4.0 * np.sin(5.0 * scaled[:, 1])) * np.sin(7.0 * scaled[:, 2] + scaled[:, 1])
    share = np.where(pattern == SurfacePattern.GRAIN, 0.5 + 0.5 * grain, share)
    haired = (local[:, 2] > 0.05) | (local[:, 0] < 0.02 * np.sign(local[:, 2]))
    share = np.where(pattern == SurfacePattern.PANEL, (local[:, 0] > 0.0) & (np.abs(local[:, 1]) < 0.05), share)
    share = np.where(pattern == SurfacePattern.HEAD, haired & (local[:, 2] > -0.06), share)
    return looks.first[geom] + share[:, None] * (looks.second[geom] - looks.first[geom])
