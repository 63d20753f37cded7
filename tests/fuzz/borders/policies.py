"""Followers from outside: policies with their cards, joystick logs."""

import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from borders.logs import hostile
from fuzzer import grammars
from fuzzer.arrays import arrays_of, edits, packed
from fuzzer.border import Border, Input
from fuzzer.files import put, put_all
from fuzzer.mutations import mutated_bytes
from fuzzer.sanity import finite
from fuzzer.values import hostile_value
from numpy.random import Generator
from tagalong.agents import LearnedFollower
from tagalong.agents.learned.follower import SHIPPED
from tagalong.agents.teleop import JoystickReplay, read_joystick_log
from tagalong.envs.task import FollowInterface


def _policy(rng: Generator) -> Input:
    """Return edits of the shipped policy's arrays, of its card, or of both; or a card of any bytes."""
    names, draw = list(arrays_of(SHIPPED / "follower.npz")), rng.random()
    value: Input = {"edits": edits(rng, names) if draw < 0.55 else [], "card": []}
    if draw > 0.45:
        value["card"] = [_card_edit(rng) for _ in range(int(rng.integers(1, 4)))]
    if draw > 0.9:
        card = (SHIPPED / "follower.json").read_bytes()
        value["raw"] = mutated_bytes(rng, card) if draw < 0.97 else b"[" * int(10.0 ** rng.integers(1, 6))
    return value


def _card_edit(rng: Generator) -> Input:
    pilot = json.loads((SHIPPED / "follower.json").read_text())["pilot"]
    parts = [part for part in pilot if isinstance(pilot[part], dict)]
    part = parts[int(rng.integers(len(parts)))]
    if rng.random() < 0.2:
        return [[part], hostile_value(rng)]
    name = list(pilot[part])[int(rng.integers(len(pilot[part])))] if rng.random() < 0.95 else "unheard_of"
    return [[part, name], hostile_value(rng, pilot[part].get(name))]


def policy_files(value: Input) -> dict[str, bytes]:
    """Return the files of a policy with edits made."""
    card = json.loads((SHIPPED / "follower.json").read_text())
    for path, new in value["card"]:
        target = card["pilot"]
        for step in path[:-1]:
            target = target[step] if isinstance(target.get(step), dict) else target
        target[path[-1]] = new.decode() if isinstance(new, bytes) else new
    text = value.get("raw", json.dumps(card, default=str).encode())
    return {"policy.npz": packed(arrays_of(SHIPPED / "follower.npz"), value["edits"]), "policy.json": text}


def _drive_policy(value: Input, folder: Path) -> Any:
    interface = FollowInterface(bearings=np.deg2rad(np.linspace(-135.0, 135.0, 200)))
    follower = LearnedFollower(interface, put_all(folder / "policy", policy_files(value)))
    follower.reset()
    rng = np.random.default_rng(0)
    leader = np.array([1.5, 0.2, 0.5, 0.0, 0.9, 1.0], np.float32)
    shared = {"people": np.zeros((6, 6), np.float32), "velocity": np.zeros(2, np.float32)}
    shared["map"] = np.full((64, 64), 0.5, np.float32)
    scans = rng.uniform(0.05, 1.0, (3, 200)).astype(np.float32)
    return [follower.act({"scan": scan, "leader": leader, **shared}) for scan in scans]


def _sane_actions(actions: Any) -> None:
    finite(actions, "actions", 1.0)


def _replayed(value: Input, folder: Path) -> Any:
    log = read_joystick_log(put(folder, "stick.txt", value))
    replay = JoystickReplay(log, log.env, log.kwargs, log.seed)
    return [replay.act(None) for _ in range(5)] + [np.array([log.active_s, len(log.changes)]) * 0.0]


def warm() -> None:
    """Load what a policy needs."""
    with tempfile.TemporaryDirectory() as folder:
        _drive_policy({"edits": [], "card": []}, Path(folder))


BORDERS = (
    Border(name="models.policy", make=_policy, call=_drive_policy, sane=_sane_actions, file="policy", ms=6.0),
    Border(
        name="models.joystick", make=hostile(grammars.joystick), call=_replayed, sane=_sane_actions,
        file="stick.txt", ms=0.53,
    ),
)  # fmt: skip
