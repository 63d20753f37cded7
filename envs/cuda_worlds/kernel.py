"""The kernels of the compiled worlds, compiled once more for CUDA: each thread steps one world.

Nothing of a world is written twice: a thread calls `compiled.episodes.step_world`, as the loop on a processor does.
"""

from typing import Any

import numpy as np
from numba import cuda
from numpy.typing import NDArray

from ...perception.leader.selection import Company
from ...slam.view_kernel import inner_view_kernel
from ..compiled.episodes import REST, step_world
from ..compiled.plans import Plans
from ..compiled.rules import Rules
from ..compiled.state import Array, Scratch, Told, WorldsState

THREADS = 64
"""Of a block. Each needs more than 200 registers, so that a multiprocessor holds a few such blocks."""


@inner_view_kernel
def scratch_of(room: Scratch, w: int) -> Scratch:
    """Return the scratch of one thread out of that of all, whose arrays have an axis over threads before the others."""
    r, c = room, room.company
    return Scratch(
        r.poses[w], r.noise[w], r.beams[w], r.ellipse[w], r.contacts[w], r.work[w], r.robot[w], r.place[w],
        r.wanted[w], Company(c.ids[w], c.x[w], c.confidence[w], c.unseen_s[w], c.age_s[w]), r.others[w], r.before[w],
    )  # fmt: skip


def _step(
    what: NDArray[np.int8],
    actions: Array,
    rules: Rules,
    plans: Plans,
    state: WorldsState,
    told: Told,
    room: Scratch,
) -> None:
    w = cuda.grid(1)  # pyright: ignore[reportCallIssue]
    if w < len(what) and what[w] != REST:
        step_world(w, what[w], actions[w], rules, plans, state, told, scratch_of(room, w))


step_on_gpu: Any = cuda.jit(cache=True)(_step)
"""`compiled.episodes.step_worlds` for all worlds at once; arguments as there, all arrays on the GPU."""
