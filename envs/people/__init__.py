"""The people: who they are, what they want, and how they walk.

What a person wants is said by its behaviour, a small class with one verb, `wish(view, dt)`. To add people with a
behaviour of one's own, derive from `Behaviour` and hand objects of the class to the environment:

    class Shy(Behaviour):
        def wish(self, view, dt):
            return Wish(speed=0.0 if view.robot_distance < 3.0 else 0.8)

    gymnasium.make("tagalong/Corridor-v0", behaviours=[Shy(), Shy()])

`PersonView` says what a person sees: itself, its way, the robot, and the others. What the object remembers stands in
its attributes; it is copied for each episode, and saved and restored with the world.
"""

from .behaviours import Behaviour, PersonView, Wish

__all__ = ["Behaviour", "PersonView", "Wish"]
