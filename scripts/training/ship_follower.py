"""Ships a trained follower: its files and a card, made of its training run and of a comparison on the suites.

`python -m tagalong.scripts.training.ship_follower --run out/follower --comparison out/followers`
"""

import argparse
import json
import shutil
from collections.abc import Sequence
from pathlib import Path

from ...agents.learned.follower import SHIPPED
from ...slam.errors import InputError
from ...slam.files import made_folder, write_json

NAME = "follower"
DATA = (
    "simulated drives only: the training half of tagalong/Office-v0 with 0 to 12 bystanders, floor_plan, meeting_room "
    "and corridor; seeds below 900000; leaders who walk steadily or wait; leg tracker inside; 360 or 1081 beams"
)
LIMITS = (
    "It does not reach the 97 % of tours that were aimed at, and in unseen offices not PID's share either: see "
    "`suites`. It is much smoother than PID; room for bystanders and the map are about PID's.",
    "Trained by imitation alone, before guard and steering were settled (on the training half); never reinforced.",
    "Not measured: corridor, meeting_room, floor_plan, crowds and untrained manners of leaders, with SLAM.",
    "Trained in simulation alone; no real robot has driven it.",
    "It is told who leads by the tracker: when the tracker takes somebody else for the leader, it follows that person.",
    "It is not told the map, and the laser sees nothing in the 90 degrees behind: it does not search rooms for a "
    "leader who was lost for long.",
    "For a robot of a Dingo's size (0.55 x 0.52 m) at up to 1.3 m/s with a laser of 270 degrees, 10 steps a second.",
)


def make_card(run: Path, comparison: Path | None) -> dict[str, object]:
    """Return the card: that of the training run, data, command, limits, and the figures on the suites."""
    card = json.loads((run / "policy.json").read_text())
    pilot = card.pop("pilot")
    measured = {} if comparison is None else json.loads((comparison / "comparison.json").read_text())
    command = f"tagalong train follower --algo {card['algorithm']} --preset {card['preset']} --seed {card['seed']}"
    return {
        **card,
        "command": command,
        "data": DATA,
        "limits": list(LIMITS),
        "suites": measured.get("suites", {}),
        "suites_command": "python -m tagalong.scripts.experiments.follower_comparison --followers learned pid",
        "pilot": pilot,
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Copy the files and write the card."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", type=Path, required=True, metavar="DIR", help="folder of `tagalong train follower`")
    parser.add_argument("--comparison", type=Path, metavar="DIR", help="folder of `follower_comparison`")
    options = parser.parse_args(arguments)
    if not (options.run / "policy.npz").is_file():
        raise InputError(f"{options.run} holds no policy.npz")
    made_folder(SHIPPED)
    for suffix in (".npz", ".onnx"):
        shutil.copyfile(options.run / f"policy{suffix}", SHIPPED / f"{NAME}{suffix}")
    write_json(SHIPPED / f"{NAME}.json", make_card(options.run, options.comparison))
    print(f"wrote {SHIPPED / NAME}.npz, .onnx, .json")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
