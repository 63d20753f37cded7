"""Reinforcement from nothing on compiled worlds: what is trained on, the worlds for stable-baselines3, and the run."""
