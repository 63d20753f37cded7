"""What moves the robot: its odometry, or, where that stands still, jumps or slips, the motion that it had before.

Odometry of real robots freezes for some scans while the robot drives on and catches up in one, lags, or slips. So each
scan has two predictions since the last one that told where the robot was: by the odometry, and by going on as before
(the same step again, as far as a robot can brake or speed up meanwhile; stamps would tell of a longer step after a
longer time, but those of recorded logs jitter by half of it). Which of them holds is a hidden state of two
values, odometry sound or faulty, that mostly stays as it was; it is filtered by how well each explains the scan (a
Markov switching model; Blom, Bar-Shalom 1988). Where both agree, as nearly always, the second is not looked at. After a
fault there is a third: odometry that was late or frozen tells in the end where the robot went all the while.

How precise sound odometry is differs between robots by a factor of ten, and a match among walls that look alike along
the way may be off by more than good odometry ever is. So it is learned (`odometry_precision`), and sound odometry has
two predictions at one place: as precise as most of its motions were and, for the rest of them, as rough as its error
model. How far off the last match may be is part of both, until a scan is drawn where it was matched: there the robot
stands, by definition.
"""

import copy
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry import between, compose, inverse, stands
from ..scan_to_grid.extrapolator import ExtrapolatorConfig, OdometryExtrapolator, Prediction
from ..scan_to_grid.scan_matcher import GridMatch
from .bridge import Bridge, bridge_over
from .odometry_precision import ROUGH, OdometryPrecision
from .odometry_soundness import OdometrySoundness
from .usual_step import SLIP, UsualStep

Array = NDArray[np.float64]

_AGREE = 3.0  # standard deviations within which, ...
_NEAR = np.array([0.1, 0.05])  # [m, rad] ... and beyond, a match from one prediction finds what it would from the other
_TRUSTED = 0.9  # probability from which sound odometry stands for where the robot is
_LATE = 0.5  # share of odometry that is sound again after a fault that tells where the robot went meanwhile
_VARIES = 0.5  # of a usual step: that a robot stops, or goes twice as fast, is within two standard deviations
_FORGOTTEN = 10  # scans without a match after which it is not known any more how the robot went
_LEAST_STEP = 0.05  # [m, rad] a robot may always go so far between two scans


@dataclass(frozen=True, eq=False)
class MotionHypothesis:
    """One of the ways in which the robot may have moved.

    Attributes:
        odometry: (3,) T_odom_robot of an odometry without faults that moved so.
        prediction: Where that leads.
        cost: Negative logarithm of its probability beforehand.
        sound: Whether the odometry is believed.
    """

    odometry: Array
    prediction: Prediction
    cost: float
    sound: bool

    def cost_at(self, pose: Array, information: Array) -> float:
        """Return the negative log-likelihood of a scan at `pose` (3,), but for how well it fits there.

        What a hypothesis leaves open counts against it as far as the scan could have told: along a corridor, that one
        hypothesis knows the place and the other does not says nothing of which is true (the evidence by Laplace's
        approximation).

        Args:
            pose: T_local_robot.
            information: (3, 3) what the scan tells of it, inverse covariance.
        """
        linear, angular = np.square(self.prediction.sigma).tolist()
        (a, b, c), (d, e, f), (g, h, i) = information.tolist()
        a, b, c = 1.0 + linear * a, linear * b, linear * c
        d, e, f = linear * d, 1.0 + linear * e, linear * f
        g, h, i = angular * g, angular * h, 1.0 + angular * i
        determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
        return self.cost + 0.5 * (self.prediction.squared_distance(pose) + math.log(determinant))

    def is_needless(self, narrower: "MotionHypothesis", pose: Array) -> bool:
        """Return whether this only leaves more open than another one, which fits at `pose` (3,) and asked no more."""
        return narrower.prediction.pose is self.prediction.pose and narrower.prediction.squared_distance(pose) < 1.0


class SwitchingMotion:
    """Predicts poses of the robot in the local frame, and learns whether its odometry can be believed.

    Args:
        config: Error model of sound odometry.

    Attributes:
        odometry: (3,) T_odom_robot of the odometry without its faults; None before the first scan.
        pose: (3,) T_local_robot at the last scan.
        faults: At how many scans the odometry was not believed.
        driven: How far the robot has driven, by its odometry, and over gaps in the log as far as it usually does [m].
        jumped: Whether the robot was found far from where it was thought to be, and its odometry has not agreed since.
    """

    def __init__(self, config: ExtrapolatorConfig) -> None:
        self.config = config
        self._extrapolator: OdometryExtrapolator | None = None
        self._told = np.zeros(3)  # odometry as the robot tells it
        self._offset: Array | None = None  # T_believed_told of the two odometry frames; None: no fault so far
        self._believed = np.zeros(3)  # odometry told, in the frame of the believed one
        self._before: tuple[Array | None, Array] | None = None  # offset and odometry before the newest fault
        self._agree = False  # whether odometry moves the robot as it moved before
        self._doubt = np.zeros(2)  # sigma of the last match, and of motions since that the odometry did not tell
        self._moved = 0.0  # [m] by the odometry since the last scan
        self.soundness, self.precision = OdometrySoundness(), OdometryPrecision()
        self._time_s = 0.0  # of the last scan
        self._gap = False  # whether there is a gap in the log between it and the last match
        self._matched: Array | None = None  # pose at the last match, ...
        self._matched_odometry = np.zeros(3)  # ... the believed odometry, ...
        self._matched_s = 0.0  # ... and when
        self._unmatched = 0  # scans since
        self._usual = UsualStep()
        self._step: Array | None = None  # (3,) between the last two scans that were matched one after the other
        self._bridges = False  # whether the odometry of the last scan is interpolated
        self.odometry: Array | None = None
        self.pose = np.zeros(3)
        self.faults = 0
        self.driven = 0.0
        self.jumped = False

    def copy(self) -> "SwitchingMotion":
        """Return the motion as it is now, to go back to."""
        twin = copy.copy(self)
        twin._extrapolator, twin.soundness = copy.copy(self._extrapolator), copy.copy(self.soundness)
        twin.precision, twin._usual = copy.copy(self.precision), copy.copy(self._usual)
        return twin

    def restarted(self, odometry: Array, pose: Array) -> "SwitchingMotion":
        """Return the motion of a robot of which only the last odometry pose (3,) and `pose` (3,) are known."""
        motion = SwitchingMotion(self.config)
        motion.odometry, motion._told, motion.pose = odometry, odometry, pose
        motion._extrapolator = OdometryExtrapolator(self.config, odometry)
        motion._extrapolator.correct(odometry, pose)
        motion.faults, motion.driven = self.faults, self.driven
        motion.precision, motion.soundness = self.precision, copy.copy(self.soundness)
        motion.soundness.probability = 1.0
        return motion

    def stands_still(self, odometry: Array) -> bool:
        """Return whether the odometry pose T_odom_robot (3,) is the one of the last scan."""
        return self.odometry is not None and stands(between(self._told, odometry))

    def has_caught_up(self, odometry: Array, scans: int) -> bool:
        """Return whether odometry that stood still until now tells by one step of the way of so many `scans`.

        It does if the step is farther from a usual one, as a factor, than a step of that way.

        Args:
            odometry: (3,) T_odom_robot.
            scans: Up to this one.
        """
        told, usual = between(self._told, odometry), np.maximum(self._usual.size, _LEAST_STEP)
        return bool(max(math.hypot(told[0], told[1]) / usual[0], abs(told[2]) / usual[1]) > math.sqrt(scans))

    def bridge(self, odometry: Array, steps: Array) -> tuple[Array, Bridge]:
        """Return where the odometry was at the next of some scans in which the robot went to `odometry`.

        Args:
            odometry: (3,) T_odom_robot at the last of them.
            steps: (n, 3) how the robot seemed to go from each to the next, from the last one taken on.

        Returns:
            (3,) T_odom_robot if it went evenly, and all the ways in which it may have gone.
        """
        assert self.odometry is not None
        whole = between(self.odometry, odometry if self._offset is None else compose(self._offset, odometry))
        ways = bridge_over(whole, steps, self._usual.size, self.config.sigma(whole))
        evenly = compose(self.odometry, ways[0][1].pose)
        return evenly if self._offset is None else compose(inverse(self._offset), evenly), ways

    def leave_open(self, sigma: Array) -> None:
        """Let the last pose be known to `sigma` (2,) [m, rad], standard deviations; 0: its scan was drawn there."""
        self._doubt = sigma

    def predict(self, odometry: Array, time_s: float, bridge: Bridge | None = None) -> list[MotionHypothesis]:
        """Return hypotheses about the motion to the odometry pose T_odom_robot (3,) at `time_s` [s]: a fault last.

        Args:
            odometry: (3,) T_odom_robot.
            time_s: When [s].
            bridge: How the robot may have gone, as `bridge` has it: no other way is a hypothesis then.
        """
        if self._extrapolator is None or self.odometry is None:
            self.odometry = odometry
            self._extrapolator = OdometryExtrapolator(self.config, odometry)
            self._told = odometry
        moved = between(self._told, odometry)
        self._moved = math.hypot(moved[0], moved[1])
        self._told = odometry
        self._time_s = time_s
        self._usual.tick(time_s)
        moves = not stands(moved)
        self._bridges = bridge is not None
        self.soundness.advance(moves)
        self._believed = odometry if self._offset is None else compose(self._offset, odometry)
        x, y, _ = between(self._matched_odometry, self._believed).tolist()
        known = self._matched is not None and self.soundness.probability > 0.5
        self._gap = known and self._usual.skips(math.hypot(x, y), self._unmatched + 1, self._matched_s)
        self.driven += max(self._moved, self._usual.size.item(0) * self._usual.passed if self._gap else 0.0)
        if bridge is not None:
            at = self.odometry
            return [self._guessed(compose(at, way.pose), odds, way.sigma, True) for odds, way in bridge]
        sound = self._by_odometry(self._believed) + (self._caught_up(odometry) if moves else [])
        return sound + self._by_fault()

    def _by_fault(self) -> list[MotionHypothesis]:
        """Return that the robot goes on as before; nothing where odometry says the same, or that is not known."""
        self._agree = False
        going_on = self._going_on()
        if going_on is None:
            return []
        coasted, sigma = going_on
        told = between(self._matched_odometry, self._believed)
        off = np.abs(between(coasted, told))
        most = _AGREE * np.maximum(self.precision.shares, 1.0) * self.config.sigma(told) + _NEAR
        self._agree = math.hypot(off[0], off[1]) <= most[0] and bool(off[2] <= most[1])
        went = compose(self._matched_odometry, coasted)
        fault = 1.0 - self.soundness.probability
        return [] if self._agree else [self._guessed(went, fault, sigma, False)]

    def _going_on(self) -> tuple[Array, Array] | None:
        """Return (3,) how far a robot that goes on as before is from its last match, and (2,) the standard deviations.

        None: nothing is known of how it went before, or there is a gap in the log.
        """
        if self._step is None or self._unmatched >= _FORGOTTEN or self._gap:
            return None
        coasted = self._step
        for _ in range(self._unmatched):
            coasted = compose(self._step, coasted)
        wide = (self._unmatched + 1) * self._usual.change
        return coasted, np.hypot(self.config.sigma(np.zeros(3)), wide)

    @property
    def anywhere(self) -> Prediction | None:
        """Where the robot may have gone since the last match, whatever its odometry says.

        None: there was none, or there is a gap in the log: corridors look alike.
        """
        if self._matched is None or self._gap:
            return None
        return Prediction(self._matched, np.array([self._usual.reach(self._unmatched + 1), np.pi]))

    def found(self, pose: Array) -> MotionHypothesis:
        """Return the hypothesis that the motion, of which the odometry knew nothing, led to `pose` (3,), T_local_robot.

        Wheels that slip, stand still or tell nothing carry no robot anywhere: it stood, went as they say or went on as
        before, but for about half a usual step a scan. A place beyond looks like where the robot is, and is not.
        """
        assert self._matched is not None
        sigma = SLIP / 3.0 + _VARIES * (self._unmatched + 1) * self._usual.size
        places = [self._matched, compose(self._anchor, self._believed)]
        if self._step is not None:
            place = self._matched
            for _ in range(self._unmatched + 1):
                place = compose(place, self._step)
            places.append(place)
        predictions = [Prediction(place, sigma) for place in places]
        nearest = min(predictions, key=lambda prediction: prediction.squared_distance(pose))
        odometry = compose(inverse(self._anchor), pose)
        return MotionHypothesis(odometry, nearest, -math.log(1.0 - self.soundness.probability), False)

    @property
    def _anchor(self) -> Array:
        """(3,) T_local_odom of the believed odometry."""
        assert self._extrapolator is not None
        return self._extrapolator.predict(np.zeros(3)).pose

    def _by_odometry(self, odometry: Array) -> list[MotionHypothesis]:
        """Return that the odometry is believed: precise as it mostly is, and rough as its error model."""
        assert self._extrapolator is not None
        prediction, sound = self._extrapolator.predict(odometry), self.soundness.probability
        precise = self.precision.shares * prediction.sigma
        rough = np.maximum(precise, prediction.sigma)
        each = [(sound, rough)]
        if not np.array_equal(precise, rough):
            each = [((1.0 - ROUGH) * sound, precise), (ROUGH * sound, rough)]
        pose, left = prediction.pose, self._doubt
        return [_hypothesis(odometry, odds, Prediction(pose, np.hypot(sigma, left)), True) for odds, sigma in each]

    def _caught_up(self, told: Array) -> list[MotionHypothesis]:
        """Return that odometry which was late, or frozen, tells by now where the robot went meanwhile; else nothing."""
        if self._before is None:
            return []
        offset, odometry = self._before
        whole = told if offset is None else compose(offset, told)
        x, y, turn = np.abs(between(self._believed, whole)).tolist()
        if math.hypot(x, y) <= _NEAR[0] and turn <= _NEAR[1]:
            return []
        extra = self.config.sigma(between(odometry, whole))
        return [self._guessed(whole, _LATE * self.soundness.probability, extra, True)]

    def _guessed(self, odometry: Array, probability: float, extra: Array, sound: bool) -> MotionHypothesis:
        """Return that the odometry is at a guessed place, of standard deviations `extra` (2,) [m, rad]."""
        assert self._extrapolator is not None
        prediction = self._extrapolator.predict(odometry)
        sigma = np.hypot(np.hypot(prediction.sigma, extra), self._doubt)
        return _hypothesis(odometry, probability, Prediction(prediction.pose, sigma), sound)

    def take(
        self,
        hypotheses: list[MotionHypothesis],
        chosen: MotionHypothesis,
        pose: Array,
        lead: float | None,
        match: GridMatch | None = None,
    ) -> None:
        """Take the `pose` (3,) of the scan that `hypotheses` were made for, and which of them led there.

        Args:
            hypotheses: As `predict` returned them.
            chosen: The one that holds.
            pose: T_local_robot.
            lead: Logarithm of how many times more likely a fault made the scan that is seen there than sound odometry
                did; None: no match says so, the pose is that of the prediction.
            match: How that scan was matched; None: there was nothing to match it on.
        """
        assert self._extrapolator is not None
        guessed = self._bridges or not chosen.sound
        self.faults += guessed
        self._remember(chosen, lead is not None)
        odometry = chosen.odometry
        if lead is not None and guessed:  # what a guess was off by is no error of the odometry before
            odometry = compose(inverse(self._anchor), pose)
        if not self._bridges and not np.array_equal(odometry, self._believed):
            self._offset = compose(odometry, inverse(self._told))
            self._doubt = chosen.prediction.sigma
        self.odometry, self.pose = odometry, pose
        if lead is None:
            self._unmatched += 1
            return
        if not hypotheses[-1].sound:
            self.soundness.weigh(lead)
        elif self._agree:
            self.soundness.agree()
        jumped = match is not None and match.retried
        self.jumped = jumped or (self.jumped and self.soundness.probability < _TRUSTED)
        self._learn(chosen, None if jumped else match)
        self._extrapolator.correct(odometry, pose)
        self._remember_match(pose)

    def _remember(self, chosen: MotionHypothesis, told: bool) -> None:
        """Keep what was believed before a fault until a scan has `told` whether odometry that moves has caught up."""
        assert self.odometry is not None
        if not chosen.sound:
            self._before = self._before or (self._offset, self.odometry)
        elif told and self._moved > 0.0:
            self._before = None

    def _learn(self, chosen: MotionHypothesis, match: GridMatch | None) -> None:
        """Learn how precise the odometry is from the match of `chosen`; None: none where it was expected."""
        assert self._extrapolator is not None
        left = np.zeros(2)
        if match is not None:
            left = chosen.prediction.sigma_after(match.curvature)
            if match.fits and chosen.sound and not self._unmatched and not self._bridges:
                model = self._extrapolator.predict(chosen.odometry)
                self.precision.learn(model, self._doubt, chosen.prediction, match)
        self._doubt = left

    def _remember_match(self, pose: Array) -> None:
        """Remember how far the robot goes between two scans; `pose` (3,) is that of the last match."""
        assert self.odometry is not None
        if self._matched is not None and self._unmatched == 0:
            step = self._step = between(self._matched, pose)
            went = np.array([math.hypot(step[0], step[1]), abs(step[2])])
            self._usual.learn(went)
        self._matched, self._matched_odometry, self._matched_s, self._unmatched = pose, self.odometry, self._time_s, 0


def _hypothesis(odometry: Array, probability: float, prediction: Prediction, sound: bool) -> MotionHypothesis:
    return MotionHypothesis(odometry, prediction, -math.log(probability), sound)


def likeliest(motion: SwitchingMotion, hypotheses: list[MotionHypothesis]) -> MotionHypothesis:
    """Return the likeliest of what `predict` returned, where no scan tells: sound odometry has several of them."""
    return hypotheses[0 if motion.soundness.probability >= 0.5 else -1]
