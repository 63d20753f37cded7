"""`tagalong reproduce immobile`: the immobile-area grid map of Zhang et al. 2019 in the simulated lab."""

from .experiment import EXPERIMENT

__all__ = ["EXPERIMENT"]
