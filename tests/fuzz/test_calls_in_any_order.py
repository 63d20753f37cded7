"""The environment is called in orders that nobody plans: each call does its work or says in one line why not."""

import numpy as np
from borders.environment import CHEAP
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule
from tagalong.envs import FollowEnv
from tagalong.slam import InputError

ACTIONS = st.one_of(
    st.lists(st.floats(-2.0, 2.0), min_size=2, max_size=2),
    st.lists(st.floats(), max_size=4),
    st.sampled_from([None, "forward", 0.5, [[0.1, 0.2]], {"forward": 1.0}]),
)


class CallsInAnyOrder(RuleBasedStateMachine):
    """Calls `reset`, `step`, `render`, `close`, and keeps and restores states, in any order."""

    def __init__(self):
        super().__init__()
        self.env, self.kept, self.begun = FollowEnv(**CHEAP, render_mode="rgb_array"), [], False
        self.closed = False

    def refused_when_out_of_turn(self, call):
        """Return what a call returns, None if it is refused: in one line, and because of what was called before."""
        try:
            result, told = call(), ""
        except InputError as error:
            result, told = None, str(error)
        assert "\n" not in told
        assert not told or not self.begun or self.closed or "action" in told
        assert self.begun or told
        return result

    @rule(seed=st.integers(0, 3))
    def reset(self, seed):
        try:
            self.env.reset(seed=seed)
        except InputError as error:
            told = str(error)
        else:
            self.begun, told = True, ""
        assert ("closed" in told) == self.closed

    @rule(action=ACTIONS)
    def step(self, action):
        result = self.refused_when_out_of_turn(lambda: self.env.step(action))
        if result is not None:
            observation, reward, *_ = result
            assert self.env.observation_space.contains(observation)
            assert np.isfinite(reward)

    @rule()
    def render(self):
        picture = self.refused_when_out_of_turn(self.env.render)
        assert picture is None or picture.dtype == np.uint8

    @rule()
    def look(self):
        self.refused_when_out_of_turn(lambda: (self.env.world, self.env.truth, self.env.belief))

    @rule()
    def close(self):
        self.env.close()
        self.closed = True

    @precondition(lambda self: self.begun)
    @rule()
    def keep(self):
        self.kept.append((self.env.save_state(), self.env.truth.robot_pose.copy()))

    @precondition(lambda self: self.kept)
    @rule(which=st.integers(0, 9))
    def restore(self, which):
        state, pose = self.kept[which % len(self.kept)]
        self.env.restore_state(state)
        assert self.env.truth.robot_pose.tobytes() == pose.tobytes()

    @invariant()
    def the_robot_is_somewhere(self):
        assert not self.begun or np.isfinite(self.env.truth.robot_pose).all()

    def teardown(self):
        self.env.close()


TestCallsInAnyOrder = CallsInAnyOrder.TestCase
TestCallsInAnyOrder.settings = settings(
    max_examples=6, stateful_step_count=8, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
)
