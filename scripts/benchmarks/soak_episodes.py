"""Episode after episode in all buildings, and one episode for hours: memory and time of each stretch.

A row of the first is a round: some seconds in each registered environment, each with a new seed, so that nothing that
is kept by building or by episode stays hidden. A row of the second is a stretch of one episode that goes on and on:
nobody leads, and contacts do not end it.
"""

import time
from dataclasses import asdict
from typing import Any

from tqdm import tqdm

from ...agents import make_follower
from ...agents.protocol.follower import Follower
from ...envs.follow_env import FollowEnv
from ...envs.registration import IDS
from ..lab.cells import TIMING
from ..lab.memory import memory_mb
from ..lab.trend import Pace, Row

VISIT = 200
"""Steps in one building before the next one is looked at; at 10 Hz 20 s."""
STRETCH = 1000
"""Steps of the endless episode between two looks at the memory."""
SAMPLE = 20
"""Steps between two looks at the pace of the machine."""
PEOPLE = 4
"""Walking people in each building, the same everywhere: rounds are compared with each other."""
BEAMS = 360
"""Of the laser: enough for the tracker, and a third of the time of the default."""


def episodes(slam: str | None, steps: int) -> dict[str, Any]:
    """Return the rows (see `Row`) of at least `steps` steps behind the PID follower's leader, a round each.

    Args:
        slam: The environments' own engine ("default") or another of `FollowConfig.slam`.
        steps: At least how many steps altogether.
    """
    visits, pace = [Visit(name, slam) for name in IDS], Pace()
    rows, done = [], 0
    for _ in tqdm(range(-(-steps // (VISIT * len(visits)))), f"slam={slam}", unit="round"):
        took = sum(visit.go_on(VISIT, pace) for visit in visits)
        done += VISIT * len(visits)
        step_ms = 1e3 * took / (VISIT * len(visits))
        rows.append(asdict(Row(memory_mb=memory_mb(), step_ms=step_ms, reference_ms=pace.read(), done=done)))
    return {"episodes": sum(visit.seed for visit in visits), TIMING: rows}


def endless_episode(slam: str | None, steps: int) -> dict[str, Any]:
    """Return the rows of one episode of `steps` steps in an office, of a robot that wanders about."""
    env = FollowEnv(
        scene="office",
        slam=slam,
        leader=False,
        people_count=PEOPLE,
        beams=BEAMS,
        ends_on_contact=False,
        coverage_goal=1.0,
    )
    robot, rows, seed, ended, pace = make_follower("random", env.interface), [], -1, True, Pace()
    observation: dict[str, Any] = {}
    for stretch in tqdm(range(-(-steps // STRETCH)), f"one episode, slam={slam}", unit="stretch"):
        took = 0.0
        for k in range(STRETCH):
            if k % SAMPLE == 0:
                pace.sample()
            if ended:  # only at the start, or when by chance all of the floor was seen
                seed += 1
                observation, _ = env.reset(seed=seed)
                robot.reset()
            action = robot.act(observation)
            start = time.process_time()
            observation, _, ended, _, _ = env.step(action)
            took += time.process_time() - start
        step_ms, done = 1e3 * took / STRETCH, (stretch + 1) * STRETCH
        rows.append(asdict(Row(memory_mb=memory_mb(), step_ms=step_ms, reference_ms=pace.read(), done=done)))
    return {"episodes": seed + 1, TIMING: rows}


class Visit:
    """One environment and its follower, which go on where they stopped.

    Args:
        name: Registered id.
        slam: See `episodes`.
    """

    def __init__(self, name: str, slam: str | None) -> None:
        fields: dict[str, Any] = {"beams": BEAMS, **IDS[name], "people_count": PEOPLE}
        if slam != "default":
            fields["slam"] = slam
        self._env = FollowEnv(**fields)
        self._follower: Follower = make_follower("pid", self._env.interface)
        self.seed = 0

    def go_on(self, steps: int, pace: Pace) -> float:
        """Start an episode with a new seed, and others as they end, for `steps` steps; return their time [s]."""
        took, ended, observation = 0.0, True, {}
        for k in range(steps):
            if k % SAMPLE == 0:
                pace.sample()
            if ended:
                observation, _ = self._env.reset(seed=self.seed)
                self._follower.reset()
                self.seed += 1
            action = self._follower.act(observation)
            start = time.process_time()
            observation, _, ended, _, _ = self._env.step(action)
            took += time.process_time() - start
        return took
