"""The robot: its base, its wheel odometry, and a scripted operator that drives it."""
