import gymnasium as gym
import numpy as np
import tagalong  # noqa: F401  (registers the environments)


def test_people_are_kept_out_of_the_first_scan_that_is_mapped():
    env = gym.make("tagalong/Corridor-v0", slam=None, people_count=2)
    env.reset(seed=4)
    inner = env.unwrapped
    on_people = inner.world.scan_labels() >= 0
    near = on_people & inner.belief.scan.is_return & (inner.belief.scan.ranges < 4.0)
    assert near.sum() > 10
    dropped = np.isnan(inner.belief.filtered.ranges)
    assert dropped[near].mean() > 0.7
    static = ~on_people & inner.belief.scan.is_return
    assert dropped[static].mean() < 0.02
