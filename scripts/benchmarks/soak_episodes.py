"""Episode after episode in all buildings, and one episode for hours: memory and time of each stretch.

A row of the first is a round: some seconds in each registered environment, each with a new seed, so that nothing that
is kept by building or by episode stays hidden. A row of the second is a stretch of one episode that goes on and on:
nobody leads, contacts do not end it, and after each stretch the same probe of steps is timed anew.
"""

import time
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from ...agents import make_follower
from ...agents.protocol.follower import Follower
from ...envs.episode import EnvState
from ...envs.follow_env import FollowEnv
from ...envs.registration import IDS
from ..lab.cells import TIMING
from ..lab.memory import memory_mb
from ..lab.trend import Pace, Row

VISIT = 200
"""Steps in one building before the next one is looked at; at 10 Hz 20 s."""
STRETCH = 1000
"""Steps of the endless episode between two looks at the memory."""
PROBE = 200
"""Steps of it that are driven anew after each stretch."""
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
    """Return the rows of one episode of `steps` steps in an office, of a robot that wanders about.

    What a step costs there changes with where robot and people are, for tens of thousands of steps: the steps that pass
    tell little of age. Timed is therefore the probe, the same steps from the same state, again after each stretch, by
    the process and the environment as they have become. What the episode itself carries on is there as it
    was; if that grew, the memory would. The time of the steps that passed is told beside it, as "passing_ms".
    """
    wanderer, pace, probe = _Wanderer(slam), Pace(), None
    rows = []
    for stretch in tqdm(range(-(-steps // STRETCH)), f"one episode, slam={slam}", unit="stretch"):
        start = time.process_time()
        wanderer.go_on(STRETCH)
        passing_ms = 1e3 * (time.process_time() - start) / STRETCH
        probe = probe or _Probe(wanderer)
        step_ms, done = 1e3 * probe.drive(pace) / PROBE, (stretch + 1) * STRETCH
        row = Row(memory_mb=memory_mb(), step_ms=step_ms, reference_ms=pace.read(), done=done)
        rows.append(asdict(row) | {"passing_ms": passing_ms})
    return {"episodes": wanderer.episodes, TIMING: rows}


class _Wanderer:
    """A robot that wanders about in an office for ever, among people."""

    def __init__(self, slam: str | None) -> None:
        self.env = FollowEnv(
            scene="office",
            slam=slam,
            leader=False,
            people_count=PEOPLE,
            beams=BEAMS,
            ends_on_contact=False,
            coverage_goal=1.0,
        )
        self._robot = make_follower("random", self.env.interface)
        self._observation: dict[str, Any] = {}
        self._ended, self.episodes = True, 0
        self._home: tuple[EnvState, dict[str, Any]] | None = None

    def go_on(self, steps: int) -> list[NDArray[np.float64]]:
        """Drive `steps` steps; return their actions."""
        actions = []
        for _ in range(steps):
            if self._ended:
                self._begin()
            actions.append(self._robot.act(self._observation))
            self._observation, _, self._ended, _, _ = self.env.step(actions[-1])
        return actions

    def _begin(self) -> None:
        """Start; when by chance all of the floor was seen, go back there, since another building takes other memory."""
        self.episodes += 1
        self._robot.reset()
        if self._home is None:
            self._observation, _ = self.env.reset(seed=0)
            self._home = self.env.save_state(), self._observation
        else:
            self.env.restore_state(self._home[0])
            self._observation = self._home[1]


class _Probe:
    """Steps that are driven again and again: from now on, those that the robot takes next."""

    def __init__(self, wanderer: _Wanderer) -> None:
        self._env = wanderer.env
        self._state = self._env.save_state()
        self._actions = wanderer.go_on(PROBE)

    def drive(self, pace: Pace) -> float:
        """Drive the steps, return their time [s], and go back to where the episode is."""
        here, took = self._env.save_state(), 0.0
        self._env.restore_state(self._state)
        for k, action in enumerate(self._actions):
            if k % SAMPLE == 0:
                pace.sample()
            start = time.process_time()
            self._env.step(action)
            took += time.process_time() - start
        self._env.restore_state(here)
        return took


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
