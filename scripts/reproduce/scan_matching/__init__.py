"""The experiments of Cuzzocrea et al. 2022, section 3: hybrid genetic scan matching; and what beats it."""

from .experiment import EXPERIMENT

__all__ = ["EXPERIMENT"]
