"""What moves the robot: its odometry, or, where that stands still, jumps or slips, the motion that it had before.

Odometry of real robots freezes for some scans while the robot drives on and catches up in one, lags, or slips. So each
scan has two predictions since the last one that told where the robot was: by the odometry, and by going on as before
(constant velocity, as far as a robot can brake or speed up meanwhile). Which of them holds is a hidden state of two
values, odometry sound or faulty, that mostly stays as it was; it is filtered by how well each predicted the motions
that matching found (a Markov switching model; Blom, Bar-Shalom 1988). Where both agree, as nearly always, the second is
not looked at.

How precise sound odometry is differs between robots by a factor of ten, and a match among walls that look alike along
the way may be off by more than good odometry ever is. So it is learned how well the odometry predicted the last
matches, and sound odometry has two predictions at the same place: one as precise as most of its motions were, and, for
the rest of them, one as rough as its error model.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry import between, compose, inverse
from ...scan_to_grid.extrapolator import ExtrapolatorConfig, OdometryExtrapolator, Prediction

Array = NDArray[np.float64]

_ERRORS = 20  # so many of the newest tell how precise the odometry is; at first, they are those of its model
_MOST_PRECISE = 0.2  # of the error model's standard deviations: below, a match errs as much
_ROUGH = 0.3  # share of sound motions with errors as in the model, as where a wheel slips a little
_MEDIAN = np.array([1.177, 0.6745])  # of normal errors of standard deviation 1, in the plane and on a line
_BREAKS, _HEALS = 0.001, 0.1  # probability that sound odometry fails with the next scan, and that a fault ends
_ACCELERATION = np.array([1.0, 2.0])  # [m/s^2, rad/s^2] of a wheeled robot among people, a standard deviation
_AGREE = 3.0  # standard deviations within which, ...
_NEAR = np.array([0.1, 0.05])  # [m, rad] ... and beyond, a match from one prediction finds what it would from the other
_TRUSTED = 0.9  # probability from which sound odometry stands for where the robot is
_CHANCE = 0.1  # share of faulty motions that agree with both predictions
_SLIP, _STEPS = np.array([0.5, 0.5]), 3.0  # [m, rad] a robot without odometry may be so far, and so many usual steps
_FARTHEST = np.array([5.0, np.pi])  # [m, rad] and no farther
_MEMORY = 0.1  # weight of the newest step in the usual one
_SHORTEST = 1e-3  # [s] no laser turns faster; stamps that are nearer to each other tell no time
_FORGOTTEN = 10  # scans without a match after which it is not known any more how the robot went
_LONGER = 3.0  # times the step before; after a longer gap the motion before says nothing


@dataclass(frozen=True, eq=False)
class MotionHypothesis:
    """One of the ways in which the robot may have moved.

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
        self._time = self._step_s = self._before_s = 0.0  # [s] of the last scan; between the last two; those before
        self._matched: Array | None = None  # pose at the last match ...
        self._matched_odometry = np.zeros(3)  # ... and the believed odometry
        self._unmatched = 0  # scans since
        self._usual = np.zeros(2)  # step between two scans [m, rad]
        self._step: Array | None = None  # (3,) between the last two scans that were matched one after the other
        self._errors = [np.ones(2)] * _ERRORS  # of the predictions, as shares of their standard deviations
        self._precision = np.ones(2)  # standard deviations of most motions, likewise
        self.odometry: Array | None = None
        self.faults = 0
        self.jumped = False

    def restarted(self, odometry: Array, pose: Array) -> "SwitchingMotion":
        """Return the motion of a robot of which only the last odometry pose (3,) and `pose` (3,) are known."""
        motion = SwitchingMotion(self._config)
        motion.odometry = motion._told = odometry
        motion._extrapolator = OdometryExtrapolator(self._config, odometry)
        motion._extrapolator.correct(odometry, pose)
        motion.faults = self.faults
        motion._errors, motion._precision = self._errors, self._precision
        return motion

    def predict(self, odometry: Array, time_s: float) -> list[MotionHypothesis]:
        """Return hypotheses about the motion to the odometry pose T_odom_robot (3,) at `time_s` [s]: a fault last."""
        if self._extrapolator is None or self.odometry is None:
            self.odometry = odometry
            self._extrapolator = OdometryExtrapolator(self._config, odometry)
            self._told, self._time = odometry, time_s
        moved = between(self._told, odometry)
        self._moved = math.hypot(moved[0], moved[1])
        elapsed = time_s - self._time
        self._told, self._time = odometry, time_s
        self._before_s, self._step_s = self._step_s, elapsed
        self._sound = self._sound * (1.0 - _BREAKS) + (1.0 - self._sound) * _HEALS
        believed = odometry if self._offset is None else compose(self._offset, odometry)
        sound = self._by_odometry(believed)
        going_on = self._going_on(elapsed)
        if going_on is None:
            return sound
        coasted, sigma = going_on
        moved = between(self._matched_odometry, believed)
        off = np.abs(between(coasted, moved))
        most = _AGREE * self._config.sigma(moved) + _NEAR
        if math.hypot(off[0], off[1]) <= most[0] and off[2] <= most[1]:
            return sound
        went = compose(self._matched_odometry, coasted)
        fault = self._hypothesis(went, 1.0 - self._sound, np.ones(2), sigma, False)
        # a fault is as likely beside odometry that turned out precise as beside any
        narrower = 2.0 * math.log(self._precision[0]) + math.log(self._precision[1])
        return [*sound, replace(fault, cost=fault.cost + narrower)]

    def _going_on(self, elapsed: float) -> tuple[Array, Array] | None:
        """Return (3,) how far a robot that goes on as before is from its last match, and (2,) the standard deviations.

        None: nothing is known of how it went before.

        Args:
            elapsed: Since the last scan [s].
        """
        timed = elapsed >= _SHORTEST and self._before_s >= _SHORTEST
        longer = elapsed / self._before_s if timed else 1.0
        if self._step is None or longer > _LONGER or self._unmatched >= _FORGOTTEN:
            return None
        coasted = longer * self._step
        for _ in range(self._unmatched):
            coasted = compose(self._step, coasted)
        wide = np.minimum(_ACCELERATION * elapsed**2, self._usual) if timed else self._usual
        return coasted, np.hypot(self._config.sigma(np.zeros(3)), (self._unmatched + 1) * wide)

    @property
    def anywhere(self) -> Prediction | None:
        """Where the robot may have gone since the last match, whatever its odometry says.

        None: there was none, or sound odometry tells of a way that is longer, as across a gap in a log.
        """
        reach = np.minimum(_SLIP + _STEPS * (self._unmatched + 1) * self._usual, _FARTHEST)
        gap = self._sound > 0.5 and self._moved > reach[0]
        return None if self._matched is None or gap else Prediction(self._matched, reach)

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

    def _by_odometry(self, odometry: Array) -> list[MotionHypothesis]:
        """Return that the odometry is believed: precise as it mostly is, and rough as its error model."""
        one, none = np.ones(2), np.zeros(2)
        if self._precision.min() == 1.0:
            return [self._hypothesis(odometry, self._sound, one, none, True)]
        precise = self._hypothesis(odometry, (1.0 - _ROUGH) * self._sound, self._precision, none, True)
        return [precise, self._hypothesis(odometry, _ROUGH * self._sound, one, none, True)]

    def _hypothesis(
        self, odometry: Array, probability: float, precision: Array, extra: Array, sound: bool
    ) -> MotionHypothesis:
        assert self._extrapolator is not None
        prediction = self._extrapolator.predict(odometry)
        sigma = np.hypot(np.hypot(precision * prediction.sigma, self._doubt), extra)
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
            if not hypotheses[-1].sound:
                lead = min(h.cost_at(pose) for h in hypotheses if h.sound) - hypotheses[-1].cost_at(pose)
                self._sound = 1.0 / (1.0 + math.exp(min(lead, 700.0)))
            else:
                self._sound /= self._sound + _CHANCE * (1.0 - self._sound)
            self.jumped = jumped or (self.jumped and self._sound < _TRUSTED)
            self._sound = min(max(self._sound, _BREAKS**2), 1.0 - _BREAKS**2)
            if chosen.sound and not jumped and not self._unmatched:
                self._judge(self._extrapolator.predict(chosen.odometry), pose)
            self._extrapolator.correct(chosen.odometry, pose)
            self._doubt = np.zeros(2)
            self._learn(pose)
        else:
            self._unmatched += 1

    def _judge(self, prediction: Prediction, pose: Array) -> None:
        """Learn how precise sound odometry is by what matching made of a `prediction`: a median minds no slips."""
        x, y, turn = between(prediction.pose, pose).tolist()
        error = np.array([math.hypot(x, y), abs(turn)]) / (_MEDIAN * prediction.sigma)
        self._errors = [*self._errors[1:], error]
        self._precision = np.clip(np.median(self._errors, axis=0), _MOST_PRECISE, 1.0)

    def _learn(self, pose: Array) -> None:
        """Remember how far the robot goes between two scans; `pose` (3,) is that of the last match."""
        assert self.odometry is not None
        if self._matched is not None and self._unmatched == 0:
            step = self._step = between(self._matched, pose)
            self._usual += _MEMORY * (np.array([math.hypot(step[0], step[1]), abs(step[2])]) - self._usual)
        self._matched, self._matched_odometry, self._unmatched = pose, self.odometry, 0
