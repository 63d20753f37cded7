"""Driving by hand: joystick logs, gamepad, keyboard, and a model of an operator."""
