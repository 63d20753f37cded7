"""The social force in plain numpy, as the paper writes it."""

import numpy as np
from numpy.typing import NDArray
from tagalong.envs.people.movement.social_force import NOTICED, SocialForceConfig

Array = NDArray[np.float64]


def social_force(offset: Array, relative_velocity: Array, config: SocialForceConfig) -> Array:
    """Return the force (2,) [m/s^2] that another person makes on this one; the reference of `pair_force`.

    Args:
        offset: (2,) the other's position minus this one's [m].
        relative_velocity: (2,) this one's velocity minus the other's [m/s].
        config: Strengths.
    """
    distance = float(np.hypot(*offset))
    direction = offset / distance
    interaction = config.velocity_weight * relative_velocity + direction
    reach = config.gamma * float(np.hypot(*interaction))
    if reach == 0.0 or distance > NOTICED * reach:
        return np.zeros(2)
    ahead = interaction / np.hypot(*interaction)
    angle = float(np.arctan2(ahead[1], ahead[0]) - np.arctan2(direction[1], direction[0]))
    angle = (angle + np.pi) % (2.0 * np.pi) - np.pi
    left = np.array([-ahead[1], ahead[0]])
    brake = np.exp(-distance / reach - (config.n_prime * reach * angle) ** 2)
    turn = -np.sign(angle) * np.exp(-distance / reach - (config.n * reach * angle) ** 2)
    return config.social_factor * (brake * ahead + turn * left) * -1.0
