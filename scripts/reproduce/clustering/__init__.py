"""Landmark SLAM with four clustering methods (Urvina, Aguilar, Prado 2023)."""

from .experiment import EXPERIMENT as EXPERIMENT
