"""Simulated sensors: the laser and the RGB-D camera."""
