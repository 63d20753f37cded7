"""Followers that were reinforced from nothing: a small network that drives alone, and one safety filter on the way.

All names are private; `make_follower("reinforced")` or the name of a folder makes one, with "+guard" behind it the same
with the safety filter.
"""
