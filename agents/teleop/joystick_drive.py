"""Records an operator's drive in the closed loop, and replays a log in the open loop."""

import json
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, Protocol

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from ...envs.follow_env import FollowEnv
from ...envs.recording.rollout import Episode, rollout
from ...envs.registration import IDS
from ...slam.errors import InputError, unknown_name
from .joystick import MODEL, JoystickLog, JoystickReplay
from .operator_model import OperatorConfig, OperatorModel, OperatorView

Watch = Callable[[FollowEnv], None]


class Stick(Protocol):
    """Who holds the stick."""

    def act(self, sight: OperatorView) -> NDArray[np.float64]:
        """Return forward speed [m/s] and turn rate [rad/s]."""
        ...


def model_operator(env: FollowEnv, seed: int, config: OperatorConfig | None = None) -> OperatorModel:
    """Return the operator model for the present episode of `env`."""
    rng = np.random.default_rng([seed, 20_01])
    return OperatorModel(env.world.scene.route, rng, config, 1.0 / env.config.task.control_hz)


def record_drive(
    env_id: str,
    kwargs: Mapping[str, Any],
    seed: int,
    operator: Callable[[FollowEnv, int], Stick] = model_operator,
    made_by: str = MODEL,
    watch: Watch | None = None,
    render_mode: str | None = None,
    by_hand: bool = False,
) -> JoystickLog:
    """Drive one episode by stick, to the tour's end, the episode's, or the operator's `EOFError`; return the log.

    Args:
        env_id: Environment.
        kwargs: Its arguments, plain JSON.
        seed: Of the episode and of the operator's draws.
        operator: Makes who holds the stick, of the environment after its reset and the seed.
        made_by: For the log's header.
        watch: Called before each step.
        render_mode: "human" shows MuJoCo's viewer.
        by_hand: Whether Ctrl-C, too, ends the drive and keeps its log: nobody can drive the same drive again.

    The drive itself is made without SLAM, whatever `kwargs` say: whoever holds the stick sees no map, and a map moves
    nobody, so the drive is the same.
    """
    env = gym.make(env_id, render_mode=render_mode, **{**kwargs, "slam": None})
    inner = env.unwrapped
    assert isinstance(inner, FollowEnv)
    env.reset(seed=seed)
    stick, actions, done = operator(inner, seed), [], False
    top = np.array((inner.interface.max_speed, inner.interface.max_turn_rate))
    with suppress(EOFError, *[KeyboardInterrupt] * by_hand):
        while not done and inner.truth.robot_progress < inner.world.scene.tour_length:
            if watch is not None:
                watch(inner)
            truth = inner.truth
            sight = OperatorView(truth.robot_pose, truth.robot_progress, truth.people.positions)
            action = np.round(np.clip(stick.act(sight) / top, -1.0, 1.0), 4).astype(np.float32)
            _, _, terminated, truncated, _ = env.step(action)
            actions.append(action)
            done = terminated or truncated
    env.close()
    plain = json.loads(json.dumps(dict(kwargs)))
    return JoystickLog(
        made_by, env_id, plain, seed, np.array(actions).reshape(-1, 2), 1.0 / inner.config.task.control_hz
    )


def replay_drive(log: JoystickLog, watch: Watch | None = None) -> Episode:
    """Replay a log in the environment of its header, open loop; with the same program it ends as it was recorded.

    Raises:
        InputError: If there is no such environment, or its steps are longer or shorter than the log's.
    """
    if log.env not in IDS:
        raise unknown_name("environment", log.env, tuple(IDS))
    env = gym.make(log.env, **log.kwargs)
    inner = env.unwrapped
    assert isinstance(inner, FollowEnv)
    if abs(log.step_s * inner.config.task.control_hz - 1.0) > 1e-4:
        raise InputError(
            f"the log has steps of {log.step_s} s, its environment {inner.config.task.control_hz} in a second"
        )
    episode = rollout(
        env,
        JoystickReplay(log, log.env, log.kwargs, log.seed),
        seed=log.seed,
        steps=len(log.actions),
        after_step=watch,
    )
    env.close()
    return episode
