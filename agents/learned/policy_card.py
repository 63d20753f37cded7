"""What surrounds a network, as its card says it: each field of the JSON is looked at before anything is made of it."""

from dataclasses import MISSING, Field, fields
from typing import Any, TypeVar

from ...slam.errors import shown
from .detour import DetourConfig
from .features import FeatureConfig
from .guard import GuardConfig
from .keep_up import KeepUpConfig
from .pilot import PilotConfig
from .steering import SteeringConfig
from .swerve import SwerveConfig

Part = TypeVar("Part", FeatureConfig, SteeringConfig, GuardConfig, KeepUpConfig, DetourConfig, SwerveConfig)

LARGEST = 1000
"""Of a number in a card: no length [m], time [s], speed, count or cost around a robot of half a metre comes near it."""
LONGEST = 32
"""Of a list in a card: twice as many as of turn rates that are tried."""


def pilot_config(card: Any) -> PilotConfig:
    """Return the configuration that `dataclasses.asdict` made `card` of.

    Raises:
        ValueError: Naming the field that is missing, or is not what the program has there.
    """
    content = _mapping("pilot", card)
    for name in ("features", "steering", "guard"):
        if name not in content:
            raise ValueError(f"`{name}` is missing in `pilot`")
    return PilotConfig(
        features=_made(FeatureConfig, "features", content["features"]),
        steering=_made(SteeringConfig, "steering", content["steering"]),
        guard=_part(GuardConfig, "guard", content),
        keep_up=_part(KeepUpConfig, "keep_up", content),
        detour=_part(DetourConfig, "detour", content),
        swerve=_part(SwerveConfig, "swerve", content),
    )


def _part(kind: type[Part], name: str, content: dict[str, Any]) -> Part | None:
    return None if content.get(name) is None else _made(kind, name, content[name])


def _made(kind: type[Part], where: str, value: Any) -> Part:
    content, known = _mapping(where, value), {field.name: field for field in fields(kind)}
    for name in content:
        if name not in known:
            raise ValueError(f"`{where}` has no field {shown(name)}")
    return kind(**{name: _value(f"{where}.{name}", known[name], value) for name, value in content.items()})


def _value(where: str, field: Field[Any], value: Any) -> Any:
    """Return a field's value, of the kind of its default."""
    default = field.default
    assert default is not MISSING, "the configurations of a card have a default for each field"
    if isinstance(default, tuple):
        if not isinstance(value, (list, tuple)) or not 1 <= len(value) <= LONGEST:
            raise ValueError(f"`{where}` must be a list of 1 to {LONGEST} numbers, got {shown(value)}")
        return tuple(float(_number(where, one)) for one in value)
    if isinstance(default, bool):
        if not isinstance(value, bool):
            raise ValueError(f"`{where}` must be true or false, got {shown(value)}")
        return value
    number = _number(where, value)
    if isinstance(default, int) and not isinstance(number, int):
        raise ValueError(f"`{where}` must be a whole number, got {shown(value)}")
    return number


def _number(where: str, value: Any) -> Any:
    good = isinstance(value, (int, float)) and not isinstance(value, bool) and -LARGEST <= value <= LARGEST
    if not good:
        raise ValueError(f"`{where}` must be a number within +-{LARGEST}, got {shown(value)}")
    return value


def _mapping(where: str, value: Any) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise ValueError(f"`{where}` must hold fields with values, got {shown(value)}")
    return value
