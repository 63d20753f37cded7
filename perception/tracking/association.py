"""Data association: which clusters are the legs of whom, together most likely."""

from typing import Any

import numpy as np

from ...slam.view_kernel import inner_kernel, kernel
from .assignment import assigned
from .geometry_kernels import square_distance


@inner_kernel
def associate(rows, sight, c):
    """Give the legs of the hypotheses `rows` (n,) the clusters in `sight` that they are together most likely.

    A cluster where something has stood still is that thing: it is somewhere in three by three cells of the grid, not
    anywhere; who steps there is seen beside it.
    """
    legs, side, clusters = 2 * len(rows), 3.0 * c.things_resolution, rows["clusters"]
    thing, cost = np.zeros(len(sight.z)), np.empty((legs, len(sight.z)))
    for j in range(len(sight.z)):
        if sight.stood[j] >= c.things_still_s:
            thing[j] = -sight.still * np.log(side**2 * c.association_clutter)
    leg_costs(
        rows, sight.z, sight.affinity, thing, c.association_leg**2, c.association_pace, 0.5 * c.association_stride,
        c.association_clutter, cost,
    )  # fmt: skip
    clusters[:] = -1
    chosen, column = assigned(cost, np.zeros(legs))
    for k in range(len(chosen)):
        clusters[chosen[k] // 2, chosen[k] % 2] = column[k]


@kernel
def leg_costs(
    rows: Any, z: Any, e: Any, thing: Any, r: float, pace: float, reach: float, clutter: float, cost: Any
) -> None:
    """Write into `cost` (2 n, m) how unlikely each cluster is each leg: negative log likelihood ratio.

    A leg is where it was last seen, moved on with its person, but for the variance `r` and what it may have swung since
    then; a leg that was never seen, or long ago, is anywhere beside the predicted centre.

    Args:
        rows: (n,) hypotheses, predicted; 2 i and 2 i + 1 are the legs of hypothesis i.
        z: (m, 2) clusters [m].
        e: (m,) evidence of what each cluster itself shows.
        thing: (m,) how much likelier each is a thing that has stood there than a leg that has come there.
        r: Variance with which the place of a leg is seen [m^2].
        pace: How fast a leg swings past its person [m/s].
        reach: Farthest that a leg is from the centre [m].
        clutter: Things that could be legs, a square metre.
        cost: Where to write.
    """
    for i in range(len(rows)):
        x, p = rows["x"][i], rows["p"][i, 0]
        for s in range(2):
            unseen_s = rows["leg_unseen_s"][i, s]
            leg_x, leg_y = x[0] + rows["legs"][i, s, 0], x[1] + rows["legs"][i, s, 1]
            was_x, was_y = leg_x - unseen_s * x[2], leg_y - unseen_s * x[3]
            variance = r + min((pace * unseen_s) ** 2, reach * reach + p)
            base = np.log(2.0 * np.pi * variance * clutter)
            for j in range(len(z)):
                if square_distance(z[j, 0], z[j, 1], x[0], x[1]) > reach * reach + 4.0 * p:
                    cost[2 * i + s, j] = np.inf
                    continue
                off = square_distance(z[j, 0], z[j, 1], leg_x, leg_y)
                come = square_distance(z[j, 0], z[j, 1], was_x, was_y) > r
                cost[2 * i + s, j] = 0.5 * off / variance + base - e[j] + (thing[j] if come else 0.0)
