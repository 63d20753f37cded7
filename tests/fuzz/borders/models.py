"""Models that are loaded: leg forests, the classifier of people, policies with their cards, joystick logs."""

import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from borders.logs import hostile
from fuzzer import grammars
from fuzzer.arrays import edits, packed
from fuzzer.border import Area, Border, Input, require
from fuzzer.files import put, put_all
from fuzzer.mutations import mutated_bytes
from fuzzer.sanity import finite
from fuzzer.values import hostile_value
from numpy.random import Generator
from tagalong.agents import LearnedFollower
from tagalong.agents.learned.follower import SHIPPED
from tagalong.agents.teleop.joystick import JoystickReplay, read_joystick_log
from tagalong.envs.task.interface import FollowInterface
from tagalong.perception import LegForest
from tagalong.perception.legs.features import FEATURE_NAMES
from tagalong.perception.legs.forest import MODELS
from tagalong.perception.rgbd.person_svm import LENGTH, PersonSvm

FILE = "model.npz"
_CACHE: dict[str, dict[str, np.ndarray]] = {}


def _arrays(path: Path) -> dict[str, np.ndarray]:
    if str(path) not in _CACHE:
        with np.load(path, allow_pickle=False) as content:
            _CACHE[str(path)] = {name: content[name] for name in content.files}
    return _CACHE[str(path)]


def _small_forest() -> dict[str, np.ndarray]:
    """Return two trees of a question and two leaves each."""
    return {
        "feature": np.array([0, -1, -1] * 2, np.int8), "value": np.array([0.5, 0.2, 0.8] * 2, np.float32),
        "right": np.array([2, 0, 0, 5, 0, 0], np.int32), "roots": np.array([0, 3], np.int32),
        "odds": np.array(1.5), "feature_names": np.array(FEATURE_NAMES),
    }  # fmt: skip


def _forest(value: Input, folder: Path) -> Any:
    forest = LegForest.load(put(folder, FILE, packed(_small_forest(), value)))
    votes = forest.vote(np.random.default_rng(0).normal(size=(50, len(FEATURE_NAMES))).astype(np.float32))
    return forest.odds, votes


def _sane_forest(result: Any) -> None:
    odds, votes = result
    require(0.0 < odds <= 1e9, f"odds {odds}")
    finite(votes, "votes", 1.0)


def _svm(value: Input, folder: Path) -> Any:
    svm = PersonSvm.load(put(folder, FILE, packed(_arrays(MODELS / "people_rgbd.npz"), value)))
    return svm.likelihood(np.ones((3, LENGTH), np.float32))


def _policy(rng: Generator) -> Input:
    """Return edits of the shipped policy's arrays, of its card, or of both; or a card of any bytes."""
    names, draw = list(_arrays(SHIPPED / "follower.npz")), rng.random()
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
    return {"policy.npz": packed(_arrays(SHIPPED / "follower.npz"), value["edits"]), "policy.json": text}


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


def _warm() -> None:
    with tempfile.TemporaryDirectory() as folder:
        _drive_policy({"edits": [], "card": []}, Path(folder))


AREA = Area(
    (
        Border(
            name="models.forest", make=lambda rng: edits(rng, list(_small_forest())), call=_forest, sane=_sane_forest,
            file=FILE, ms=1.7,
        ),
        Border(
            name="models.person_svm", make=lambda rng: edits(rng, ["weights", "calibration"]), call=_svm, file=FILE,
            sane=lambda likelihood: finite(likelihood, "likelihood", 1.0), ms=1.2,
        ),
        Border(name="models.policy", make=_policy, call=_drive_policy, sane=_sane_actions, file="policy", ms=6.0),
        Border(
            name="models.joystick", make=hostile(grammars.joystick), call=_replayed, sane=_sane_actions,
            file="stick.txt", ms=0.53,
        ),
    ),
    _warm,
)  # fmt: skip
