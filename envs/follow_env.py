"""The environment: a robot that follows a person through a building and maps it on the way."""

import copy
from array import array
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from ..slam.errors import InputError, shown
from ..slam.processes.stages import Stages, completed
from .compiled_parts import compiled_for
from .episode import EnvState, EpisodeState
from .episode_setup import OnboardStackFactory, check_options, checked_seed, interface, observed, world_config
from .follow_config import make_config
from .limits.field_checks import finite_numbers
from .onboard.stack import Belief
from .oracle import step_facts
from .sensors.sweeps import timed_odometry
from .task.coverage import Coverage, NoCoverage
from .task.endings import Ending, EndingRule
from .task.info import step_info
from .task.interface import OwnMap
from .task.observation import Observer, observation_space
from .task.rewards import StepFacts, exploration_terms, reward_terms
from .topview.rendering import SHOWN_AT_ONCE, make_renderer, possible_modes
from .world.truth import TrueState
from .world.world import World

Observation = dict[str, NDArray[Any]]
StepResult = tuple[Observation, float, bool, bool, dict[str, Any]]
Witness = Callable[[NDArray[np.float64], float, dict[str, float]], None]


def nobody_notes(action: NDArray[np.float64], reward: float, terms: dict[str, float]) -> None:
    """Be told of a step, and forget it."""


def checked_action(action: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return an action, cut to [-1, 1].

    Raises:
        InputError: If it has another shape, or is not finite.
    """
    wanted = finite_numbers(action)
    if wanted is None or wanted.shape != shape:
        raise InputError(f"an action has shape {shape} and is finite, got {shown(action)}")
    return np.clip(wanted, -1.0, 1.0)


class FollowEnv(gym.Env[Any, Any]):
    """A robot follows a person through a building full of other people, and may map it on the way.

    ## Description

    A robot, usually a Clearpath Dingo, stands behind a person, who soon sets off on a tour of the building: `corridor`
    (40 x 2.4 m with a bend and 10 m more), `meeting_room` (10 x 7 m), `office` (20 x 12 m of rooms along corridors;
    other kinds of floors for `split="test"` than for training), `floor_plan` (any ROS map, `floor_plan="map.yaml"`),
    `plain_corridor` (30 x 2.2 m, smooth walls), `landmarks` (round posts on open ground) or `lab` (9 x 7 m with a
    hinged door to a passage, and four scripted people more); all drawn from the seed. In offices and floor plans
    bystanders of several temperaments walk on ways of their own, and turn round when held up. The task is to stay 1.3 m
    behind (centre to centre), without touching anybody or anything, to the tour's end. What the robot knows comes from
    its planar laser scanner and its wheels alone: leg tracker, leader selection and SLAM run inside the environment, on
    scans from which people were removed. A step lasts 1 / `control_hz`, 0.1 s by default.

    ## Action

    `Box(-1, 1, (2,), float32)`, for a holonomic robot, `robot="dingo-o"`, `(3,)`. Values beyond are clipped; the
    robot's limits of acceleration (2 m/s^2, 8 rad/s^2) hold.

    | num | meaning | at -1 | at +1 |
    |---|---|---|---|
    | 0 | forward speed | -1.3 m/s | 1.3 m/s |
    | 1 (holonomic only) | speed to the left | -1.3 m/s | 1.3 m/s |
    | last | turn rate, counter-clockwise | -`top_turn_rate` | `top_turn_rate` = 2 rad/s |

    ## Observation

    `Dict`, float32, in the robot frame (x forward, y left), in m, m/s, rad/s; new arrays in every step.

    | key | shape | meaning | range |
    |---|---|---|---|
    | `scan` | (beams,) | range over `range_max`, right to left; 1: no return or no measurement | 0 .. 1 |
    | `leader` | (6,) | x, y, vx, vy (over ground), confidence, visible | 30 m, 3 m/s, 0 .. 1 |
    | `people` | (people_slots, 6) | other people, nearest first: x, y, vx, vy, confidence, present (mask) | as above |
    | `velocity` | (2,) or (3,) | own forward speed, speed to the left if holonomic, turn rate, by odometry | 3, 3, 6 |
    | `map` | (map_cells, map_cells) | cells around the robot: 0 free, 0.5 unknown, 1 occupied | 0 .. 1 |

    With `camera="kinect-v2"` there are two entries more, of a camera 1 m above the floor:

    | key | shape, type | meaning | range |
    |---|---|---|---|
    | `rgb` | (106, 128, 3) uint8 | red, green, blue | 0 .. 255 |
    | `depth` | (106, 128) float32 | depth along the camera's axis over 8 m; 0: nothing measured | 0 .. 1 |

    With `people="tracker"` the camera's people reach the tracker, too, 0.3 s after the exposure: who never moves is
    tracked and kept out of the map like all others.

    With `mapping="immobile"` the map holds what never moves, by laser and, if there is one, camera: people and what has
    come stay out of it, desk tops are in it; see `tagalong.perception.immobile`.

    The leader is chosen by the robot: the tracked person closest to it at onset. While it is lost, `leader` holds its
    predicted place with visible = 0; before one was chosen it is zero. Cell [i, j] of `map` lies at
    ((i + 0.5 - map_cells / 2) * map_resolution, likewise j) ahead and to the left. With `slam=None` nothing builds a
    map and there is no entry `map`: an entry that never changed would only slow learning down. Who plans ahead finds
    the robot's whole map, and its pose in it, at `env.unwrapped.interface.own_map()`.

    With `leader=False` nobody leads: the robot explores among the bystanders of the same seed (of `people_count` one
    more) until it has seen `coverage_goal` of the floor, and there is no entry `leader`;
    `tagalong.envs.task.coverage` says what counts as seen.

    ## Rewards

    The sum of these terms, also in `info["reward_terms"]`, with their usual weights, which `reward.NAME` sets. They are
    made of the truth, as rewards may be. s is the length of the step over 0.1 s; `tolerance` is 1 within a bound, 0.1
    one margin beyond it, a Gaussian in between.

    | term | formula | why |
    |---|---|---|
    | `distance` | s tolerance(distance - 1.3 m, bound 0.15 m, margin 0.85 m) | the task |
    | `facing` | 0.2 s tolerance(bearing of the leader, bound 0.2 rad, margin 1.2 rad) | legs leave the field of view |
    | `personal_space` | -s clip(1 - space / 0.45 m, 0, 1), space to the nearest bystander | people want room |
    | `smoothness` | -0.1 norm of the change of the action | smooth motion maps better |
    | `lost` | -0.2 s while the robot sees no leader or takes somebody else for it | search actively |
    | `collision` | -20 in each step with a contact | safety |
    | `tour` | +20 at the tour's end without contact | finish |

    Without a leader:

    | term | formula | why |
    |---|---|---|
    | `coverage` | 100 times the share of the floor newly seen | the task |
    | `personal_space`, `smoothness`, `collision` | as above | |
    | `covered` | +20 when the goal is reached without contact | finish |

    ## Starting state

    Building, robot pose (up to 0.5 m along the route, 0.1 m aside, 7 degrees turned), bodies, gaits, the leader's style
    and pauses, bystanders, and errors of odometry are drawn from the seed. `reset(options={...})` sets for one episode:

    | option | meaning |
    |---|---|
    | `scene` | name of a building, the four of Follow-Bench among them: "narrow_corridor", "doorway", ... |
    | `split` | "train", "test": of which half offices are drawn |
    | `route` | name of one of the scene's tours |
    | `people` | number of walking people, the leader included |
    | `standing` | number of further people who come to stand still for 25 s |
    | `leader_style` | "steady", "hurried", "waits" (when the robot lags behind) |
    | `heedless` | share of the bystanders who do not see the robot: they make no room for it |
    | `odometry` | "perfect", "good", "typical", "slipping" |

    ## Episode end

    Terminated: the robot touches a person or a thing (unless `ends_on_contact=False`); the leader has not been followed
    for `lost_limit_s`; the tour is done (the leader has stopped for good and the robot is within 2 m); without a
    leader, `coverage_goal` of the floor was seen. Truncated: by the registered ids after
    `max_episode_steps` = 3000 steps (Gymnasium's TimeLimit).

    ## Arguments

    `gymnasium.make("tagalong/Corridor-v0", people="truth", slam=None, **{"lidar.height": 0.3})`: a setting is named by
    its path in the tree of `FollowConfig`, such as `sensors.lidar.beams`, or by the end of it where only one ends so:
    `lidar.beams`, `beams`. What is in `perception`, `slam` and `reward` is named by its whole path. A branch takes a
    configuration, `slam=GMappingConfig(particles=50)`, or a text or None that chooses one.

    | branch | chosen by | settings |
    |---|---|---|
    | `world` | a `scene` | `scene`, `split`, `floor_plan`, `walking_paths` |
    | `robot` | "dingo-d", "dingo-o", "pioneer" | `drive`, `chassis`, `max_speed`, `max_acceleration`, `mass` ... |
    | `sensors.lidar` | | `beams`, `field_of_view`, `rate_hz`, `range_max`, `mount`, `height`, `sigma_near` ... |
    | `sensors.camera` | "kinect-v2", None | `width`, `height`, `rate_hz` ... |
    | `sensors.odometry` | "perfect", "good", "typical", "slipping" | `scale_limit`, `alpha1` ... |
    | `people` | "tracker", "camera", "truth", "modelled" | `source`, `people_count`, `standing`, `leader_style` ... |
    | `perception` | | `perception.removal.zeta` and all others of leg detector, tracker and people filter |
    | `slam` | "gmapping", "cartographer", "ekf", "immobile", "truth", None | `slam.particles` ..., `function(seed)` |
    | `mapping` | "occupancy", "immobile" | `map`, `filter_people` (False: raw scans into SLAM and map) |
    | `reward` | | weight of each term by its name, `following_distance` ...; `terms`: name -> `function(StepFacts)` |
    | `observation` | | `people_slots`, `map_cells`, `map_resolution`; `entries`: name -> (space, `function(Belief)`) |
    | `task` | | `leader`, `control_hz`, `top_turn_rate`, `lost_limit_s`, `coverage`, `ends_on_contact` ... |

    `tagalong.envs.follow_config` has them all, with what each means. Besides:

    - `render_mode`: None, "rgb_array", "human" (MuJoCo's viewer), "rerun" (rerun's, extra `rerun`: scans, map and
      people as the robot has them); the last two need a display.
    - `render_backend`: of "rgb_array": "topview" (needs no OpenGL), "mujoco" (camera; needs OpenGL).

    ## Info

    | key | meaning |
    |---|---|
    | `time_s` | simulated time [s] |
    | `reward_terms` | the terms above by name; all 0 after `reset` |
    | `ending` | "" or why it ended: "collision_person", "collision_static", "leader_lost", "tour_done", "covered" |
    | `is_success` | whether the tour was done, or the goal of coverage reached |
    | `leader_distance` | true distance from the leader, centre to centre [m]; like the next three only with one |
    | `following_leader` | whether the robot sees a leader and it is truly the one |
    | `lost_s` | for how long it has not [s] |
    | `leader_id` | identity of the track taken for the leader, -1 for none |
    | `tracked_people` | how many people the robot tracks |
    | `odometry` | (3,) T_odom_robot |
    | `robot_pose` | (3,) true T_world_robot |
    | `coverage` | share of the floor seen; without a leader, or with `coverage=True` |
    | `map_pose` | (3,) T_map_robot by SLAM; the map frame is the robot's first pose. Only with SLAM |

    ## Version history

    - v0: first version.
    """

    metadata = {"render_modes": ["rgb_array", "human", "rerun"], "render_fps": 10}  # noqa: RUF012 (Gymnasium's own form)

    def __init__(self, *, render_mode: str | None = None, render_backend: str = "topview", **fields: Any) -> None:
        self.config = make_config(fields)
        world_config(self.config, None)  # says now what would be wrong at the first reset
        self.render_mode = render_mode
        self.metadata = {
            "render_modes": possible_modes(),
            "render_fps": round(self.config.task.control_hz),
        }
        self.interface = replace(interface(self.config), own_map=self.own_map if self.config.slam is not None else None)
        self.observation_space: spaces.Space[Any] = observation_space(observed(self.config))
        self.action_space = spaces.Box(-1.0, 1.0, (3 if self.interface.holonomic else 2,), np.float32)
        top = [self.interface.max_speed] * (2 if self.interface.holonomic else 1)
        self._top = np.array([*top, self.interface.max_turn_rate])
        self._stacks = OnboardStackFactory(self.config)
        self._observer = Observer(observed(self.config))
        self._renderer = make_renderer(render_mode, render_backend)
        self._world: World | None = None
        self._closed = False
        self.witness: Witness = nobody_notes
        """Is told of every step: the action, cut to [-1, 1], the reward, and its terms by name."""

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start an episode; see the class for `options`."""
        self._require_open()
        super().reset(seed=checked_seed(seed))
        check_options(options)
        with compiled_for(self.config):
            world = World(world_config(self.config, options), self.np_random)
            self._world = world
            stack = self._stacks.make(world, self.np_random)
            measured = self.config.task.coverage or not self.config.task.leader
            coverage = Coverage(world.scene, world.config.robot.size[1]) if measured else NoCoverage()
            belief, truth = stack.update(world.scan(), world.odometry), world.truth
            stack.look(world.frames)
            coverage.update(belief.filtered_scan, truth.robot_pose)
            self._episode = EpisodeState(
                stack=stack,
                endings=EndingRule(self.config.task),
                coverage=coverage,
                belief=belief,
                truth=truth,
                action=np.zeros(len(self._top)),
                trail=array("d", truth.robot_pose[:2]),
                ending=Ending(),
                covered=coverage.share,
            )
        if self.render_mode in SHOWN_AT_ONCE:
            self.render()
        facts = self._facts(0.0)
        info = self._info(facts, dict.fromkeys(self._terms(facts), 0.0))
        return self._observer.observe(belief, world.frames), info

    def step(self, action: ArrayLike) -> StepResult:
        """Drive for one control period; see the class."""
        return completed(self.step_in_stages(action))

    def step_in_stages(self, action: ArrayLike) -> Stages[StepResult]:
        """Return the work of `step`, which can take turns with that of other environments; `action` is checked now."""
        self._require_open()
        world = self.world
        if self._episode.ending.terminated:
            raise InputError(f"the episode has ended ({self._episode.ending.reason}): call `reset` first")
        return self._step(world, checked_action(action, self._top.shape))

    def _step(self, world: World, wanted: NDArray[np.float64]) -> Stages[StepResult]:
        yield from self._advance(world, wanted)
        yield
        facts = self._facts(float(np.linalg.norm(wanted - self._episode.action)))
        self._episode.action, self._episode.covered = wanted, facts.coverage
        terms = self._terms(facts)
        ending = self._episode.ending = self._episode.endings.update(self._episode.truth, facts)
        if self.render_mode in SHOWN_AT_ONCE:
            self.render()
        info, reward = self._info(facts, terms), sum(terms.values())
        self.witness(wanted, reward, terms)
        yield
        return (
            self._observer.observe(self._episode.belief, world.frames),
            reward,
            ending.terminated,
            False,
            info,
        )

    def render(self) -> NDArray[np.uint8] | None:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Return a picture (height, width, 3) uint8 for "rgb_array"; None otherwise."""
        world = self.world
        now, trail = self._episode, np.array(self._episode.trail).reshape(-1, 2)
        return self._renderer.draw(world, now.truth, now.belief, trail)

    def close(self) -> None:
        """Close the viewer, if there is one; what was recorded can still be read, no step can be made."""
        self._renderer.close()
        self._closed = True

    @property
    def world(self) -> World:
        """The simulator of this episode.

        Raises:
            InputError: Before the first `reset`.
        """
        if self._world is None:
            raise InputError("the environment has no episode yet: call `reset` first")
        return self._world

    @property
    def truth(self) -> TrueState:
        """What is really so, now; for recording and metrics.

        Raises:
            InputError: Before the first `reset`.
        """
        _ = self.world
        return self._episode.truth

    @property
    def coverage(self) -> Coverage | NoCoverage:
        """How much of the floor was seen so far."""
        return self._episode.coverage

    @property
    def belief(self) -> Belief:
        """What the robot believes, now.

        Raises:
            InputError: Before the first `reset`.
        """
        _ = self.world
        return self._episode.belief

    def own_map(self) -> OwnMap:
        """Return the robot's own map and its pose in it, as its SLAM knows them now."""
        belief = self.belief
        return OwnMap(belief.map, belief.map_pose)

    def save_state(self) -> EnvState:
        """Return a snapshot: `restore_state` of it continues with the same bytes."""
        world = self.world
        kept = copy.deepcopy((self._episode, self._np_random, self._np_random_seed), self._shared(world, world))
        return EnvState(world, world.save_state(), kept[0], kept[1:])

    def restore_state(self, state: EnvState) -> None:
        """Go back to `state`, taken of this environment or of one with the same configuration."""
        world = state.world if state.world is self._world else copy.deepcopy(state.world)
        world.restore_state(state.world_state)
        self._world = world
        kept = copy.deepcopy((state.episode, *state.generator), self._shared(state.world, world))
        self._episode, self._np_random, self._np_random_seed = kept

    def _shared(self, old_world: World, new_world: World) -> dict[int, Any]:
        """Return what a deep copy of the episode does not copy: the world, and the leg detector's forest."""
        return {id(old_world): new_world, **self._stacks.shared}

    def _advance(self, world: World, wanted: NDArray[np.float64]) -> Stages[None]:
        start_s, before = world.time_s, world.odometry
        yield from world.step_in_stages(wanted * self._top)
        yield
        for scan, odometry in timed_odometry(world.scans, start_s, before, world.time_s, world.odometry):
            self._episode.belief = yield from self._episode.stack.update_in_stages(scan, odometry)
        self._episode.stack.look(world.frames)
        yield
        self._episode.truth = world.truth
        self._episode.coverage.update(self._episode.belief.filtered_scan, self._episode.truth.robot_pose)
        self._episode.trail.extend(self._episode.truth.robot_pose[:2])

    def _require_open(self) -> None:
        if self._closed:
            raise InputError("the environment is closed: make a new one")

    def _terms(self, facts: StepFacts) -> dict[str, float]:
        task, reward = self.config.task, self.config.reward
        return reward_terms(facts, reward) if task.leader else exploration_terms(facts, task.coverage_goal, reward)

    def _facts(self, action_change: float) -> StepFacts:
        radius, step_s = self.world.config.robot.radius, 1.0 / self.config.task.control_hz
        covered = (self._episode.covered, self._episode.coverage.share)
        return step_facts(self._episode.truth, self._episode.belief, radius, action_change, step_s, covered)

    def _info(self, facts: StepFacts, terms: dict[str, float]) -> dict[str, Any]:
        return step_info(
            self._episode.truth, self._episode.belief, facts, terms, self._episode.ending, self.config.task.leader
        )
