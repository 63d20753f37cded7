"""IR-SIM beside our worlds: measured where it is installed, left out where it is not."""

import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest
import yaml
from tagalong.scripts.benchmarks import ir_sim, worlds


def test_where_it_is_not_installed_it_has_no_row(monkeypatch):
    monkeypatch.setattr(ir_sim, "find_spec", lambda name: None)
    assert ir_sim.ir_sim_speed(0.0) is None


class Room:
    """What IR-SIM's environment is for the measurement."""

    steps = resets = ended = 0

    def step(self, action):
        assert action.shape == (2, 1)
        self.steps += 1

    def done(self):
        return self.steps % 8 == 0

    def reset(self):
        self.resets += 1

    def end(self):
        self.ended += 1


def test_it_steps_its_room_and_is_closed(monkeypatch):
    made, room = [], Room()

    def make(file, **arguments):
        print("no window")
        made.append(yaml.safe_load(Path(file).read_text(encoding="utf-8")))
        assert arguments["display"] is False
        return room

    module = ModuleType("irsim")
    module.make = make
    monkeypatch.setitem(sys.modules, "irsim", module)
    monkeypatch.setattr(ir_sim, "find_spec", lambda name: object())
    speed = ir_sim.ir_sim_speed(0.0)
    assert speed["per_clock"] > 0.0
    assert speed["per_core"] > 0.0
    assert (room.steps, room.resets, room.ended) == (40, 5, 1)
    (world,) = made
    assert world["obstacle"][0]["number"] == ir_sim.WALKERS
    assert world["robot"]["sensors"][0]["number"] == ir_sim.BEAMS


@pytest.mark.parametrize("installed", [True, False])
def test_its_row_stands_last_where_there_is_one(monkeypatch, installed):
    monkeypatch.setattr(worlds, "CASES", {"office, 5 bystanders, 360 beams": {}})
    monkeypatch.setattr(worlds, "world_speeds", lambda *given, **fields: [{"per_core": 2.0, "per_clock": 2.0}] * 2)
    monkeypatch.setattr(worlds, "single_speed", lambda *given, **fields: 1.0)
    other = {"per_core": 3.0, "per_clock": 3.0} if installed else None
    monkeypatch.setattr(worlds, "ir_sim_speed", lambda seconds: other)
    rows = worlds.processor_rows(SimpleNamespace(worlds=4, seconds=1))
    assert (list(rows)[-1] == ir_sim.NAME) == installed
