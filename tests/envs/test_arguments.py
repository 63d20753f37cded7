"""How settings are named: by their path, or by the end of it where only one ends so."""

from dataclasses import dataclass, field

import pytest
from tagalong.envs.limits.arguments import argument_names, branch, with_arguments
from tagalong.slam import InputError


@dataclass(frozen=True, kw_only=True)
class Lamp:
    watts: float = 5.0
    colour: str = "white"


@dataclass(frozen=True, kw_only=True)
class Wheel:
    radius: float = 0.1
    colour: str = "black"


LAMPS = {"bright": Lamp(watts=50.0), None: None}


@dataclass(frozen=True, kw_only=True)
class Body:
    lamp: Lamp | None = field(default=Lamp(), metadata=branch(choices=LAMPS, title="lamp"))
    wheel: Wheel = field(default=Wheel(), metadata=branch())


@dataclass(frozen=True, kw_only=True)
class Cart:
    body: Body = field(default=Body(), metadata=branch())
    price: Lamp = field(default=Lamp(), metadata=branch(by_path=True))
    name: Wheel = field(default=Wheel(), metadata=branch(chooses="colour", by_path=True))
    driver: Lamp = field(default=Lamp(), metadata=branch(foreign=True))


@pytest.mark.parametrize("name", ["body.lamp.watts", "lamp.watts", "watts"])
def test_a_setting_is_named_by_its_path_or_the_end_of_it(name):
    assert with_arguments(Cart(), {name: 7.0}) == Cart(body=Body(lamp=Lamp(watts=7.0)))


def test_what_ends_alike_needs_more_of_its_path():
    with pytest.raises(InputError, match=r"`colour` may be any of body\.lamp\.colour, body\.wheel\.colour"):
        with_arguments(Cart(), {"colour": "red"})
    assert with_arguments(Cart(), {"wheel.colour": "red"}).body.wheel.colour == "red"


def test_branches_by_path_keep_their_names_to_themselves():
    assert with_arguments(Cart(), {"price.watts": 1.0, "watts": 2.0}).price == Lamp(watts=1.0)
    assert with_arguments(Cart(), {"driver.watts": 1.0}).driver == Lamp(watts=1.0)
    with pytest.raises(InputError, match="unknown Lamp field 'wat'; Lamp fields: colour, watts"):
        with_arguments(Cart(), {"driver.wat": 1.0})


def test_a_text_or_none_chooses_and_a_configuration_is_taken_as_it_is():
    assert with_arguments(Cart(), {"lamp": "bright"}).body.lamp == Lamp(watts=50.0)
    assert with_arguments(Cart(), {"lamp": None}).body.lamp is None
    assert with_arguments(Cart(), {"body": Body(lamp=None)}).body.lamp is None
    assert with_arguments(Cart(), {"name": "red"}).name == Wheel(colour="red")
    with pytest.raises(InputError, match="unknown lamp 'dim'; lamps: None, bright"):
        with_arguments(Cart(), {"lamp": "dim"})


def test_settings_are_applied_in_their_order_and_a_whole_branch_replaces_what_was_set_in_it():
    both = with_arguments(Cart(), {"lamp": "bright", "lamp.colour": "red"})
    assert both.body.lamp == Lamp(watts=50.0, colour="red")
    assert with_arguments(Cart(), {"lamp.colour": "red", "lamp": "bright"}).body.lamp == Lamp(watts=50.0)
    assert with_arguments(Cart(), {"watts": 1.0, "lamp.watts": 2.0}).body.lamp == Lamp(watts=2.0)


def test_a_branch_that_is_off_has_no_fields():
    with pytest.raises(InputError, match=r"`body\.lamp` is None, which has no field 'watts': choose another"):
        with_arguments(Cart(), {"lamp": None, "lamp.watts": 3.0})


def test_unknown_names_are_told_with_what_there_is():
    with pytest.raises(InputError, match="unknown argument 'wats'; like it: watts; branches: body, price"):
        with_arguments(Cart(), {"wats": 3.0})
    with pytest.raises(InputError, match="`price` has no field 'volts'; its fields: colour, watts"):
        with_arguments(Cart(), {"price.volts": 3.0})


def test_every_setting_is_listed_by_its_path():
    assert argument_names(Cart)[:3] == ("body.lamp.watts", "body.lamp.colour", "body.wheel.radius")
    assert argument_names(Cart)[-1] == "driver"
