"""Fields of a configuration by name."""

from dataclasses import dataclass, field

import pytest
from tagalong.slam.engine import make_slam
from tagalong.slam.errors import InputError
from tagalong.slam.settings import with_settings


@dataclass(frozen=True)
class Inner:
    steps: int = 3
    name: str = "cubic"
    limit: float | None = None


@dataclass(frozen=True)
class Outer:
    inner: Inner | None = field(default_factory=Inner)
    size: float = 1.5
    windows: tuple[int, ...] = (4, 3)
    reach: tuple[float, float] = (0.3, 0.2)
    always: Inner = field(default_factory=Inner)


def test_fields_and_those_of_parts_are_changed_and_the_rest_stays():
    assert with_settings(Outer(), {}) == Outer()
    assert with_settings(Outer(), {"size": 2, "inner.steps": 5}) == Outer(Inner(steps=5), 2)
    assert with_settings(Outer(Inner(name="linear")), {"inner.steps": 5}).inner == Inner(5, "linear")
    assert with_settings(Outer(), {"inner": None}).inner is None
    assert with_settings(Outer(Inner(limit=0.5)), {"inner.limit": None}).inner == Inner()
    assert with_settings(Outer(), {"windows": [5], "reach": (1, 2)}) == Outer(windows=(5,), reach=(1, 2))
    assert with_settings(Outer(), {"inner": Inner(7), "inner.limit": 0.5}).inner == Inner(7, limit=0.5)


@pytest.mark.parametrize(
    ("settings", "complaint"),
    [
        ({"siz": 1}, "unknown Outer field 'siz'; Outer fields: always, inner, reach, size, windows"),
        ({"inner.step": 1}, "unknown Inner field 'step'"),
        ({"size": "2"}, "`size` must be a number, got '2'"),
        ({"size": None}, "`size` must be a number, got None"),
        ({"inner.steps": 2.5}, "`steps` must be a whole number, got 2.5"),
        ({"windows": 4}, "`windows` must be a list of some numbers, got 4"),
        ({"windows": (4, 2.5)}, "`windows` must be a whole number, got 2.5"),
        ({"reach": (1.0,)}, "`reach` must be a list of 2 numbers, got (1.0,)"),
        ({"reach": (1.0, "b")}, "`reach` must be a number, got 'b'"),
        ({"always": None}, "`always` is no single value; its fields are always.steps"),
        ({"inner.name": 3}, "`name` must be a text, got 3"),
        ({"inner": 3}, "`inner` is no single value; its fields are inner.steps, inner.name, inner.limit"),
        ({"size.x": 3}, "`size` of Outer has no fields"),
        ({"inner": None, "inner.steps": 3}, "`inner` of Outer has no fields"),
    ],
)
def test_what_does_not_fit_is_named(settings, complaint):
    with pytest.raises(InputError) as error:
        with_settings(Outer(), settings)
    assert complaint in str(error.value)


def test_engines_take_settings_of_their_parts():
    engine = make_slam("cartographer", **{"local.insertion_voxel": 0.1, "global_": None})
    assert engine.config.local.insertion_voxel == 0.1
    assert engine.config.global_ is None
    ekf = make_slam("ekf", gate=4.0, widest=0.4)
    assert (ekf.config.gate, ekf.config.sighting.widest) == (4.0, 0.4)
