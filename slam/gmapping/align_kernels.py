"""Kernels that lay one scan on the maps of many particles: the mode of each one's improved proposal."""

import numpy as np

from ..view_kernel import kernel
from .fit_kernels import compare, search_samples
from .match_kernels import match


@kernel
def log_likelihood(pose, prior, information, points, weight, unseen, directory, counts, near):
    """Return (value, against, unknown) of a pose: its log-likelihood, by what `compare` returns and by the prior.

    The points count for `weight` of them at most, and a few for no more than they are.
    """
    against, unknown = compare(pose[0], pose[1], pose[2], points, unseen, np.inf, directory, counts, near)
    distance = 0.0
    for a in range(3):
        for b in range(3):
            distance += (pose[a] - prior[a]) * information[a, b] * (pose[b] - prior[b])
    return -min(1.0, weight / max(len(points), 1)) * against - 0.5 * distance, against, unknown


@kernel
def align_particles(
    start, stop, priors, roots, informations, samples, few, points, stages, beams, sigma, straightness, weight, unseen,
    suspicion, directory, counts, means, bits, near, poses, systems, losses,
):  # fmt: skip
    """Align particles start..stop, as `MatcherConfig` says; see `match` and `search_samples`.

    Args:
        priors: (P, 3) expected poses.
        roots, informations: (P, 3, 3) lower Cholesky factors of their covariances, and the inverses of these.
        samples: (m, 3) standard normal draws.
        few: (k, 2) the points that judge a sample.
        points: (n, 2) all of the scan.
        stages: (s, 4) window, stride, iterations and scale of each, the finest last.
        weight, unseen, suspicion: Of `MatcherConfig`; `beams`, `sigma` and `straightness`, too.
        directory, counts, means, bits, near: The maps.
        poses: (P, 3) the modes; `systems` (P, 3, 4) and `losses` (P,) are what `match` leaves there.
    """
    worth = min(weight, float(len(points)))
    for p in range(start, stop):
        prior, information, own = priors[p], informations[p], directory[p]
        pose = prior.copy()
        _, losses[p] = match(
            pose, prior, information, points, stages[-1:], beams, sigma, straightness, own, counts, means, bits,
            systems[p],
        )  # fmt: skip
        poses[p] = pose
        value, _, _ = log_likelihood(pose, prior, information, points, weight, unseen, own, counts, near)
        if -value <= suspicion:
            continue
        system = np.zeros((3, 4))
        search_samples(prior, roots[p], samples, few, worth, unseen, own, counts, near, pose)
        _, loss = match(
            pose, prior, information, points, stages, beams, sigma, straightness, own, counts, means, bits, system
        )
        if log_likelihood(pose, prior, information, points, weight, unseen, own, counts, near)[0] > value:
            poses[p], systems[p], losses[p] = pose, system, loss
