"""Maps: ROS YAML with an image beside it, BeeSoft grids."""

from pathlib import Path
from typing import Any

from borders.logs import hostile
from fuzzer import grammars
from fuzzer.border import Area, Border, Input
from fuzzer.files import put, put_all
from fuzzer.mutations import mutated_bytes, mutated_text
from fuzzer.sanity import sane_map
from numpy.random import Generator
from tagalong.slam import read_ros_map
from tagalong.slam.logs.beesoft import read_beesoft_map
from tagalong.slam.logs.flat_yaml import read_flat_yaml

_IMAGES = (b"map.pgm", b"../map.pgm", b"/dev/zero", b"map.yaml", b".", b"", b"n" * 5000, b"map\x00.pgm", b"/dev/stdin")


def _ros_map(rng: Generator) -> Input:
    """Return a map of which the YAML, the image or both are mutated, or which names another image."""
    files = {"map.yaml": grammars.map_yaml(rng), "map.pgm": grammars.map_image(rng)}
    draw = rng.random()
    if draw < 0.45:
        files["map.yaml"] = mutated_text(rng, files["map.yaml"])
    elif draw < 0.5:
        files["map.yaml"] = files["map.yaml"].replace(b"map.pgm", _IMAGES[int(rng.integers(len(_IMAGES)))])
    if draw > 0.4:
        change = mutated_text if rng.random() < 0.5 else mutated_bytes
        files["map.pgm"] = change(rng, files["map.pgm"])
    if draw > 0.97:
        del files["map.pgm"]
    return files


def _read_map(value: Input, folder: Path) -> Any:
    return read_ros_map(put_all(folder / "map", value) / "map.yaml")


AREA = Area(
    (
        Border(name="maps.ros", make=_ros_map, call=_read_map, sane=sane_map, ms=0.41),
        Border(
            name="maps.beesoft", make=hostile(grammars.beesoft_map), file="b.map", ms=0.71, sane=sane_map,
            call=lambda value, folder: read_beesoft_map(put(folder, "b.map", value)),
        ),
        Border(
            name="maps.yaml", make=hostile(grammars.map_yaml), file="m.yaml", ms=1.2,
            call=lambda value, folder: read_flat_yaml(put(folder, "m.yaml", value)),
        ),
    )
)  # fmt: skip
