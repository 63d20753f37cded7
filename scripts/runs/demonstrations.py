"""Followers' episodes made into datasets: driven episode by episode, resumable, then written in each format."""

import re
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import gymnasium as gym

from ...agents import make_follower
from ...envs.recording.demonstration import Demonstration, demonstrate
from ...envs.recording.lerobot_dataset import check_lerobot, write_lerobot
from ...envs.recording.minari_dataset import check_minari, require_kept, write_minari
from ...envs.suites import Scenario
from ...slam.errors import InputError
from ..lab.cells import Cell, files_of, run_cells

NAMESPACE = "tagalong"
"""Of the Minari datasets."""
CHECKS: dict[str, Callable[[], object]] = {"minari": check_minari, "lerobot": check_lerobot}
"""Format -> complains if what it needs is not installed."""
_FILE = "demonstration.npz"


@dataclass(frozen=True, kw_only=True)
class Asked:
    """What is to be recorded.

    Attributes:
        followers: Who drives.
        place: Name of the suite or scene, in the names of the datasets.
        scenarios: Episode k is of scenario k modulo their number.
        episodes: How many of each follower.
        seed: Of the first; episode k has seed + k.
        arguments: Further arguments of each environment.
        formats: Of `CHECKS`.
    """

    followers: Sequence[str]
    place: str
    scenarios: Sequence[Scenario]
    episodes: int
    seed: int
    arguments: Mapping[str, Any]
    formats: Sequence[str]


@dataclass(kw_only=True)
class Dataset:
    """One dataset: a follower in an environment. Only options of `reset` differ between its episodes.

    Attributes:
        name: What stands for both in the names of folders: PLACE/FOLLOWER.
        follower: Who drives.
        env: Id of the environment.
        arguments: Its arguments.
        cells: An episode each.
    """

    name: str
    follower: str
    env: str
    arguments: Mapping[str, Any]
    cells: list[Cell] = field(default_factory=list)


def datasets_asked(asked: Asked) -> list[Dataset]:
    """Return what datasets there will be; a suite of several environments has one of each.

    Raises:
        InputError: If a follower or an argument is unknown, an environment cannot be kept as text, or two followers
            would have one name.
    """
    names = [plain_name(who) for who in asked.followers]
    if len(set(names)) < len(names):
        raise InputError(f"--followers must differ in letters and numbers, got {', '.join(asked.followers)}")
    found: dict[tuple[str, str, str], Dataset] = {}
    places = _place_names(asked)
    for k in range(asked.episodes):
        scenario = asked.scenarios[k % len(asked.scenarios)]
        arguments = {**scenario.arguments, **asked.arguments}
        place = places[_place(scenario, asked)]
        for who, name in zip(asked.followers, names, strict=True):
            key = (*_place(scenario, asked), who)
            dataset = found.setdefault(
                key, Dataset(name=f"{place}/{name}", follower=who, env=scenario.env, arguments=arguments)
            )
            one = {"follower": who, "env": scenario.env, "arguments": arguments}
            one |= {"seed": asked.seed + k, "options": scenario.options}
            cell = Cell(name=f"{dataset.name}/{one['seed']}", function=drive, arguments=one, keeps_files=True)
            dataset.cells.append(cell)
    for dataset in found.values():
        env = _environment(dataset)
        require_kept(env)
        make_follower(dataset.follower, env.get_wrapper_attr("interface"))
        env.close()
    return list(found.values())


def _place_names(asked: Asked) -> dict[tuple[str, str], str]:
    """Return what each environment is called: after its only scenario, else after its building; all of them differ."""
    groups: dict[tuple[str, str], list[Scenario]] = {}
    for scenario in asked.scenarios:
        groups.setdefault(_place(scenario, asked), []).append(scenario)
    if len(groups) == 1:
        return dict.fromkeys(groups, asked.place)
    names: dict[tuple[str, str], str] = {}
    for place, members in groups.items():
        building = members[0].arguments.get("scene", members[0].env.partition("/")[2])
        name = f"{asked.place}-{plain_name(members[0].name if len(members) == 1 else building)}"
        taken = sum(other == name or other.startswith(f"{name}-no") for other in names.values())
        names[place] = f"{name}-no{taken + 1}" if taken else name
    return names


def plain_name(words: str) -> str:
    """Return letters, numbers, `_` and `-` alone, as Minari's names have them."""
    return re.sub(r"[^A-Za-z0-9_]+", "-", words).strip("-")


def _place(scenario: Scenario, asked: Asked) -> tuple[str, str]:
    return scenario.env, repr(sorted({**scenario.arguments, **asked.arguments}.items()))


def _environment(dataset: Dataset) -> "gym.Env[Any, Any]":
    return gym.make(dataset.env, **dataset.arguments)


def drive(
    follower: str, env: str, arguments: Mapping[str, Any], seed: int, options: dict[str, Any], files: Path
) -> dict[str, Any]:
    """Drive one episode, keep it in `files`, and return its row: a cell of the experiment."""
    made = gym.make(env, **arguments)
    one = demonstrate(made, make_follower(follower, made.get_wrapper_attr("interface")), seed=seed, options=options)
    made.close()
    one.save(files / _FILE)
    return {"steps": len(one), "ending": one.ending, "total_reward": float(one.rewards.sum())}


def record(asked: Asked, datasets: Sequence[Dataset], out: Path, jobs: int) -> list[dict[str, Any]]:
    """Drive what has not been driven, write the datasets anew, and return a row for each episode."""
    cells = [cell for dataset in datasets for cell in dataset.cells]
    episodes = out / "episodes"
    results = run_cells(cells, episodes, jobs=jobs, label="episodes")
    for dataset in datasets:
        _write(asked.formats, dataset, episodes, out)
    return [
        {"dataset": dataset.name, "follower": dataset.follower, "seed": cell.arguments["seed"], **results[cell.name]}
        for dataset in datasets
        for cell in dataset.cells
    ]


def _write(formats: Sequence[str], dataset: Dataset, episodes: Path, out: Path) -> None:
    env = _environment(dataset)

    def driven() -> Iterator[Demonstration]:
        return (Demonstration.load(files_of(cell.name, episodes) / _FILE) for cell in dataset.cells)

    if "minari" in formats:
        name = f"{NAMESPACE}/{dataset.name}-v0"
        _put_away(out / "minari" / name)
        write_minari(out / "minari", name, env, driven(), dataset.follower)
    if "lerobot" in formats:
        target = out / "lerobot" / dataset.name
        _put_away(target)
        write_lerobot(target, env, driven(), dataset.follower)
    env.close()


def _put_away(folder: Path) -> None:
    """Remove a dataset so that it is whole or not there at every moment."""
    if folder.exists():
        away = folder.with_name(f".{folder.name}-old")
        shutil.rmtree(away, ignore_errors=True)
        folder.replace(away)
        shutil.rmtree(away)
