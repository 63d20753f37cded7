"""The experiment of Ye et al. 2021, III: mapping behind a leader, from raw and from filtered scans; and its sweep."""

from .experiment import EXPERIMENT

__all__ = ["EXPERIMENT"]
