"""Which simulator steps the environments of `gymnasium.make_vec`."""

from typing import Any

from gymnasium.vector import VectorEnv

from ...slam.errors import unknown_name
from ..vector.arguments import checked_arguments

SIMULATORS = "mujoco", "compiled", "cuda"


def make_vector_env(num_envs: int = 1, *, simulator: str = "mujoco", **arguments: Any) -> VectorEnv[Any, Any, Any]:
    """Return `num_envs` environments: "mujoco" has everything, the others are far faster.

    Args:
        num_envs: How many.
        simulator: "mujoco" for `FollowVectorEnv`, "compiled" for `CompiledVectorEnv`, "cuda" for `CudaVectorEnv`,
            which say what else they take.
        arguments: Of that class.

    Raises:
        InputError: If there is no such simulator, or an argument is wrong.
    """
    if simulator not in SIMULATORS:
        raise unknown_name("simulator", simulator, SIMULATORS)
    num_envs, arguments = checked_arguments(num_envs, arguments)
    if simulator == "compiled":
        from ..compiled.vector_env import CompiledVectorEnv  # here, for it imports numba

        return CompiledVectorEnv(num_envs, **arguments)
    if simulator == "cuda":
        from ..cuda_worlds.vector_env import CudaVectorEnv  # here, for it imports numba's CUDA

        return CudaVectorEnv(num_envs, **arguments)
    from ..vector.vector_env import FollowVectorEnv

    return FollowVectorEnv(num_envs, **arguments)
