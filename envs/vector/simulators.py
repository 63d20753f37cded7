"""Which simulator steps the environments of `gymnasium.make_vec`."""

from importlib import import_module
from typing import Any

from gymnasium.vector import VectorEnv

from ...slam.errors import unknown_name

SIMULATORS = {
    "mujoco": (".vector_env", "FollowVectorEnv"),
    "compiled": ("..compiled.vector_env", "CompiledVectorEnv"),
}
"""Name -> module and class; imported when it is asked for."""


def make_vector_env(num_envs: int = 1, *, simulator: str = "mujoco", **arguments: Any) -> VectorEnv[Any, Any, Any]:
    """Return `num_envs` environments: "mujoco" has everything, "compiled" is a hundred times as fast.

    Args:
        num_envs: How many.
        simulator: "mujoco" for `FollowVectorEnv`, "compiled" for `CompiledVectorEnv`, which say what else they take.
        arguments: Of that class.

    Raises:
        InputError: If there is no such simulator, or an argument is wrong.
    """
    if simulator not in SIMULATORS:
        raise unknown_name("simulator", simulator, tuple(SIMULATORS))
    module, name = SIMULATORS[simulator]
    return getattr(import_module(module, __package__), name)(num_envs, **arguments)
