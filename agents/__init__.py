"""Who drives: followers of a leader, and explorers without one.

    make_follower          a follower ("pid", "mppi", "mapper", "reinforced" ...) or explorer ("random",
                           "frontier") by name; your own class as "module:name"; a folder of `tagalong train follower`
    FOLLOWERS, EXPLORERS   the names, and what makes each
    Follower               what each of them is: `reset()`, and `act(observation)` -> action in [-1, 1]
    PIDFollower, PurePursuitFollower, DWAFollower     by rules, with PIDConfig, PurePursuitConfig, DWAConfig
    MPPIFollower           plans ahead among people whose walk it predicts, with MPPIConfig
    LearnedFollower        a trained network with a guard around it, in plain numpy
    RandomWalk, RandomWalkConfig, FrontierExplorer    explore without a leader; the last where a map is built
    SB3VecEnv              many environments of `gymnasium.make_vec` for stable-baselines3 (extra `learn`)
    PufferWorlds, RslRlVecEnv   the same for PufferLib and rsl_rl
    TensorVectorEnv             worlds on a GPU, in tensors that stay there
    following_tour, TourConfig   one recorded drive behind a leader, with the scans filtered

Example:
    >>> import gymnasium as gym
    >>> from tagalong.agents import PIDConfig, PIDFollower
    >>> env = gym.make("tagalong/Corridor-v0", slam=None, beams=181)
    >>> follower = PIDFollower(env.unwrapped.interface, PIDConfig(distance=1.5))
    >>> observation, info = env.reset(seed=0)
    >>> for _ in range(10):
    ...     observation, reward, terminated, truncated, info = env.step(follower.act(observation))
    >>> terminated
    False

These names are what is public; the modules below are private and may change. Each is loaded when it is first asked for,
so that importing this needs neither torch nor mujoco nor numba. Training needs the extra `learn`: `tagalong train`.
"""

from typing import TYPE_CHECKING

from ..slam.door import lends

if TYPE_CHECKING:
    from .learned.follower import LearnedFollower
    from .planned.config import MPPIConfig
    from .planned.mppi import MPPIFollower
    from .protocol.follower import Follower
    from .roster import EXPLORERS, FOLLOWERS, make_follower
    from .scripted.dwa import DWAConfig, DWAFollower
    from .scripted.frontier import FrontierExplorer
    from .scripted.pid import PIDConfig, PIDFollower
    from .scripted.pure_pursuit import PurePursuitConfig, PurePursuitFollower
    from .scripted.random_walk import RandomWalk, RandomWalkConfig
    from .tour import TourConfig, following_tour
    from .training.flat_worlds import PufferWorlds, RslRlVecEnv
    from .training.sb3 import SB3VecEnv
    from .training.tensor_env import TensorVectorEnv

_MODULES = {
    "EXPLORERS": "roster",
    "FOLLOWERS": "roster",
    "DWAConfig": "scripted.dwa",
    "DWAFollower": "scripted.dwa",
    "Follower": "protocol.follower",
    "FrontierExplorer": "scripted.frontier",
    "LearnedFollower": "learned.follower",
    "MPPIConfig": "planned.config",
    "MPPIFollower": "planned.mppi",
    "PIDConfig": "scripted.pid",
    "PIDFollower": "scripted.pid",
    "PufferWorlds": "training.flat_worlds",
    "PurePursuitConfig": "scripted.pure_pursuit",
    "PurePursuitFollower": "scripted.pure_pursuit",
    "RandomWalk": "scripted.random_walk",
    "RandomWalkConfig": "scripted.random_walk",
    "RslRlVecEnv": "training.flat_worlds",
    "SB3VecEnv": "training.sb3",
    "TensorVectorEnv": "training.tensor_env",
    "TourConfig": "tour",
    "following_tour": "tour",
    "make_follower": "roster",
}

__all__ = [
    "EXPLORERS",
    "FOLLOWERS",
    "DWAConfig",
    "DWAFollower",
    "Follower",
    "FrontierExplorer",
    "LearnedFollower",
    "MPPIConfig",
    "MPPIFollower",
    "PIDConfig",
    "PIDFollower",
    "PufferWorlds",
    "PurePursuitConfig",
    "PurePursuitFollower",
    "RandomWalk",
    "RandomWalkConfig",
    "RslRlVecEnv",
    "SB3VecEnv",
    "TensorVectorEnv",
    "TourConfig",
    "following_tour",
    "make_follower",
]

__getattr__, __dir__ = lends(__name__, _MODULES)
