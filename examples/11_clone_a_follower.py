"""Behaviour cloning: episodes of a follower as a Minari dataset, a network that imitates them, and how far that gets.

Needs the extra `datasets`. `tagalong record` writes such datasets from the command line.
"""

import os
import tempfile

import gymnasium as gym
import numpy as np
import tagalong  # noqa: F401 (registers the environments)
from sklearn.neural_network import MLPRegressor
from tagalong.agents import make_follower
from tagalong.envs import rollout
from tagalong.envs.recording import demonstrate, write_minari


def features(observation):
    """Return (..., 18) what the network is told: the nearest return of each of 12 sectors, and the leader.

    Not the own velocity: told how fast it drives, a clone learns to go on doing what it does.
    """
    scan = observation["scan"]
    sectors = scan.reshape(*scan.shape[:-1], 12, -1).min(axis=-1)
    return np.concatenate((sectors, observation["leader"]), axis=-1)


class Clone:
    """A follower that does what a network says."""

    def __init__(self, network):
        self.network = network

    def reset(self):
        """Forget nothing: it has no memory."""

    def act(self, observation):
        """Return the action for one observation."""
        return np.clip(self.network.predict(features(observation)[None])[0], -1.0, 1.0).astype(np.float32)


with tempfile.TemporaryDirectory() as folder:
    env = gym.make("tagalong/Corridor-v0", people="truth", people_count=1, slam=None, beams=180)
    episodes = (demonstrate(env, make_follower("pid"), seed=seed) for seed in range(4))
    write_minari(folder, "tagalong/corridor/pid-v0", env, episodes, "pid")

    os.environ["MINARI_DATASETS_PATH"] = folder
    import minari

    dataset = minari.load_dataset("tagalong/corridor/pid-v0")
    # the last observation of an episode has no action
    told = np.concatenate([features(episode.observations)[:-1] for episode in dataset])
    done = np.concatenate([episode.actions for episode in dataset])
    network = MLPRegressor(hidden_layer_sizes=(64, 64), tol=1e-3, random_state=0).fit(told, done)

    for name, follower in (("pid", make_follower("pid")), ("clone", Clone(network))):
        driven = [rollout(dataset.recover_environment(), follower, seed=1000 + k) for k in range(2)]
        tours = sum(episode.ending == "tour_done" for episode in driven)
        error = np.mean([episode.metrics["distance_error_rms_m"] for episode in driven])
        print(f"{name}: {tours} of 2 unseen tours, distance error {error:.2f} m")
    print(f"learned from {dataset.total_episodes} episodes, {dataset.total_steps} steps")
