"""Drives of the teacher and of the policy, on one process or several; the workers need no torch."""

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...envs.follow_env import FollowEnv
from ...envs.registration import MAX_EPISODE_STEPS
from ...slam.processes.crew import Crew, require_workers
from ..learned.network import Network
from ..learned.pilot import Pilot, PilotConfig
from .curriculum import Drawn

Arrays = Mapping[str, NDArray[np.float32]]

TEACHER_STRETCH_S = 1.5
"""Who drives, teacher or policy, is drawn anew this often [s]."""
_STEP_S = 0.1


@dataclass(frozen=True, kw_only=True, eq=False)
class DriveTask:
    """One episode to drive.

    Attributes:
        drawn: Seed and options.
        env: Keyword arguments of `FollowEnv`.
        pilot: Around the network.
        policy: The network's arrays; None lets the teacher drive.
        teacher_share: Share of the stretches of 1.5 s that the teacher drives; it says what it would do anyway.
        noise: Deviation of the noise on what is wished while the teacher drives, in the network's units.
        teach: Whether the teacher's wishes are wanted at all.
        most_steps: Steps after which it is cut.
    """

    drawn: Drawn
    env: dict[str, Any]
    pilot: PilotConfig
    policy: Arrays | None = None
    teacher_share: float = 0.0
    noise: float = 0.0
    teach: bool = True
    most_steps: int = MAX_EPISODE_STEPS


@dataclass(frozen=True, kw_only=True, eq=False)
class TeacherDrive:
    """What came of it.

    Attributes:
        inputs: Name -> (n, ...) inputs of the network, half precision.
        labels: (n, 2) what the teacher would have wished, in the network's units.
        total_reward: Sum of the environment's rewards.
        ending: Why it ended; "" if it was cut.
        steps: How many steps.
    """

    inputs: dict[str, NDArray[np.float16]] = field(default_factory=dict)
    labels: NDArray[np.float32] = field(default_factory=lambda: np.zeros((0, 2), dtype=np.float32))
    total_reward: float
    ending: str
    steps: int

    @property
    def done(self) -> bool:
        """Whether the tour was done without a contact."""
        return self.ending == "tour_done"


def drive(task: DriveTask) -> TeacherDrive:
    """TeacherDrive one episode; equal for equal tasks."""
    env = _environment(task.env)
    observation, _ = env.reset(seed=task.drawn.seed, options=task.drawn.options)
    pilot = Pilot(task.pilot, env.interface)
    network = Network(task.policy) if task.policy is not None else None
    teacher = _teacher(env, task.pilot) if task.teach else None
    rng = np.random.default_rng((task.drawn.seed, 1))
    inputs: list[dict[str, Any]] = []
    labels: list[tuple[float, float]] = []
    total, ending, steps, taught, off = 0.0, "", 0, True, np.zeros(2)
    for steps in range(1, task.most_steps + 1):
        told = pilot.inputs(observation)
        if (steps - 1) % round(TEACHER_STRETCH_S / _STEP_S) == 0:
            taught = network is None or rng.random() < task.teacher_share
        off = 0.9 * off + np.sqrt(1.0 - 0.81) * task.noise * rng.standard_normal(2)
        wish = (0.0, 0.0)
        if teacher is not None:
            wish = task.pilot.steering.output(*teacher.wish(pilot.commanded))
            inputs.append({name: value.astype(np.float16) for name, value in told.items()})
            labels.append(wish)
        if taught or network is None:
            output = np.asarray(wish) + off
        else:
            output = network(told)
        observation, reward, terminated, _, info = env.step(pilot.drive(output))
        total += reward
        if terminated:
            ending = info["ending"]
            break
    stacked = {name: np.stack([row[name] for row in inputs]) for name in inputs[0]} if inputs else {}
    table = np.array(labels, dtype=np.float32).reshape(-1, 2)
    return TeacherDrive(inputs=stacked, labels=table, total_reward=total, ending=ending, steps=steps)


def drive_all(tasks: Sequence[DriveTask], workers: int) -> Generator[TeacherDrive]:
    """Yield what came of each task, in their order, on so many processes (1: on this one).

    Raises:
        InputError: If there are more processes than the machine has use for.
        WorkerError: If one of them is lost.
    """
    require_workers(workers, "`workers`")
    if workers == 1:
        yield from map(drive, tasks)
        return
    early: dict[int, TeacherDrive] = {}
    with Crew(workers) as crew:
        following = 0
        for index, done in crew.results(drive, [(task,) for task in tasks]):
            early[index] = done
            while following in early:
                yield early.pop(following)
                following += 1


_environments: dict[str, FollowEnv] = {}


def _environment(arguments: dict[str, Any]) -> FollowEnv:
    """Return an environment; each process keeps those that it made, since the leg forest takes a while to load."""
    key = repr(sorted(arguments.items()))
    if key not in _environments:
        _environments[key] = FollowEnv(**arguments)
    return _environments[key]


def _teacher(env: FollowEnv, pilot: PilotConfig) -> Any:
    from .teacher import Teacher, TeacherConfig  # its kernel needs numba

    return Teacher(env, TeacherConfig(steering=pilot.steering))
