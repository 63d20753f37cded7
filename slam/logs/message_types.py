"""The types of ROS messages, as ROS itself defines them: bytes to fields and back, definitions for new topics."""

from functools import lru_cache
from typing import Any

from ..errors import MissingExtraError

_TRANSFORMS = "geometry_msgs/TransformStamped[] transforms"  # of both types of tf, which the library's ROS 1 lacks


class MessageTypes:
    """Types of ROS 1 or ROS 2.

    Args:
        ros1: Which of the two.

    Raises:
        MissingExtraError: If `rosbags` is not installed.
    """

    def __init__(self, *, ros1: bool) -> None:
        self.ros1, self._store = ros1, _typestore(ros1)

    def read(self, raw: bytes | memoryview, kind: str) -> Any:
        """Return the fields of a message of type `kind`, e.g. "sensor_msgs/msg/LaserScan"."""
        return self._store.deserialize_ros1(raw, kind) if self.ros1 else self._store.deserialize_cdr(raw, kind)

    def write(self, message: Any, kind: str) -> bytes:
        """Return the bytes of a message of type `kind`."""
        raw = self._store.serialize_ros1(message, kind) if self.ros1 else self._store.serialize_cdr(message, kind)
        return bytes(raw)

    def make(self, kind: str, **fields: Any) -> Any:
        """Return a message of type `kind` with these `fields`; all of them must be given."""
        return self._store.types[kind](**fields)

    def definition(self, kind: str) -> tuple[str, str]:
        """Return how `kind` is defined, as bags tell it, and the digest that names this definition."""
        text, md5 = self._store.generate_msgdef(kind, ros_version=1 if self.ros1 else 2)
        return text, md5 if self.ros1 else self._store.hash_rihs01(kind)

    def digest(self, kind: str) -> str:
        """Return the digest by which a ROS 1 bag names the definition of `kind`."""
        return self._store.generate_msgdef(kind)[1]


@lru_cache(maxsize=2)
def _typestore(ros1: bool) -> Any:
    try:
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore
    except ImportError:
        raise MissingExtraError("ROS bags", "ros") from None
    store: Any = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    if ros1:
        for name in ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage"):
            store.register(get_types_from_msg(_TRANSFORMS, name))
    return store
