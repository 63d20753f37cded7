"""How people behave: each behaviour is a small class with one verb, `wish(view, dt)`, in a file of its own.

`tagalong.envs.people` says how to add one.
"""

from .behaviour import Behaviour, Wish
from .companion import Companion
from .leader import Leader
from .scripted import Scripted
from .stander import Stander
from .view import PersonView
from .walker import Walker
from .wanderer import Wanderer

__all__ = ["Behaviour", "Companion", "Leader", "PersonView", "Scripted", "Stander", "Walker", "Wanderer", "Wish"]
