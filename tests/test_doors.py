"""The public surface: what each floor's door offers, and that it is light and says so itself."""

import ast
import doctest
import subprocess
import sys
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import GenericAlias

import pytest

FLOORS = ("slam", "perception", "envs", "agents")
SURFACE = {
    "slam": """CartographerConfig Deskewer EkfSlamConfig GMappingConfig InputError LaserScan Localizer OccupancyMap
        RecordedDrive SlamEngine SlamRun SlamUpdate absolute_error make_matcher make_slam read_log read_ros_map run_slam
        score_map write_ros_map""",
    "perception": """Detections FilteredScan HindsightFilter ImmobileMapper LeaderSelector LegDetector
        LegDetectorConfig LegForest People PeopleFilter PeopleFilterConfig PeopleFinder PeopleTracker PerceptionConfig
        Pinhole PlaneFinder RgbdFrame TrackerConfig filtered_scans perception_preset table_ii""",
    "envs": """Behaviour Belief CompiledVectorEnv CudaVectorEnv Episode FollowConfig FollowEnv FollowVectorEnv Operator
        PersonView RgbdConfig RobotConfig Scene SceneRequest StepFacts Wish World WorldConfig rollout""",
    "agents": """DWAConfig DWAFollower EXPLORERS FOLLOWERS Follower FrontierExplorer LearnedFollower MPPIConfig
        MPPIFollower PIDConfig PIDFollower PufferWorlds PurePursuitConfig PurePursuitFollower RandomWalk
        RandomWalkConfig RslRlVecEnv SB3VecEnv TensorVectorEnv TourConfig following_tour make_follower""",
}
"""What users may rely on. A name that goes, or comes, is a decision: it is made here, and told in the changelog."""

FOLDERS = {
    "slam.logs": "RerunRecording RosRecording Trajectory open_recording read_carmen read_tum write_carmen write_tum",
    "perception.immobile": "CameraViewMaker ImmobileSlam",
    "perception.rgbd": "PersonClassifier Pinhole RgbdFrame RgbdPeople Surface read_bag_frames read_frames",
    "perception.tracking": "NoLegs SeenPeople",
    "envs.recording": "Demonstration EpisodeRecording demonstrate write_lerobot write_minari",
    "envs.scenes": """Door Errand RUN_OUT SCENES Scene SceneMaker SceneRequest Solid Walk box choose_route make_scene
        post room rounded""",
    "envs.task": "FollowInterface OwnMap",
    "envs.wrappers": "PooledConfig PooledFeatures PooledObservation PooledVectorObservation",
    "agents.learned": "PilotConfig pilot_config",
    "agents.teleop": """JoystickLog JoystickReplay KeyboardStick read_joystick_log record_drive replay_drive
        write_joystick_log""",
    "agents.training": "CurriculumConfig ImitationConfig ReinforcementConfig RunConfig TrainingRun make_preset",
}
"""The same of folders with a door of their own: what some users need and most do not."""
PUBLIC = {**SURFACE, **FOLDERS}
LENT = [folder for folder in PUBLIC if folder != "envs.scenes"]
"""Those whose names load when they are asked for."""
NEEDS = {"agents.training": "stable_baselines3", "SB3VecEnv": "stable_baselines3", "TensorVectorEnv": "torch"}


@pytest.mark.parametrize("floor", PUBLIC)
def test_the_door_offers_these_names_and_no_others(floor):
    pytest.importorskip(NEEDS.get(floor, "tagalong"))
    door = import_module(f"tagalong.{floor}")
    assert sorted(door.__all__) == sorted(PUBLIC[floor].split())
    assert set(door.__all__) <= set(dir(door))
    for name in door.__all__:
        if find_spec(NEEDS.get(name, "tagalong")) is None:
            continue
        offered = getattr(door, name)
        assert offered.__doc__ or isinstance(offered, GenericAlias), name
        assert name in (door.__doc__ or ""), name  # the manual speaks of each
    assert len((door.__doc__ or "").splitlines()) < 45


@pytest.mark.parametrize("floor", PUBLIC)
def test_type_checkers_see_the_same_names(floor):
    door = import_module(f"tagalong.{floor}")
    tree = ast.parse(Path(door.__file__).read_text())
    seen = [n for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.level for n in node.names]
    assert {(alias.asname or alias.name) for alias in seen} >= set(door.__all__)


@pytest.mark.parametrize("floor", SURFACE)
def test_the_example_of_the_manual_runs(floor):
    door = import_module(f"tagalong.{floor}")
    result = doctest.testmod(door, optionflags=doctest.ELLIPSIS)
    assert result.attempted >= 3
    assert result.failed == 0


@pytest.mark.parametrize("floor", LENT)
def test_a_name_that_is_not_there_is_told_with_those_that_are(floor):
    door = import_module(f"tagalong.{floor}")
    with pytest.raises(AttributeError, match=f"'tagalong.{floor}' has no attribute 'no_such_name'"):
        _ = door.no_such_name


def test_the_doors_open_without_anything_heavy():
    heavy = ("torch", "mujoco", "numba", "matplotlib", "scipy", "sklearn", "stable_baselines3")
    code = f"import sys; import {', '.join('tagalong.' + floor for floor in LENT)}\n"
    code += f"print([name for name in {heavy} if name in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
