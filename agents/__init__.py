"""Followers: what drives the robot."""
