"""Ships a trained follower: its files and a card, made of its training run and of a comparison on the suites.

`python -m tagalong.scripts.training.ship_follower --run out/follower --comparison out/bench/follower-comparison`

Without `--run`, the policy that is shipped already gets a new card: what surrounds the network as this program has it
now, and the figures of the comparison.
"""

import argparse
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from ...agents.learned.features import FeatureConfig
from ...agents.learned.follower import SHIPPED
from ...agents.learned.pilot import PilotConfig
from ...slam.errors import InputError
from ...slam.files.output import made_folder, read_json, write_json
from ..console.last_words import told

NAME = "follower"
GOAL = 0.97
"""Share of tours done that is aimed at."""
DATA = (
    "simulated drives only: the training half of tagalong/Office-v0 with 0 to 12 bystanders, floor_plan, meeting_room "
    "and corridor; seeds below 900000; leaders who walk steadily or wait; leg tracker inside; 360 or 1081 beams"
)
LIMITS = (
    "Trained by imitation alone, before what surrounds the network was settled (on the training half); never "
    "reinforced.",
    "The evaluation above is that of the training run, driven with what surrounded the network then.",
    "Who falls behind is urged on by a rule, not by the network (`keep_up`), and steered round what it would touch by "
    "a search among manoeuvres (`swerve`, `detour`).",
    "Trained in simulation alone; no real robot has driven it.",
    "It is told who leads by the tracker: when the tracker takes somebody else for the leader, it follows that person.",
    "For a robot of a Dingo's size (0.55 x 0.52 m) at up to 1.3 m/s with a laser of 270 degrees, 10 steps a second.",
    "It is not told the map, and the laser sees nothing in the 90 degrees behind: a leader who is lost is looked for "
    "where the tracker takes it to be, and not farther.",
)


def make_card(card: Mapping[str, Any], comparison: Path | None) -> dict[str, Any]:
    """Return the card of a policy: that of its training, data, command, limits, and the figures on the suites.

    Args:
        card: Of the training run, or the one that is shipped.
        comparison: Folder of `tagalong bench follower-comparison`, "learned" first, then "pid".
    """
    measured = {} if comparison is None else read_json(comparison / "results.json")
    suites = measured.get("suites", {})
    command = f"tagalong train follower --algo {card['algorithm']} --preset {card['preset']} --seed {card['seed']}"
    mapped = {name: part["figures"]["learned"]["adnn_truth_to_map_m"]["n"] for name, part in suites.items()}
    how = f" (--maps: {', '.join(f'{name} {n}' for name, n in mapped.items())})"
    return {
        **{name: field for name, field in card.items() if name != "maps"},
        "command": command,
        "data": DATA,
        "limits": [*measured_limits(suites), *LIMITS],
        "suites": suites,
        "suites_command": "tagalong bench follower-comparison --followers learned pid "
        f"--plot --episodes {max((part['episodes'] for part in suites.values()), default=37)}{how}",
    }


def measured_limits(suites: Mapping[str, Any]) -> list[str]:
    """Return in words what the figures of `learned` and `pid` on the `suites` show it does not do; [] without any."""
    if not suites:
        return []
    done = {who: [_ended(part, who, "tour_done") for part in suites.values()] for who in ("learned", "pid")}
    counts = [part["episodes"] for part in suites.values()]
    reached = [name for name, n, k in zip(suites, counts, done["learned"], strict=True) if k >= GOAL * n]
    each = "; ".join(
        f"{name} {k} of {n} (PID {other})"
        for name, n, k, other in zip(suites, counts, done["learned"], done["pid"], strict=True)
    )
    lost = sum(_ended(part, "learned", "leader_lost") for part in suites.values())
    touched = {who: sum(_contacts(part, who) for part in suites.values()) for who in done}
    jerk, pid_jerk = (_mean(suites, who, "jerk_rms_mps3") for who in ("learned", "pid"))
    off, pid_off = (_mean(suites, who, "distance_error_rms_m") for who in ("learned", "pid"))
    return [
        f"Tours done: {sum(done['learned'])} of {sum(counts)}, PID {sum(done['pid'])}: {each}. The {GOAL:.0%} that is "
        f"aimed at is reached in: {', '.join(reached) or 'none'}.",
        f"Of the {sum(counts) - sum(done['learned'])} tours that it does not end, it loses its leader for good in "
        f"{lost}; contacts: {touched['learned']}, PID {touched['pid']}.",
        f"Jerk is {jerk / pid_jerk:.2f} of PID's; RMS error of the distance {off:.2f} m, PID {pid_off:.2f} m.",
        _maps(suites),
    ]


def _maps(suites: Mapping[str, Any]) -> str:
    """Return in words how the maps compare, and where there are none."""
    found = []
    for name, part in suites.items():
        if _mapped(part):
            test = part["paired"]["pid"]["adnn_truth_to_map_m"]
            learned, pid = (100.0 * part["figures"][who]["adnn_truth_to_map_m"]["mean"] for who in ("learned", "pid"))
            found.append(f"{name} {learned:.1f} (PID {pid:.1f}, p {test['p']:.2g}, {test['n']} episodes)")
    missing = [name for name, part in suites.items() if not _mapped(part)]
    words = f"Maps, ADNN truth to map [cm]: {', '.join(found)}; " if found else "Maps (ADNN): "
    return words + (f"not measured in: {', '.join(missing)}." if missing else "measured in all suites.")


def _mapped(part: Mapping[str, Any]) -> bool:
    return part["figures"]["learned"]["adnn_truth_to_map_m"]["n"] > 0


def _ended(part: Mapping[str, Any], who: str, ending: str) -> int:
    return part["figures"][who]["endings"].get(ending, 0)


def _contacts(part: Mapping[str, Any], who: str) -> int:
    return sum(n for ending, n in part["figures"][who]["endings"].items() if ending.startswith("collision"))


def _mean(suites: Mapping[str, Any], who: str, figure: str) -> float:
    return sum(part["figures"][who][figure]["mean"] for part in suites.values()) / len(suites)


def main(arguments: Sequence[str] | None = None) -> int:
    """Copy the files and write the card."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", type=Path, metavar="DIR", help="folder of `tagalong train follower`")
    parser.add_argument("--comparison", type=Path, metavar="DIR", help="folder of `tagalong bench follower-comparison`")
    options = parser.parse_args(arguments)
    card = _new_policy(options.run) if options.run is not None else _renewed(SHIPPED / f"{NAME}.json")
    write_json(SHIPPED / f"{NAME}.json", make_card(card, options.comparison))
    print(f"wrote {SHIPPED / NAME}.json")
    return 0


def _new_policy(run: Path) -> dict[str, Any]:
    """Copy the policy of a run; return its card."""
    if not (run / "policy.npz").is_file():
        raise InputError(f"{run} holds no policy.npz")
    made_folder(SHIPPED)
    for suffix in (".npz", ".onnx"):
        shutil.copyfile(run / f"policy{suffix}", SHIPPED / f"{NAME}{suffix}")
    return read_json(run / "policy.json")


def _renewed(card: Path) -> dict[str, Any]:
    """Return a shipped card with what surrounds the network as this program has it."""
    content = read_json(card)
    features = FeatureConfig(**content["pilot"]["features"])
    return {**content, "pilot": asdict(replace(PilotConfig(), features=features))}


if __name__ == "__main__":
    raise SystemExit(told(main))
