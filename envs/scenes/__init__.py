"""The buildings.

A scene is drawn anew in each episode. To add one, write a function that takes the source of all draws and what was
asked for, and returns a `Scene`: walls and furniture, the floor, and at least one route that the robot can drive, the
last 3 m (`RUN_OUT`) of it behind the place where the leader stops. Hand the function to the environment:

    def hall(rng, request):
        long = rng.uniform(15.0, 20.0)
        walls = room((0.0, -2.5), (long, 2.5))
        pillar = post("pillar", 0.5 * long, -1.5, radius=0.25, top=2.5)
        floor = np.array([(0.0, -2.5), (long, -2.5), (long, 2.5), (0.0, 2.5)])
        tour = rounded([(1.0, 0.0), (0.5 * long, 0.5), (long - 1.0, 0.0)], radius=1.0)
        return Scene(
            name="hall",
            solids=(*walls, pillar),
            floor=floor,
            routes={"along": tour},
            route_name="along",
            half_width=1.0,
        )

    gymnasium.make("tagalong/Corridor-v0", scene=hall)

A building is made of `Solid`s: `room`, `box` and `post` return some. `rounded` makes a way with round corners, and
`choose_route` draws one of several. A scene may have a `Door`, a `Walk` for a bystander, an `Errand` for somebody.
`SceneMaker` is the type of such a function, whose `request` is a `SceneRequest`; ours stand in `SCENES`, and
`make_scene(name, rng)` calls one of them.
"""

from .catalogue import SCENES, make_scene
from .polyline import rounded
from .request import SceneMaker, SceneRequest
from .scene import RUN_OUT, Door, Errand, Scene, Walk, choose_route
from .solids import Solid, box, post, room

__all__ = [
    "RUN_OUT",
    "SCENES",
    "Door",
    "Errand",
    "Scene",
    "SceneMaker",
    "SceneRequest",
    "Solid",
    "Walk",
    "box",
    "choose_route",
    "make_scene",
    "post",
    "room",
    "rounded",
]
