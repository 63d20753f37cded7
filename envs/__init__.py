"""A building with walking people, and a robot that follows one of them and maps: a Gymnasium environment.

    gymnasium.make("tagalong/Corridor-v0", **settings)      one environment; `FollowEnv` is the manual of observations,
                                                            actions, rewards, endings and info
    gymnasium.make_vec(..., vectorization_mode="vector_entry_point")   many on all cores: `FollowVectorEnv`; with
                                                            simulator="compiled" thousands: `CompiledVectorEnv`;
                                                            "cuda" as many more on a GPU: `CudaVectorEnv`
    rollout(env, follower, seed=0) -> Episode               one episode: history, metrics, total reward

    >>> import gymnasium
    >>> import tagalong
    >>> from tagalong.agents import make_follower
    >>> from tagalong.envs import rollout
    >>> env = gymnasium.make("tagalong/Corridor-v0", people_count=2, slam=None, **{"reward.personal_space": 3.0})
    >>> episode = rollout(env, make_follower("pid"), seed=0, steps=20)
    >>> len(episode.history), "distance_error_rms_m" in episode.metrics
    (21, True)

Every setting has a path in the tree `FollowConfig`, and goes by it, or by the end of it where that is unique:
`people_count=2`, `**{"lidar.height": 0.3}`, `robot="pioneer"`, `slam=GMappingConfig(particles=50)`,
`filter_people=False`. Functions and objects of one's own enter there too:

    robot      RobotConfig: size, limits, drive; or "dingo-d", "dingo-o", "pioneer"
    slam       an engine's configuration, or a function of a seed that returns a `tagalong.slam.SlamEngine`
    people     behaviours=[...]: objects of a class derived from `Behaviour`, with `wish(view: PersonView, dt) -> Wish`
    scene      a function (rng, request: SceneRequest) -> `Scene`; what it is built of is in `tagalong.envs.scenes`
    reward     terms={"name": function(StepFacts) -> float}
    entries    of the observation: {"name": (space, function(Belief) -> array)}; a `Belief` holds no truth

Below the environment: `World` (WorldConfig) is the simulator alone, with `RgbdConfig` for a camera and `Operator`, who
drives it by a script. Names that are not listed here are private and may change at any time.
"""

from typing import TYPE_CHECKING

from ..slam.door import lends

if TYPE_CHECKING:
    from .compiled.vector_env import CompiledVectorEnv
    from .cuda_worlds.vector_env import CudaVectorEnv
    from .follow_config import FollowConfig
    from .follow_env import FollowEnv
    from .onboard.stack import Belief
    from .people.behaviours import Behaviour, PersonView, Wish
    from .recording.operator import Operator
    from .recording.rollout import Episode, rollout
    from .robot.robot import RobotConfig
    from .scenes.request import SceneRequest
    from .scenes.scene import Scene
    from .sensors.camera.config import RgbdConfig
    from .task.rewards import StepFacts
    from .vector.vector_env import FollowVectorEnv
    from .world.config import WorldConfig
    from .world.world import World

__all__ = [
    "Behaviour",
    "Belief",
    "CompiledVectorEnv",
    "CudaVectorEnv",
    "Episode",
    "FollowConfig",
    "FollowEnv",
    "FollowVectorEnv",
    "Operator",
    "PersonView",
    "RgbdConfig",
    "RobotConfig",
    "Scene",
    "SceneRequest",
    "StepFacts",
    "Wish",
    "World",
    "WorldConfig",
    "rollout",
]

_HOME = {
    "Behaviour": "people.behaviours",
    "Belief": "onboard.stack",
    "CompiledVectorEnv": "compiled.vector_env",
    "CudaVectorEnv": "cuda_worlds.vector_env",
    "Episode": "recording.rollout",
    "FollowConfig": "follow_config",
    "FollowEnv": "follow_env",
    "FollowVectorEnv": "vector.vector_env",
    "Operator": "recording.operator",
    "PersonView": "people.behaviours",
    "RgbdConfig": "sensors.camera.config",
    "RobotConfig": "robot.robot",
    "Scene": "scenes.scene",
    "SceneRequest": "scenes.request",
    "StepFacts": "task.rewards",
    "Wish": "people.behaviours",
    "World": "world.world",
    "WorldConfig": "world.config",
    "rollout": "recording.rollout",
}
"""Public name -> module; imported when it is asked for."""

__getattr__, __dir__ = lends(__name__, _HOME)
