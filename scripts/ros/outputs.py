"""What the logic of a node takes and returns: messages by the name of what they are, whoever sends them."""

from typing import Any, NamedTuple, Protocol

from ...slam.logs.ros_messages import RosMessages

SCAN, ODOMETRY, FRAMES = "scan", "odom", "/tf_static"
"""What nodes listen to; a LaserScan, an Odometry, a TFMessage of frames that do not move."""


class Maker(Protocol):
    """Makes messages: `RosMessages` for bags, `RclpyMessages` on a robot."""

    def make(self, kind: str, **content: Any) -> Any:
        """Return a message of a type, such as "std_msgs/msg/Float64", all fields given."""
        ...


class Output(NamedTuple):
    """A message to be sent.

    Attributes:
        topic: Where.
        message: What.
    """

    topic: str
    message: Any


class Logic(Protocol):
    """What a node does.

    Attributes:
        outputs: Topic -> type of what it sends.
    """

    outputs: dict[str, str]

    def take(self, source: str, message: Any, now_s: float) -> list[Output]:
        """Take a message of `SCAN`, `ODOMETRY` or `FRAMES` at `now_s` [s]; return what is to be sent.

        Raises:
            InputError: If it is not what its type says; the next one may be taken all the same.
        """
        ...

    def tick(self, now_s: float) -> list[Output]:
        """Look at the clock, ten times a second; return what is to be sent."""
        ...

    def notes(self) -> list[str]:
        """Return what the user is to be told since the last call, a sentence each."""
        ...


class MadeMessages(RosMessages):
    """The messages of `RosMessages`, made by somebody else.

    Args:
        maker: By whom.
    """

    def __init__(self, maker: Maker) -> None:
        self._maker = maker

    def make(self, kind: str, **content: Any) -> Any:
        """Return a message of a type, such as "std_msgs/Float64"."""
        package, _, name = kind.partition("/")
        return self._maker.make(f"{package}/msg/{name.removeprefix('msg/')}", **content)
