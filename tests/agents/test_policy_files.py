"""Policies from outside: every field and array is looked at when they are loaded, and told in one line."""

import io
import json

import numpy as np
import pytest
from tagalong.agents import make_follower
from tagalong.agents.learned.features import FeatureConfig
from tagalong.agents.learned.follower import SHIPPED, LearnedFollower, load_policy
from tagalong.agents.learned.network_shapes import check_arrays
from tagalong.slam import InputError

CARD = json.loads((SHIPPED / "follower.json").read_text())
ARRAYS = dict(np.load(SHIPPED / "follower.npz"))


def written(folder, *, arrays=None, card=None):
    """Write a policy."""
    weights = io.BytesIO()
    np.savez(weights, **(ARRAYS if arrays is None else arrays))
    (folder / "policy.npz").write_bytes(weights.getvalue())
    (folder / "policy.json").write_text(json.dumps(CARD) if card is None else card)
    return folder


def told(folder):
    """The line that tells why a policy is refused."""
    with pytest.raises(InputError) as refused:
        make_follower(str(folder))
    line = str(refused.value).replace(str(folder), "DIR")
    assert "\n" not in line
    assert len(line) < 400
    return line


def test_a_policy_that_is_whole_is_taken(tmp_path):
    assert load_policy(written(tmp_path))[1] == load_policy("follower")[1]


PILOTS = [
    ({"guard": [1]}, "`guard` must hold fields"),
    ({"guard": "x" * 9000}, "`guard` must hold fields"),
    ({"features": None}, "`features` must hold fields"),
    ({"guard": {"margin": "wide"}}, "`guard.margin` must be a number"),
    ({"guard": {"margin": True}}, "`guard.margin` must be a number"),
    ({"guard": {"brake_steps": 2.5}}, "`guard.brake_steps` must be a whole number"),
    ({"guard": {"brake_steps": 10**9}}, "`guard.brake_steps` must be a number within"),
    ({"guard": {"brake_steps": 900}}, "1 to 100 steps of braking"),
    ({"guard": {"remembered_s": 900.0}}, "remembers for 0 to 10 s"),
    ({"guard": {"half_length": 0.3}}, "`guard` has no field 'half_length'"),
    ({"guard": {"speed": 1.0}}, "`guard` has no field 'speed'"),
    ({"features": {"people": 10**9}}, "`features.people` must be a number within"),
    ({"features": {"scan_decay": 0}}, "`scan_decay`"),
    ({"features": {"sectors": 45}}, "array scan.mean must have the shape"),
    ({"features": {"map_cells": 32}}, "array dense.0.weight must have"),
    ({"steering": {"jerk": 1e300}}, "`steering.jerk` must be a number within"),
    ({"detour": {"search": 1}}, "`detour.search` must be true or false"),
    ({"detour": {"turns": []}}, "`detour.turns` must be a list of 1 to 32"),
    ({"detour": {"turns": ["a"]}}, "`detour.turns` must be a number"),
    ({"detour": {"turns": [0.1] * 32}}, "at most 3000 manoeuvres"),
    ({"detour": {"horizon_s": 900.0}}, "at most 3000 manoeuvres of 5 s"),
    ({"swerve": {"ahead_s": 900.0}}, "at most 5 s"),
    ({"keep_up": 3}, "`keep_up` must hold fields"),
]


@pytest.mark.parametrize(("change", "said"), PILOTS, ids=range(len(PILOTS)))
def test_a_card_with_a_wrong_field_is_told(tmp_path, change, said):
    card = {**CARD, "pilot": {**CARD["pilot"], **change}}
    assert said in told(written(tmp_path, card=json.dumps(card)))


CARDS = [
    "",
    "[]",
    "3",
    '{"pilot": []}',
    "[" * 100_000,
    '{"pilot": ' * 50_000,
    '{"pilot": {"guard": ' + "9" * 5000 + "}}",
]


@pytest.mark.parametrize("card", CARDS, ids=range(len(CARDS)))
def test_a_card_that_is_none_is_told(tmp_path, card):
    assert told(written(tmp_path, card=card))


WRONG = {
    "scan.mean": (np.zeros(90, np.float32), "must have the shape (2, 90)"),
    "scan.deviation": (np.zeros((2, 90), np.float32), "must lie within 0 and 10000"),
    "scan.0.weight": (np.zeros((16, 3, 5), np.float32), "the second of 2"),
    "scan.0.bias": (np.zeros(1, np.float32), "must have the shape (16,)"),
    "scan.1.weight": (np.zeros((24, 16, 99), np.float32), "is wider than its input"),
    "scan.7.weight": (np.zeros(1, np.float32), "has no place"),
    "dense.0.weight": (np.zeros((128, 5), np.float32), "the second of"),
    "head.0.weight": (np.zeros((0, 128), np.float32), "must have 2 dimensions"),
    "output.weight": (np.zeros((3, 128), np.float32), "must have the shape (2, 128)"),
    "output.bias": (np.full(2, 1e30, np.float32), "must lie within +- 10000"),
    "squash": (np.array("yes"), "not finite numbers"),
    "lstm.hidden.bias": (np.zeros(6, np.float32), "must have the shape (4 h,)"),
    "lstm.input.bias": (np.zeros(8, np.float32), "array lstm.hidden.bias is missing"),
    "x" * 5000: (np.zeros(1), "has no place in the network"),
}


@pytest.mark.parametrize("name", sorted(WRONG), ids=lambda name: name[:20])
def test_an_array_of_a_wrong_shape_is_told_when_the_policy_is_loaded(tmp_path, name):
    array, said = WRONG[name]
    line = told(written(tmp_path, arrays={**ARRAYS, name: array}))
    assert said in line
    assert name[:40] in line or "is missing" in line


def test_arrays_that_take_too_much_memory_are_refused():
    shapes = FeatureConfig().shapes
    wide = {**ARRAYS, "head.0.weight": np.zeros((140_000, 128), np.float32), "head.0.bias": np.zeros(140_000)}
    wide["output.weight"] = np.zeros((2, 140_000), np.float32)
    with pytest.raises(ValueError, match="its arrays may take"):
        check_arrays(wide, shapes)


@pytest.mark.parametrize("name", ["x" * 5000, "a\0b", "", "x" * 5000 + ":Bold", "a\0b:c"])
def test_a_name_that_no_file_can_have_is_told_in_one_short_line(name):
    for make in (make_follower, lambda name: LearnedFollower(policy=name)):
        with pytest.raises(InputError) as refused:
            make(name)
        assert len(str(refused.value)) < 800
        assert "\n" not in str(refused.value)
