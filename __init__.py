"""Tagalong: follow a person through a building, map it on the way, and keep the people out of the map.

Importing the package is light: it only registers the environment ids with Gymnasium (as strings). The rooms are
`tagalong.slam`, `tagalong.perception`, `tagalong.envs`, `tagalong.agents` and `tagalong.scripts`.
"""

from .envs.registration import register_environments

__version__ = "0.2.0"

register_environments()
