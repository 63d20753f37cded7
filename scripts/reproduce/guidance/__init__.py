"""Table I of Ye et al. 2021, measured: what guides a robot best while it maps."""

from .experiment import EXPERIMENT

__all__ = ["EXPERIMENT"]
