"""How people behave: each behaviour is a small class with one verb, `wish(view, dt)`.

To add one, derive from `Behaviour`, keep what it remembers in attributes, and hand an object of it to the
environment:

    class Shy(Behaviour):
        def wish(self, view, dt):
            return Wish(speed=0.0 if view.robot_distance < 3.0 else 0.8)

    WorldConfig(behaviours=(Shy(), Shy()))
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
