"""What selectors that know their leader by its body remember, as arrays over them; kernels read and write it."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import kernel
from .legs_of_others import FOLLOWED

Array = NDArray[np.float64]

LEADER = np.dtype(
    [
        ("time_s", np.float64),  # of the last scan
        ("dt", np.float64),  # between it and the one before
        ("known", np.bool_),  # whether anybody was chosen yet
        ("id", np.int64),  # the next ones as of `LeaderEstimate`
        ("track_id", np.int64),
        ("x", np.float64, 4),  # place and velocity
        ("visible", np.bool_),
        ("confidence", np.float64),
        ("unseen_s", np.float64),
        ("chosen_s", np.float64),  # see `onset.choice`
        ("waiting_s", np.float64),
        ("own", np.int64),  # number of the track that carries the leader; -1 for none
        ("row", np.int64),  # of it among the people of the last scan; -2 for none
        ("doubt", np.int64),  # SETTLED, CHOSEN, CLOUD or FRESH
        ("cloud", np.bool_),  # whether there is a cloud
        ("unexplained_s", np.float64),  # see `legs_of_others.among`
        ("begun", np.bool_),  # whether there was a scan
        ("people", np.int64),  # how many rows of each table there are
        ("others", np.int64),
        ("followed", np.int64),
        ("now", np.int64),  # of them the legs of the last scan come first
        ("met", np.int64),
    ]
)
SETTLED, CHOSEN, CLOUD, FRESH = range(4)
"""Who leads is beyond doubt; was chosen in this scan; is for the cloud to say; is for a new cloud to say."""
NOBODY = -2
"""No row of people, nor the -1 of legs that are nobody's."""
ACQUAINTANCE = np.dtype(
    [
        ("number", np.int64),  # of a track
        ("met_s", np.float64),  # when it was first seen; -inf: somebody else for good
        ("beside_s", np.float64),  # when it was last so near to the leader that their tracks may have been exchanged
    ]
)
PERSON_BEFORE = np.dtype([("id", np.int64), ("x", np.float64, 4), ("unseen_s", np.float64)])


class BodyMemory(NamedTuple):
    """What w selectors remember; `memory_of` has one of them, without the first axis, as kernels take it.

    Attributes:
        leader: (w, 1) of `LEADER`.
        bodies: (w, n, 4) of the cloud, places and velocities.
        weights: (w, n) of them, in sum 1.
        before: (w, room) of `PERSON_BEFORE`, the people of the last scan.
        others: (w, room, 2) places of legs that are nobody's and not the leader's, as it was last in view.
        followed: (w, room) of `FOLLOWED`, legs that were seen apart from the leader.
        free: (w, room) how likely each of the last legs is the leader's, by who else explains it.
        met: (w, many) of `ACQUAINTANCE`, everybody who was ever tracked.
    """

    leader: NDArray[Any]
    bodies: Array
    weights: Array
    before: NDArray[Any]
    others: Array
    followed: NDArray[Any]
    free: Array
    met: NDArray[Any]


class Company(NamedTuple):
    """Who is tracked in a scan, as kernels take it: see `People` and its `seen_legs`."""

    ids: NDArray[np.int64]
    x: Array
    confidence: Array
    unseen_s: Array
    places: Array
    sure: Array
    owner: NDArray[np.int64]


def nothing_remembered(selectors: int, bodies: int, room: int = 48, many: int = 48) -> BodyMemory:
    """Return the memory of selectors that know nobody, with clouds of so many `bodies`."""
    memory = BodyMemory(
        leader=np.zeros((selectors, 1), LEADER),
        bodies=np.zeros((selectors, bodies, 4)),
        weights=np.zeros((selectors, bodies)),
        before=np.zeros((selectors, room), PERSON_BEFORE),
        others=np.zeros((selectors, room, 2)),
        followed=np.zeros((selectors, room), FOLLOWED),
        free=np.zeros((selectors, room)),
        met=np.zeros((selectors, many), ACQUAINTANCE),
    )
    for w in range(selectors):
        forget_leader(memory_of(memory, w))
    return memory


def with_more_room(memory: BodyMemory) -> BodyMemory:
    """Return the same with twice the room."""
    selectors, bodies = memory.weights.shape
    grown = nothing_remembered(selectors, bodies, 2 * memory.free.shape[1], 2 * memory.met.shape[1])
    for new, old in zip(grown, memory, strict=True):
        new[tuple(slice(size) for size in old.shape)] = old
    return grown


@kernel
def memory_of(memory, w):
    """Return what selector w remembers."""
    return BodyMemory(
        memory.leader[w], memory.bodies[w], memory.weights[w], memory.before[w], memory.others[w], memory.followed[w],
        memory.free[w], memory.met[w],
    )  # fmt: skip


@kernel
def forget_leader(memory):
    """Let one selector know nobody."""
    one = memory.leader[0]
    one.time_s = one.dt = one.chosen_s = one.unexplained_s = one.confidence = one.unseen_s = 0.0
    one.known = one.cloud = one.begun = one.visible = False
    one.waiting_s, one.own, one.row, one.track_id, one.id, one.doubt = np.inf, -1, NOBODY, -1, -1, SETTLED
    one.people = one.others = one.followed = one.now = one.met = 0


@kernel
def can_hold(memory, people, legs):
    """Return whether there is room for so many `people` and `legs` of one more scan."""
    one, room = memory.leader[0], len(memory.free)
    return max(one.followed, one.others) + legs <= room and people <= room and one.met + people <= len(memory.met)


@kernel
def met_by(met, count, number):
    """Make the one of that `number` the last of the first `count` of `met`, as somebody new if need be; how many now.

    So those who are about are found soon, however many came and went.
    """
    for row in range(count - 1, -1, -1):
        if met[row].number == number:
            last, met_s, beside_s = count - 1, met[row].met_s, met[row].beside_s
            met[row] = met[last]
            met[last].number, met[last].met_s, met[last].beside_s = number, met_s, beside_s
            return count
    met[count].number, met[count].met_s, met[count].beside_s = number, np.inf, -np.inf
    return count + 1
