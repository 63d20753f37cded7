"""The colours of the top view."""

FLOOR = (246, 243, 236)
GRID = (150, 140, 120, 26)
OUTSIDE = (214, 219, 225)
SHADOW = (40, 44, 60, 46)
WALL = (58, 66, 84)
WALL_EDGE = (38, 44, 58)
SEAT = (222, 205, 178)
TABLE = (203, 178, 143)
CABINET = (158, 134, 106)
FURNITURE_EDGE = (134, 112, 86)
ROUTE = (120, 130, 150, 70)

SEEN = (66, 133, 244, 26)
RETURN = (214, 48, 66)
DROPPED = (0, 166, 147)

ROBOT = (36, 38, 44)
ROBOT_TRIM = (250, 196, 30)
WHEEL = (18, 18, 20)
PATH = (36, 110, 185, 150)

LEADER = (240, 132, 30)
BYSTANDERS = ((84, 122, 190), (96, 160, 110), (150, 104, 176), (186, 92, 110), (90, 150, 164), (150, 140, 80))
SKIN = (250, 222, 196)
SHOES = (52, 44, 44)
TRACK = (30, 96, 190)
TRACK_LEADER = (222, 96, 0)

PANEL = (28, 32, 42)
PANEL_TEXT = (232, 236, 242)
PANEL_MUTED = (140, 150, 168)
MAP_UNKNOWN = (58, 64, 78)
MAP_FREE = (240, 242, 246)
MAP_OCCUPIED = (14, 16, 22)


def thing(kind: str, top: float) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
    """Return fill and edge of a thing of `kind` whose upper face is at `top` [m]."""
    if kind in ("wall", "pillar", "door"):
        return WALL, WALL_EDGE
    if kind == "table":
        return TABLE, FURNITURE_EDGE
    return (SEAT if top < 0.6 else CABINET), FURNITURE_EDGE
