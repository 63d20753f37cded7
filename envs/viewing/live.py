"""Episodes shown in rerun's viewer while they are driven."""

from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError, MissingExtraError
from ...slam.logs.rerun_recording import RerunRecording
from ...slam.logs.viewer_recording import ViewerRecording
from ..onboard.stack import Belief
from ..world.truth import TrueState
from ..world.world import World
from .moments import Moments


def require_viewer(*, display: bool) -> None:
    """Make sure that a viewer can be opened.

    Args:
        display: Whether a window can be opened.

    Raises:
        InputError: If there is no display.
        MissingExtraError: If `rerun-sdk` is not installed.
    """
    if find_spec("rerun") is None:
        raise MissingExtraError("live views", "rerun")
    if not display:
        raise InputError("a live view needs a display, there is none; record it instead, as FILE.rrd")


def open_viewer(stream: Any) -> None:
    """Let a stream of rerun flow into its viewer, which is started if none is open."""
    stream.spawn()


class LiveRecording(RerunRecording):
    """What `RerunRecording` writes into a file, shown at once."""

    def __init__(self) -> None:
        import rerun  # pyright: ignore[reportMissingImports]

        ViewerRecording.__init__(self, "rerun")
        self._rerun: Any = rerun
        self._stream: Any = rerun.RecordingStream("tagalong")
        open_viewer(self._stream)

    def _finish(self, keep: bool) -> None:
        self._stream.flush()
        self._stream.disconnect()


class LiveRenderer:
    """Shows each moment in rerun's viewer, which is opened with the first one."""

    def __init__(self) -> None:
        self._recording: LiveRecording | None = None
        self._moments: Moments | None = None
        self._last: tuple[World, float] | None = None

    def draw(self, world: World, truth: TrueState, belief: Belief, trail: NDArray[np.float64]) -> None:
        """Show the present state; once, however often it is asked for."""
        if self._moments is None:
            self._recording = LiveRecording()
            self._moments = Moments(self._recording)
        if self._last is None or self._last[0] is not world or self._last[1] != truth.time_s:
            self._last = (world, truth.time_s)
            self._moments.take(world, truth, belief)

    def close(self) -> None:
        """End the stream; the viewer stays open."""
        if self._recording is not None:
            self._recording.close()
        self._recording = self._moments = self._last = None

    def __getstate__(self) -> dict[str, Any]:
        return {"_recording": None, "_moments": None, "_last": None}
