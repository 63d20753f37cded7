"""Measured speeds: what compiles kernels is not timed."""

import time

from tagalong.envs import FollowEnv
from tagalong.scripts.benchmarks.latency import WARM_UP
from tagalong.scripts.benchmarks.speed import environment_speed


def test_kernels_that_are_compiled_after_the_warm_up_are_not_timed(monkeypatch):
    plain, calls = FollowEnv.step, []

    def compiles(env, action):
        calls.append(action)
        if len(calls) == WARM_UP + 2:
            time.sleep(2.0)
        return plain(env, action)

    monkeypatch.setattr(FollowEnv, "step", compiles)
    assert environment_speed(4, beams=8, slam=None, people="truth")["mean_ms"] < 400.0
    assert len(calls) == 2 * (4 + WARM_UP)
