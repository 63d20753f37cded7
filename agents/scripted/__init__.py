"""Followers and explorers by rules: PID, pure pursuit, dynamic window, frontiers, random walk."""
