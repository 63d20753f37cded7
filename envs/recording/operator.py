"""A scripted operator: drives the robot along a tour as a person with a joystick would, who sees where it is.

It stands for the recorded drive of Zhang et al. 2019, where a user steered the robot by hand. It reads the true pose,
as that user's eyes did; nothing of the robot's onboard stack goes through it.
"""

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError
from ...slam.geometry import wrap_angle
from ..scenes.polyline import resample
from ..scenes.scene import Scene
from ..world.truth import TrueState

Array = NDArray[np.float64]

_SPACING = 0.05
_AHEAD = 0.45
_TURN = 0.7
_LOOK = 0.5


class Operator:
    """Steers towards a point a little ahead on the tour, slowly, and waits where its plan says so.

    Args:
        scene: The building, with an operator's plan and on the tour of that plan.

    Raises:
        InputError: If the scene has no plan, or the tour of the episode is another one.
    """

    def __init__(self, scene: Scene) -> None:
        if scene.operator is None or scene.operator.route != scene.route_name:
            wanted = "none at all" if scene.operator is None else f"`route={scene.operator.route!r}`"
            raise InputError(f"the operator of scene {scene.name!r} drives {wanted}, got {scene.route_name!r}")
        self._plan = scene.operator
        self._path = resample(scene.route, _SPACING)
        self._end = scene.tour_length
        self._looks = sorted(self._plan.looks)
        self._heading = np.nan

    def command(self, truth: TrueState) -> Array:
        """Return (2,) forward speed and turn rate [m/s, rad/s]."""
        arc = truth.robot_progress
        waits = any(0.0 <= arc - at < 0.5 and truth.time_s < until for at, until in self._plan.waits)
        if waits or arc >= self._end:
            return np.zeros(2)
        if self._looks and arc >= self._looks[0][0]:
            return self._look(truth.robot_pose[2])
        target = self._path[min(int((arc + _AHEAD) / _SPACING), len(self._path) - 1)]
        x, y, theta = truth.robot_pose
        bearing = float(wrap_angle(np.arctan2(target[1] - y, target[0] - x) - theta))
        speed = self._plan.speed * max(0.0, np.cos(bearing)) ** 2
        return np.array([speed, np.clip(1.5 * bearing, -_TURN, _TURN)])

    def _look(self, theta: float) -> Array:
        """Turn to where the next look goes, then to the heading before it, then forget it."""
        arc, angle = self._looks[0]
        if np.isnan(self._heading):
            self._heading = theta
        error = float(wrap_angle(self._heading + angle - theta))
        if abs(error) < 0.05 and angle == 0.0:
            self._looks.pop(0)
            self._heading = np.nan
        elif abs(error) < 0.05:
            self._looks[0] = (arc, 0.0)
        return np.array([0.0, np.clip(1.5 * error, -_LOOK, _LOOK)])

    def done(self, truth: TrueState) -> bool:
        """Return whether the tour is over."""
        return truth.robot_progress >= self._end
