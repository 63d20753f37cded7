"""Recorded drives as SLAM takes them: read from any log, without the bend of slow sweeps, their odometry checked."""
