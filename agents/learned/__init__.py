"""Learned followers: what the network is told, the network in plain numpy, and how smoothly its wishes are driven."""
