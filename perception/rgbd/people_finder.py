"""People in RGB-D frames: clusters and heads (Munaro et al. 2012), gradients, a small network."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import check_numbers
from ...slam.errors import InputError
from ...slam.geometry import transform_points
from ...slam.view_kernel import kernel
from .frame import RgbdFrame
from .heads import Candidates, HeadConfig, find_candidates
from .people import RgbdPeople, nobody
from .person_classifier import DEPTH_MODEL, PersonClassifier, candidate_features
from .planes import Planes, Surface

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class PeopleFinderConfig:
    """Parameters of `PeopleFinder`.

    Attributes:
        heads: Of the candidates.
        least_likelihood: Candidates below this are nobody, in [0, 1].
        least_of_legs: The same of legs alone, which the picture's upper edge cuts below the hips. Furniture that is cut
            there looks like them: in recorded frames of a source that was not trained on, what was taken for legs had
            likelihoods of 0.5 to 0.95, and nearly all were nobody.
        behind: The middle of a body is this far behind what is seen of it [m].
        apart: Two people are at least this far from each other; the likelier one stays [m].
        ragged: Pixels beside a person, and this near to it in space, are its too [m].
        without_floor: Whether people are looked for though the floor is not known: the camera counts as level then,
            and `RgbdPeople.floor_known` says so.
    """

    heads: HeadConfig = field(default_factory=HeadConfig)
    least_likelihood: float = 0.5
    least_of_legs: float = 0.9
    behind: float = 0.08
    apart: float = 0.35
    ragged: float = 0.15
    without_floor: bool = True

    def __post_init__(self) -> None:
        check_numbers(self)
        for name in ("least_likelihood", "least_of_legs"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise InputError(f"`{name}` must be in [0, 1], got {getattr(self, name)}")
        for name in ("behind", "apart", "ragged"):
            if not getattr(self, name) >= 0.0:
                raise InputError(f"`{name}` of the people finder must not be negative [m], got {getattr(self, name)}")


class PeopleFinder:
    """Finds people in frames, each by itself.

    Args:
        classifier: The classifier; `PersonClassifier.load()` is the shipped one.
        config: Parameters.
        depth_classifier: The classifier of frames without colour; None: `classifier` is.
    """

    def __init__(
        self,
        classifier: PersonClassifier,
        config: PeopleFinderConfig | None = None,
        depth_classifier: PersonClassifier | None = None,
    ) -> None:
        self._config = config or PeopleFinderConfig()
        self._classifier, self._depth_classifier = classifier, depth_classifier or classifier

    @classmethod
    def load(cls, config: PeopleFinderConfig | None = None) -> "PeopleFinder":
        """Return a finder with the shipped classifiers."""
        return cls(PersonClassifier.load(), config, PersonClassifier.load(DEPTH_MODEL))

    def find(self, frame: RgbdFrame, planes: Planes) -> RgbdPeople:
        """Return the people in `frame`, whose planes are known; the likeliest first."""
        config = self._config
        if not planes.mount.known and not config.without_floor:
            return replace(nobody(*planes.surface.shape), floor_known=False)
        candidates = find_candidates(planes, config.heads)
        colour = planes.frame.colour
        classifier = self._classifier if colour.min() < colour.max() else self._depth_classifier
        likelihood = classifier.likelihood(candidate_features(planes, candidates))
        middles = body_centres(candidates, config.behind)
        told = likelihood >= np.where(candidates.legs, config.least_of_legs, config.least_likelihood)
        order = np.argsort(-likelihood, kind="stable")
        owner = np.full(len(order), -1, dtype=np.int64)
        kept: list[int] = []
        for k in order.tolist():
            if not told[k] or np.hypot(*candidates.axes[k]) > planes.reach:
                continue
            near = [n for n, other in enumerate(kept) if np.hypot(*(middles[k] - middles[other])) < config.apart]
            owner[k] = near[0] if near else len(kept)
            if not near:
                kept.append(k)
        label = np.append(owner, -1)[candidates.label].astype(np.int32)
        if kept:
            open_to = (planes.surface != Surface.FLOOR) & (planes.surface != Surface.CEILING)
            for _ in range(2):
                label = spread(planes.points, label, open_to, config.ragged)
        places = transform_points(frame.T_robot_camera, middles[kept])
        return RgbdPeople(places, likelihood[kept], label, planes.mount.known)


def body_centres(candidates: Candidates, behind: float) -> Array:
    """Return (n, 2) the middles of the candidates [m], `behind` what is seen of them; level frame."""
    distance = np.maximum(np.hypot(*candidates.axes.T), 1e-6)
    return candidates.axes * (1.0 + behind / distance)[:, None]


@kernel
def spread(points, label, open_to, ragged):
    """Return `label` (h, w) grown by a pixel into those of `open_to` (h, w) that are within `ragged` in space.

    At the edge of a body a pixel's depth may lie between the body and what is behind it; such points belong to no
    plane and no cluster, and are the person's all the same.
    """
    height, width = label.shape
    grown = label.copy()
    for row in range(height):
        for col in range(width):
            p = points[row, col]
            if label[row, col] >= 0 or not open_to[row, col] or not np.isfinite(p[0]):
                continue
            best = ragged
            for i in range(max(0, row - 1), min(height, row + 2)):
                for j in range(max(0, col - 1), min(width, col + 2)):
                    if label[i, j] < 0:
                        continue
                    q = points[i, j]
                    away = np.sqrt((p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2)
                    if away < best:
                        best = away
                        grown[row, col] = label[i, j]
    return grown
