"""What became of one input: accepted, refused in the promised way, or a finding."""

import traceback
from dataclasses import dataclass
from pathlib import Path

from fuzzer.border import Border, Input, InsaneError
from tagalong.slam import InputError
from tagalong.slam.errors import MissingExtraError

LONGEST_MESSAGE = 600
"""Characters of an error: what fits on a screen; more is an echo of the input."""
ACCEPTED, REFUSED = "accepted", "refused"


@dataclass(frozen=True)
class Verdict:
    """What became of an input.

    Attributes:
        kind: ACCEPTED, REFUSED, or the kind of finding.
        told: The error, or the last lines of the traceback.
    """

    kind: str
    told: str = ""

    @property
    def is_finding(self) -> bool:
        """Whether it should not have come to this."""
        return self.kind not in (ACCEPTED, REFUSED)


def judge(border: Border, value: Input, folder: Path) -> Verdict:
    """Send an input through its door and say what became of it; crashes and hangs are for others to notice."""
    try:
        result = border.call(value, folder)
    except (InputError, MissingExtraError) as error:
        return refused(str(error), border.file, error)
    except InsaneError as error:
        return Verdict("nonsense accepted", str(error))
    except border.refusals as error:
        return Verdict(REFUSED, str(error))
    except (KeyboardInterrupt, GeneratorExit):
        raise
    except BaseException as error:
        return Verdict("memory" if isinstance(error, MemoryError) else "traceback", last_lines(error))
    try:
        border.sane(result)
    except InsaneError as error:
        return Verdict("nonsense accepted", str(error))
    except Exception as error:
        return Verdict("traceback", f"while the result was looked at: {last_lines(error)}")
    return Verdict(ACCEPTED)


def refused(message: str, file: str = "", error: BaseException | None = None) -> Verdict:
    """Return the verdict on a refusal: one printable line that is no echo, names the file, and took no memory."""
    if error is not None and _ran_out_of_memory(error):
        return Verdict("memory", f"refused only when memory ran out: {last_lines(error)}")
    if len(message) > LONGEST_MESSAGE:
        return Verdict("long message", f"{len(message)} characters: {message[:300]}...")
    if not message.isprintable():
        return Verdict("message of several lines or with control characters", repr(message))
    if file not in message:
        return Verdict("message without the file's name", message)
    if not message.strip():
        return Verdict("empty message", repr(message))
    return Verdict(REFUSED, message)


def _ran_out_of_memory(error: BaseException | None) -> bool:
    while error is not None:
        if isinstance(error, MemoryError):
            return True
        error = error.__cause__ or error.__context__
    return False


def last_lines(error: BaseException, count: int = 4) -> str:
    """Return where an error came from and what it says: the last calls inside the package."""
    frames = traceback.extract_tb(error.__traceback__)[-count:]
    places = " > ".join(f"{Path(frame.filename).name}:{frame.lineno} {frame.name}" for frame in frames)
    return f"{type(error).__name__}: {str(error)[:300]} [{places}]"
