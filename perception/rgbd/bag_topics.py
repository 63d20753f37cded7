"""Which topics of a bag are one RGB-D camera's: depth, colour and the intrinsics of both."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import Any

from ...slam.errors import InputError, shown
from ...slam.logs.bag_messages import Bag
from ...slam.logs.ros_frames import frame_name
from .ros_pictures import CAMERA_INFO, COLOURS, COMPRESSED, IMAGE, is_depth

_OTHERS = ("ir", "infra", "infra1", "infra2", "confidence", "amplitude", "disparity")
_COLOURED = ("color", "colour", "rgb")
_REGISTERED = ("aligned_depth", "depth_registered", "depth_to_rgb", "registered")


@dataclass(frozen=True, kw_only=True)
class CameraTopics:
    """Topics of one camera; None: to be found, or there is none.

    Attributes:
        depth: Of depth pictures, raw or compressedDepth.
        colour: Of colour pictures, raw or compressed.
        depth_info: Of the `camera_info` of the depth pictures.
        colour_info: Of the colour pictures.
    """

    depth: str | None = None
    colour: str | None = None
    depth_info: str | None = None
    colour_info: str | None = None


@dataclass(frozen=True)
class _Pictures:
    topic: str
    depth: bool
    colour: bool
    frame: str

    @property
    def raw(self) -> bool:
        return not self.topic.endswith(("/compressed", "/compressedDepth"))

    @property
    def base(self) -> str:
        """The topic of the pictures before they were compressed."""
        return self.topic.removesuffix("/compressed").removesuffix("/compressedDepth")


def has_depth(bag: Bag) -> bool:
    """Return whether there is a topic of depth pictures."""
    return any(pictures.depth for pictures in _pictures(bag))


def choose_topics(bag: Bag, wanted: CameraTopics, path: Path) -> CameraTopics:
    """Return the topics of the camera.

    Depth that was registered to the colour is taken before other depth, raw pictures before compressed ones, and of the
    colours that whose name is most like the depth's.

    Raises:
        InputError: If there is no depth, several cameras' or no intrinsics of it, or a wanted topic is not there.
    """
    pictures = _pictures(bag)
    depth = _depth(pictures, wanted.depth, path)
    colour = _colour(pictures, depth, wanted.colour, path)
    infos = bag.of_type(CAMERA_INFO)
    for topic in (wanted.depth_info, wanted.colour_info):
        if topic is not None and topic not in infos:
            raise InputError(f"{path}: no topic {shown(topic)} of type {CAMERA_INFO}; it has: {_listed(infos)}")
    info = wanted.depth_info or _info(infos, depth.base)
    colour_info = wanted.colour_info or (_info(infos, colour.base) if colour else None)
    if info is None and colour is not None and colour.frame == depth.frame:
        info = colour_info
    info = info or (infos[0] if len(infos) == 1 else None)
    if info is None:
        raise InputError(
            f"{path}: no camera_info beside {depth.topic}; choose one by --camera-info-topic: {_listed(infos)}"
        )
    return CameraTopics(
        depth=depth.topic, colour=colour.topic if colour else None, depth_info=info, colour_info=colour_info
    )


def _depth(pictures: Sequence[_Pictures], wanted: str | None, path: Path) -> _Pictures:
    found = [each for each in pictures if each.depth]
    if wanted is not None:
        return _wanted(found, wanted, "depth pictures", path)
    named = [each for each in found if "depth" in each.topic.lower()] or found
    if not named:
        raise InputError(f"{path}: no topic of depth pictures; pictures are: {_listed([e.topic for e in pictures])}")
    colours = {each.frame for each in pictures if each.colour}

    def rank(each: _Pictures) -> tuple[bool, bool]:
        return any(word in each.topic for word in _REGISTERED) or each.frame in colours, each.raw

    best = max(map(rank, named))
    chosen = [each for each in named if rank(each) == best]
    if len(chosen) > 1:
        listed = _listed([each.topic for each in chosen])
        raise InputError(f"{path}: several topics of depth pictures: {listed}; choose by --depth-topic")
    return chosen[0]


def _colour(pictures: Sequence[_Pictures], depth: _Pictures, wanted: str | None, path: Path) -> _Pictures | None:
    found = [each for each in pictures if each.colour]
    if wanted is not None:
        return _wanted(found, wanted, "colour pictures", path)

    def rank(each: _Pictures) -> tuple[bool, int, bool, str]:
        words = set(each.topic.lower().split("/"))
        called = any(word in part for word in _COLOURED for part in words)
        return called, _alike(each.topic, depth.topic), each.raw, each.topic

    return max(found, key=rank, default=None)


def _alike(topic: str, other: str) -> int:
    """Return how many parts of two names are the same from their beginning on."""
    pairs = zip(topic.split("/"), other.split("/"), strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], pairs))


def _wanted(found: Sequence[_Pictures], wanted: str, what: str, path: Path) -> _Pictures:
    for each in found:
        if each.topic.strip("/") == wanted.strip("/"):
            return each
    listed = _listed([each.topic for each in found])
    raise InputError(f"{path}: no topic {shown(wanted)} of {what}; it has: {listed}")


def _info(infos: Sequence[str], pictures: str) -> str | None:
    beside = pictures.rpartition("/")[0] + "/camera_info"
    return next((each for each in infos if each.strip("/") == beside.strip("/")), None)


def _pictures(bag: Bag) -> list[_Pictures]:
    """Return the topics of pictures, by what the first message of each says."""
    found = []
    for topic in bag.of_type(IMAGE, COMPRESSED):
        content = next(iter(bag.messages(topic))).content
        words = {part for name in topic.lower().split("/") for part in (name, *name.split("_"))}
        other = any(word in words for word in _OTHERS)
        depth = is_depth(content) and (not other or "depth" in words)
        colour = not is_depth(content) and not other and _is_colour(content)
        found.append(_Pictures(topic, depth, colour, frame_name(content.header.frame_id)))
    return found


def _is_colour(content: Any) -> bool:
    return not hasattr(content, "encoding") or content.encoding in COLOURS


def _listed(topics: Sequence[str]) -> str:
    return ", ".join(topics) or "none"
