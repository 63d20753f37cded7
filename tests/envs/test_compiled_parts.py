"""What is compiled together at the first use is what is called then."""

import json
import subprocess
import sys

import pytest

PROGRAM = """
import json, sys
from importlib import import_module

def kernels():
    return [getattr(import_module("tagalong." + module), name) for module, name in json.loads(sys.argv[1])]

def signatures():
    return [{str(one) for one in kernel.signatures} for kernel in kernels()]

PARTS
compiled = signatures()
USE
print(json.dumps([kernel.py_func.__name__ for kernel, before, after in zip(kernels(), compiled, signatures())
    if not before or after - before]))
"""
PEOPLE = [
    ["perception.legs.detection_kernel", "find_legs"],
    ["perception.tracking.following", "follow"],
    ["perception.tracking.following", "maintain"],
]
SIMULATION = [
    ["envs.people.movement.walking", "free_sides"],
    ["envs.people.behaviours.deciding", "decide"],
    ["envs.people.walk_kernel", "walk"],
    ["envs.sensors.ray_kernel", "cast_beams"],
]
PARTICLES = [["slam.gmapping.match_kernels", "match"], ["slam.gmapping.tile_kernels", "own_tiles"]]
GRAPH = [
    ["slam.local.surface", "surface_points"],
    ["slam.scan_to_grid.refine_kernels", "refine_pose"],
    ["slam.scan_to_grid.match_kernels", "match_nodes"],
]
CORRECTION = [
    ["slam.search.best_first", "best_leaves"],
    ["slam.scan_to_scan.symmetric", "register_both"],
    ["slam.scan_to_scan.registration", "register"],
]
WORLDS = [
    ["envs.compiled.episodes", "sweep_worlds"],
    ["envs.compiled.episodes", "judge_worlds"],
    ["envs.compiled.tracking", "track_worlds"],
]
STEPPED = "env.reset(seed=1)\nfor _ in range(3): env.step(env.action_space.sample() * 0.1)"


@pytest.mark.parametrize(
    ("kernels", "parts", "use"),
    [
        (
            WORLDS,
            "from tagalong.envs.compiled.parts import read_sweep, sweep\nread_sweep()\nsweep()",
            "from tagalong.envs import CompiledVectorEnv\n"
            f"env = CompiledVectorEnv(4, people='tracker', workers=1, episodes_ahead=4)\n{STEPPED}",
        ),
        (
            [*PEOPLE, *SIMULATION, *PARTICLES],
            "from tagalong.perception.compiled_parts import track_people\nfrom tagalong.envs.compiled_parts import "
            "simulate, map_by_particles\ntrack_people()\nsimulate()\nmap_by_particles()",
            f"from tagalong.envs import FollowEnv\nenv = FollowEnv(scene='meeting_room')\n{STEPPED}",
        ),
        (
            [*CORRECTION, *GRAPH],
            "from tagalong.slam.first_use.parts import correct_drive, map_by_graph\ncorrect_drive()\nmap_by_graph()",
            "from tagalong.slam import LaserScan, make_slam\n"
            "from tagalong.slam.first_use.parts import round_the_room\nfrom tagalong.slam.runner import run_slam\n"
            "run_slam(make_slam('cartographer', seed=3), round_the_room(90)).map()",
        ),
    ],
    ids=["compiled worlds", "environment", "graph SLAM of a log"],
)
def test_the_slow_kernels_are_compiled_by_the_parts(kernels, parts, use):
    program = PROGRAM.replace("PARTS", parts).replace("USE", use)
    answer = subprocess.run(
        [sys.executable, "-c", program, json.dumps(kernels)], capture_output=True, text=True, check=True
    )
    assert json.loads(answer.stdout) == []
