"""How people behave: ours are compiled, each in a file of its own; those of one's own are classes with one verb.

`tagalong.envs.people` says how to add one.
"""

from .behaviour import Behaviour, Wish
from .view import PersonView

__all__ = ["Behaviour", "PersonView", "Wish"]
