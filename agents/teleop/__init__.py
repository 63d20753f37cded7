"""Driving by hand: joystick logs, gamepad, keyboard, and a model of an operator.

    record_drive(env_id, kwargs, seed) -> JoystickLog           a drive of the model; or of your own operator, of which
                                                                `KeyboardStick` is an example
    replay_drive(log) -> Episode                                the same drive again
    read_joystick_log(path), write_joystick_log(path, log)      logs as small text files; shipped ones by their name
    JoystickReplay(log, env_id, kwargs, seed)                   a log as a follower

All other names are private.
"""

from typing import TYPE_CHECKING

from ...slam.door import lends

if TYPE_CHECKING:
    from .joystick import JoystickLog, JoystickReplay, read_joystick_log, write_joystick_log
    from .joystick_drive import record_drive, replay_drive
    from .keyboard import KeyboardStick

__all__ = [
    "JoystickLog",
    "JoystickReplay",
    "KeyboardStick",
    "read_joystick_log",
    "record_drive",
    "replay_drive",
    "write_joystick_log",
]

_HOME = {
    "JoystickLog": "joystick",
    "JoystickReplay": "joystick",
    "KeyboardStick": "keyboard",
    "read_joystick_log": "joystick",
    "record_drive": "joystick_drive",
    "replay_drive": "joystick_drive",
    "write_joystick_log": "joystick",
}
"""Public name -> module; imported when it is asked for."""

__getattr__, __dir__ = lends(__name__, _HOME)
