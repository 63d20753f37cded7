"""What moves the robot: its odometry, or, where that stands still, jumps or slips, the motion that it had before.

Odometry of real robots freezes for some scans while the robot drives on and catches up in one, lags, or slips. So each
scan has two predictions: by the odometry, and by going on as before (constant velocity, as far as a robot can brake or
speed up between two scans). Which of them holds is a hidden state of two values, odometry sound or faulty, that mostly
stays as it was; it is filtered by how well each predicted the motions that matching found (a Markov switching model;
Blom, Bar-Shalom 1988). Where both agree, as nearly always, the second is not looked at.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry import between, compose, inverse
from ...scan_to_grid.extrapolator import ExtrapolatorConfig, OdometryExtrapolator, Prediction

Array = NDArray[np.float64]

_BREAKS, _HEALS = 0.001, 0.1  # probability that sound odometry fails with the next scan, and that a fault ends
_ACCELERATION = np.array([1.0, 2.0])  # [m/s^2, rad/s^2] of a wheeled robot among people, a standard deviation
_AGREE = 3.0  # standard deviations within which a match from one prediction finds what it would from the other
_TRUSTED = 0.9  # probability from which sound odometry stands for where the robot is
_CHANCE = 0.1  # share of faulty motions that agree with both predictions
_SLIP, _STEPS = np.array([0.5, 0.5]), 3.0  # [m, rad] a robot without odometry may be so far, and so many usual steps
_FARTHEST = np.array([5.0, np.pi])  # [m, rad] and no farther
_MEMORY = 0.1  # weight of the newest step in the usual one
_SHORTEST = 1e-3  # [s] no laser turns faster; stamps that are nearer to each other tell no velocity
_LONGEST = 1.0  # [s] after a longer gap a velocity says nothing


@dataclass(frozen=True, eq=False)
class MotionHypothesis:
    """One of the two ways in which the robot may have moved.

    Attributes:
        odometry: (3,) T_odom_robot of an odometry without faults that moved so.
        prediction: Where that leads.
        cost: Negative logarithm of its probability beforehand, and of the width of what it allows.
        sound: Whether the odometry is believed.
    """

    odometry: Array
    prediction: Prediction
    cost: float
    sound: bool

    def cost_at(self, pose: Array) -> float:
        """Return the negative log-likelihood of `pose` (3,) T_local_robot, up to a constant."""
        x, y, turn = between(self.prediction.pose, pose).tolist()
        linear, angular = self.prediction.sigma.tolist()
        return self.cost + 0.5 * ((x * x + y * y) / linear**2 + (turn / angular) ** 2)


class SwitchingMotion:
    """Predicts poses of the robot in the local frame, and learns whether its odometry can be believed.

    Args:
        config: Error model of sound odometry.

    Attributes:
        odometry: (3,) T_odom_robot of the odometry without its faults; None before the first scan.
        faults: At how many scans the odometry was not believed.
        jumped: Whether the robot was found far from where it was thought to be, and its odometry has not agreed since.
    """

    def __init__(self, config: ExtrapolatorConfig) -> None:
        self._config = config
        self._extrapolator: OdometryExtrapolator | None = None
        self._told = np.zeros(3)  # odometry as the robot tells it
        self._offset: Array | None = None  # T_believed_told of the two odometry frames; None: no fault so far
        self._doubt = np.zeros(2)  # sigma of the motions since the last match that the odometry did not tell
        self._moved = 0.0  # [m] by the odometry since the last scan
        self._sound = 1.0  # probability
        self._time = self._step_s = 0.0
        self._pose: Array | None = None  # at the last scan
        self._usual = np.zeros(2)  # step between two scans [m, rad]
        self._velocity: Array | None = None  # (3,) of the robot's frame, by the last two poses [m/s, m/s, rad/s]
        self.odometry: Array | None = None
        self.faults = 0
        self.jumped = False

    def predict(self, odometry: Array, time_s: float) -> list[MotionHypothesis]:
        """Return one or both hypotheses about the motion to the odometry pose T_odom_robot (3,) at `time_s` [s]."""
        if self._extrapolator is None or self.odometry is None:
            self.odometry = odometry
            self._extrapolator = OdometryExtrapolator(self._config, odometry)
            self._told, self._time = odometry, time_s
        moved = between(self._told, odometry)
        self._moved = math.hypot(moved[0], moved[1])
        elapsed = time_s - self._time
        self._told, self._time, self._step_s = odometry, time_s, elapsed
        self._sound = self._sound * (1.0 - _BREAKS) + (1.0 - self._sound) * _HEALS
        believed = odometry if self._offset is None else compose(self._offset, odometry)
        sound = self._hypothesis(believed, np.zeros(2), True)
        if self._velocity is None or not _SHORTEST <= elapsed <= _LONGEST:
            return [sound]
        coasted = elapsed * self._velocity
        floor = self._config.sigma(np.zeros(3))
        sigma = np.hypot(floor, _ACCELERATION * elapsed**2)
        off = np.abs(between(coasted, moved))
        most = _AGREE * np.hypot(sigma, self._config.sigma(moved))
        if math.hypot(off[0], off[1]) <= most[0] and off[2] <= most[1]:
            return [sound]
        return [sound, self._hypothesis(compose(self.odometry, coasted), sigma, False)]

    @property
    def anywhere(self) -> Prediction | None:
        """Where the robot may have gone since the last scan, whatever its odometry says.

        None: there was no scan, or sound odometry tells of a way that is longer, as across a gap in a log.
        """
        reach = np.minimum(_SLIP + _STEPS * self._usual, _FARTHEST)
        gap = self._sound > 0.5 and self._moved > reach[0]
        return None if self._pose is None or gap else Prediction(self._pose, reach)

    def found(self, pose: Array, sigma: Array) -> MotionHypothesis:
        """Return the hypothesis that the motion, of which the odometry knew nothing, led to `pose` (3,).

        Args:
            pose: T_local_robot.
            sigma: (2,) within which it was sought [m, rad].
        """
        assert self._extrapolator is not None
        anchor = self._extrapolator.predict(np.zeros(3)).pose  # T_local_odom of the believed odometry
        cost = -math.log(1.0 - self._sound) + 2.0 * math.log(sigma[0]) + math.log(sigma[1])
        return MotionHypothesis(compose(inverse(anchor), pose), Prediction(pose, sigma), cost, False)

    def _hypothesis(self, odometry: Array, extra: Array, sound: bool) -> MotionHypothesis:
        assert self._extrapolator is not None
        prediction = self._extrapolator.predict(odometry)
        sigma = np.hypot(np.hypot(prediction.sigma, self._doubt), extra)
        probability = self._sound if sound else 1.0 - self._sound
        cost = -math.log(probability) + 2.0 * math.log(sigma[0]) + math.log(sigma[1])
        return MotionHypothesis(odometry, Prediction(prediction.pose, sigma), cost, sound)

    def take(
        self,
        hypotheses: list[MotionHypothesis],
        chosen: MotionHypothesis,
        pose: Array,
        matched: bool,
        jumped: bool = False,
    ) -> None:
        """Take the `pose` (3,) of the scan that `hypotheses` were made for, and which of them led there.

        Args:
            hypotheses: As `predict` returned them.
            chosen: The one that holds.
            pose: T_local_robot.
            matched: Whether a match says so; else the pose is that of the prediction.
            jumped: Whether that match was found only far from the prediction.
        """
        assert self._extrapolator is not None
        self.faults += not chosen.sound
        if not chosen.sound:
            self._offset = compose(chosen.odometry, inverse(self._told))
            self._doubt = chosen.prediction.sigma
        self.odometry = chosen.odometry
        if matched:
            if len(hypotheses) == 2:
                lead = hypotheses[0].cost_at(pose) - hypotheses[1].cost_at(pose)
                self._sound = 1.0 / (1.0 + math.exp(min(lead, 700.0)))
            else:
                self._sound /= self._sound + _CHANCE * (1.0 - self._sound)
            self.jumped = jumped or (self.jumped and self._sound < _TRUSTED)
            self._sound = min(max(self._sound, _BREAKS**2), 1.0 - _BREAKS**2)
            self._extrapolator.correct(chosen.odometry, pose)
            self._doubt = np.zeros(2)
        if self._pose is not None:
            step = between(self._pose, pose)
            self._usual += _MEMORY * (np.array([math.hypot(step[0], step[1]), abs(step[2])]) - self._usual)
            self._velocity = step / self._step_s if self._step_s >= _SHORTEST else None
        self._pose = pose
