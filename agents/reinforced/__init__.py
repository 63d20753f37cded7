"""Followers that were reinforced from nothing: a small network, and the safety filter that it was trained with.

All names are private; `make_follower("reinforced")` or the name of a folder makes one, with "-alone" behind it the
network alone.
"""
