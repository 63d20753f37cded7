"""No option of any command takes a number without bounds."""

import argparse

import pytest
from fuzzer.declared import declared_options, takes_numbers
from tagalong.scripts.console.arguments import at_least, random_seed, within

NUMBERS = {
    " ".join((*command, action.option_strings[0])): action
    for command, action in declared_options()
    if takes_numbers(action.type)
}


def test_the_options_of_all_commands_are_found():
    assert {"slam --seed", "train follower --steps", "bench people --seconds", "perceive --rate"} <= set(NUMBERS)


@pytest.mark.parametrize("name", NUMBERS)
def test_no_number_is_taken_that_is_none_or_beyond_all_use(name):
    for word in ("nan", "inf", "-inf", "1e308", "-1e308", "9" * 5000, "-" + "9" * 400, "one", ""):
        with pytest.raises(argparse.ArgumentTypeError, match=r"must be .{0,200}$"):
            NUMBERS[name].type(word)


@pytest.mark.parametrize("name", [name for name, action in NUMBERS.items() if isinstance(action.default, int | float)])
def test_a_default_is_one_of_the_numbers_that_are_taken(name):
    assert NUMBERS[name].type(str(NUMBERS[name].default)) == NUMBERS[name].default


def test_bounds_are_inclusive_and_told():
    assert (within(-1.0, 2.5)("2.5"), within(-1.0, 2.5)("-1"), at_least(2, 4)("4")) == (2.5, -1.0, 4)
    with pytest.raises(argparse.ArgumentTypeError, match=r"must be a number within -1 .. 2.5, got '2.6'"):
        within(-1.0, 2.5)("2.6")
    with pytest.raises(argparse.ArgumentTypeError, match="must be at most 4294967295"):
        random_seed("4294967296")
