"""The choice between arrays of the processor and tensors on the GPU."""

from typing import Any

from ...slam.errors import unknown_name
from .vector_env import CudaVectorEnv

OUTPUTS = "numpy", "torch"


def make_cuda_env(num_envs: int, *, output: str = "numpy", **arguments: Any) -> CudaVectorEnv:
    """Return worlds on the GPU; `output` is "numpy" for `CudaVectorEnv`, "torch" for `TensorVectorEnv`.

    Raises:
        InputError: If an argument is wrong, or there is no GPU.
    """
    if output not in OUTPUTS:
        raise unknown_name("output", output, OUTPUTS)
    if output == "torch":
        from .tensors import TensorVectorEnv

        return TensorVectorEnv(num_envs, **arguments)
    return CudaVectorEnv(num_envs, **arguments)
