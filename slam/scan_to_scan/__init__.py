"""Scan matching: the pose of one scan in the frame of another."""

from .match import Match, Matcher
from .matchers import MATCHERS, make_matcher

__all__ = ["MATCHERS", "Match", "Matcher", "make_matcher"]
