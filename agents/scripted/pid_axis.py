"""One axis of a PID controller."""

from dataclasses import dataclass

from ...slam.errors import InputError


@dataclass(frozen=True, kw_only=True)
class AxisConfig:
    """Gains of one axis.

    Attributes:
        proportional: Output per error [1/s].
        integral: Output per integrated error [1/s^2].
        derivative: Output per rate of the error [-].
        integral_limit: Largest part of the output that the integral may hold; beyond it, it stops (no wind-up).
        derivative_filter_s: Time constant of the low-pass on the derivative [s].
    """

    proportional: float
    integral: float = 0.0
    derivative: float = 0.0
    integral_limit: float = 0.2
    derivative_filter_s: float = 0.3

    def __post_init__(self) -> None:
        for name in ("proportional", "integral", "derivative", "integral_limit"):
            if getattr(self, name) < 0.0:
                raise InputError(f"`{name}` must not be negative, got {getattr(self, name)}")
        if not self.derivative_filter_s > 0.0:
            raise InputError(f"`derivative_filter_s` must be positive [s], got {self.derivative_filter_s}")


class Axis:
    """A PID controller of one quantity, called once a control step."""

    def __init__(self, config: AxisConfig, step_s: float) -> None:
        self._config, self._step_s = config, step_s
        self.reset()

    def reset(self) -> None:
        """Forget the past errors."""
        self._integral = 0.0
        self._rate = 0.0
        self._last: float | None = None

    def update(self, error: float, *, saturated: bool = False) -> float:
        """Return the output for `error`; while `saturated`, the integral only shrinks.

        A jump of the error, as when a leader is seen again elsewhere, counts as its rate for a moment; behind the
        follower's limits of acceleration 0.13 m/s and 0.08 rad/s of it are left at most, and nothing after a second.
        """
        c = self._config
        step = c.integral * error * self._step_s
        if not saturated or step * self._integral < 0.0:
            self._integral = min(max(self._integral + step, -c.integral_limit), c.integral_limit)
        raw = 0.0 if self._last is None else (error - self._last) / self._step_s
        self._rate += (raw - self._rate) * self._step_s / (c.derivative_filter_s + self._step_s)
        self._last = error
        return c.proportional * error + self._integral + c.derivative * self._rate
