"""Scan matching: the pose of one scan in the frame of another."""
