"""Thousands of worlds in one compiled call: the same buildings, people and rewards, without MuJoCo."""
