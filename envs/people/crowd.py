"""All people of one world: who they are, where they are, and what they want next."""

import math
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from ..scenes.scene import Errand
from .body import PARTS, Physique
from .gait import advance_gait, pose_bodies
from .leader import LeadingPedestrian
from .movement.meeting import first_coming, group_comes
from .movement.social_force import SocialForceConfig
from .movement.terrain import Terrain
from .movement.walking import SPACING, advance_bodies, locate, turn_bodies, wanted_directions

Array = NDArray[np.float64]

_SPEED_UP, _SLOW_DOWN = 0.7, 1.0
_SIDESTEP = 0.4
_ARRIVED, _PASSED = 0.15, 0.35


class Role(IntEnum):
    """What a person is there for."""

    LEADER = 0
    COMPANION = 1
    WALKER = 2
    STANDER = 3
    SCRIPTED = 4
    WANDERER = 5


@dataclass
class CrowdState:
    """All that changes about n people; arrays have one row a person.

    Attributes:
        position: (n, 2) bodies, world frame [m].
        velocity: (n, 2) [m/s].
        heading: (n,) [rad].
        feet: (n, 2, 2) left and right foot on the floor [m].
        origin: (n, 2) where the swing foot lifted off [m].
        lift: (n, 2) heights of the feet [m].
        phase: (n,) of the present step.
        swing: (n,) foot of the present step, -1 while both stand.
        legs: (n, 2, 2) where the shins meet the laser's plane [m].
        arc: (n,) way along the path [m].
        sense: (n,) +1 along the path, -1 against it.
        lateral: (n,) present wanted offset from the path [m].
        wish: (n,) present wanted speed [m/s].
        face: (n,) where to look while standing [rad]; NaN: anywhere.
        timer: (n,) seconds that standers have walked in sight, or wanderers have been held up (> 0), or that both still
            have to stand (< 0).
        errand: (n,) number of the place that scripted people go to, or wait at.
        leader: The leader's mind; None without a leader.
    """

    position: Array
    velocity: Array
    heading: Array
    feet: Array
    origin: Array
    lift: Array
    phase: Array
    swing: NDArray[np.int64]
    legs: Array
    arc: Array
    sense: Array
    lateral: Array
    wish: Array
    face: Array
    timer: Array
    errand: NDArray[np.int64]
    leader: LeadingPedestrian | None


@dataclass(frozen=True, kw_only=True)
class Casting:
    """What never changes about n people.

    Attributes:
        roles: (n,) `Role` of each.
        physiques: Sizes of each.
        pace: (n,) preferred speed [m/s].
        side: (n,) preferred offset from the path, left positive [m].
        gap: (n,) how far companions walk ahead of the leader [m].
        window: (n, 2) arc lengths between which standers walk [m].
        path: (n,) which path of the terrain each walks on; 0 is the route.
        patience: (n,) how long wanderers stand held up before they turn round [s].
        rest: (n,) how long wanderers stay at the ends of their walks [s].
        gives_way: (n,) whether wanderers stop for the group.
        errands: What the scripted people do; they are the last of the n.
    """

    roles: NDArray[np.int64]
    physiques: tuple[Physique, ...]
    pace: Array
    side: Array
    gap: Array
    window: Array
    path: NDArray[np.int64]
    patience: Array
    rest: Array
    gives_way: NDArray[np.bool_]
    errands: tuple[Errand, ...] = ()


class Crowd:
    """Moves the people.

    Args:
        terrain: Where they walk.
        casting: Who they are.
        state: Where they are; owned by the crowd from now on.
        force: The social force.
    """

    def __init__(self, terrain: Terrain, casting: Casting, state: CrowdState, force: SocialForceConfig) -> None:
        self.casting = casting
        self.state = state
        self.terrain = terrain
        self._force = force.as_array()
        self.radius = np.array([p.radius for p in casting.physiques])
        self.leg_radius = np.array([p.leg_radius for p in casting.physiques])
        self._size = np.array(
            [(p.thigh, p.shin, p.leg_radius, p.stance_half_width, p.walk_ratio) for p in casting.physiques]
        ).reshape(-1, 5)
        self._roles = [Role(int(role)) for role in casting.roles]
        self._in_group = sum(role <= Role.COMPANION for role in self._roles)
        self._wanders = np.asarray(casting.roles) == Role.WANDERER
        self._direction = np.zeros((len(casting.roles), 2))
        self._first, self._count = terrain.first[casting.path], terrain.count[casting.path]

    def __len__(self) -> int:
        return len(self.casting.roles)

    def decide(self, dt: float, robot: Array, robot_arc: float) -> None:
        """Let everybody choose speed and side for the next `dt` seconds.

        Args:
            dt: Time [s].
            robot: (8,) the robot as in `advance_bodies`.
            robot_arc: Its way along the path [m].
        """
        state = self.state
        away = np.hypot(state.position[:, 0] - robot[0], state.position[:, 1] - robot[1])
        for person, role in enumerate(self._roles):
            if role == Role.LEADER:
                wish = self._lead(person, dt, robot, float(away[person]))
            elif role == Role.COMPANION:
                wish = self._accompany(person, robot_arc)
            elif role == Role.WALKER:
                wish = self._stroll(person, robot_arc)
            elif role == Role.WANDERER:
                wish = self._wander(person, dt, robot)
            elif role == Role.SCRIPTED:
                wish = self._run_errand(person, dt)
            else:
                wish = self._stand(person, dt, float(away[person]))
            change = min(max(wish - state.wish[person], -_SLOW_DOWN * dt), _SPEED_UP * dt)
            state.wish[person] = max(0.0, state.wish[person] + change)
            shift = self._side(person) - state.lateral[person]
            state.lateral[person] += min(max(shift, -_SIDESTEP * dt), _SIDESTEP * dt)

    def advance(self, dt: float, robot: Array) -> None:
        """Move everybody for `dt` seconds; `robot` as in `advance_bodies`."""
        s, terrain = self.state, self.terrain
        ways = (terrain.paths, terrain.tangents, self._first, self._count)
        wanted_directions(s.position, s.arc, s.sense, s.lateral, *ways, self._direction)
        self._go_straight()
        advance_bodies(
            dt,
            s.position,
            s.velocity,
            s.heading,
            self._direction,
            s.wish,
            self.radius,
            robot,
            terrain.boxes,
            terrain.circles,
            self._force,
        )
        self._close_laps()
        locate(s.position, s.arc, *ways)
        turn_bodies(dt, s.velocity, self._direction, s.wish, s.face, s.heading)
        advance_gait(
            dt,
            s.position,
            s.velocity,
            s.heading,
            self._size,
            s.feet,
            s.origin,
            s.lift,
            s.phase,
            s.swing,
            terrain.boxes,
            terrain.circles,
        )

    def pose(self, laser_height: float, mocap_position: Array, mocap_quaternion: Array) -> None:
        """Write the parts of all bodies into MuJoCo's mocap arrays (6 n, 3) and (6 n, 4)."""
        s, count = self.state, len(self) * len(PARTS)
        pose_bodies(
            s.position,
            s.heading,
            self._size,
            s.feet,
            s.lift,
            laser_height,
            mocap_position[:count],
            mocap_quaternion[:count],
            s.legs,
        )

    @property
    def leader_index(self) -> int:
        """Index of the leader, -1 without one."""
        return 0 if self.state.leader is not None else -1

    def _close_laps(self) -> None:
        lap = self.terrain.lap
        if lap > 0.0:
            free = (self.casting.roles >= Role.WALKER) & (self.casting.path == 0)
            ahead = free & (self.state.arc > self.terrain.length - 1.5)
            self.state.arc[ahead] -= lap

    def _lead(self, person: int, dt: float, robot: Array, away: float) -> float:
        state, leader = self.state, self.state.leader
        assert leader is not None
        wish = leader.decide(dt, float(state.arc[person]), away)
        towards = np.arctan2(robot[1] - state.position[person, 1], robot[0] - state.position[person, 0])
        state.face[person] = towards if leader.looks_back else self.terrain.ahead(float(state.arc[person]))
        return wish

    def _accompany(self, person: int, robot_arc: float) -> float:
        """Return the speed of somebody who walks ahead of the leader, or waits to fall in behind when left behind."""
        state = self.state
        gap = state.arc[person] - state.arc[0]
        if gap < 0.0 and state.arc[person] - robot_arc > -2.5:
            return 0.0
        late = self.casting.gap[person] - gap
        state.face[person] = self.terrain.ahead(float(state.arc[person]))
        if state.wish[0] == 0.0 and late < 0.2:
            return 0.0
        return float(min(max(state.wish[0] + 0.8 * late, 0.0), 1.5))

    def _stroll(self, person: int, robot_arc: float) -> float:
        """Return the speed of somebody who walks on their own and keeps out of the group's way."""
        state, arc = self.state, float(self.state.arc[person])
        pace, lap = float(self.casting.pace[person]), self.terrain.lap
        if lap == 0.0:
            if arc > self.terrain.length - 0.9:
                state.sense[person] = -1.0
            elif arc < 0.9:
                state.sense[person] = 1.0
        front = max([robot_arc, *state.arc[: self._in_group].tolist()])
        if state.sense[person] < 0.0:
            meets = 0.0 < arc - front < 8.0
            return 0.0 if meets and self.terrain.narrows_before(arc, front) else pace
        ahead, behind = arc - front, robot_arc - arc
        if lap > 0.0:
            ahead, behind = ahead % lap, behind % lap
        if 0.0 <= behind < 2.5:
            return 0.3 * pace if behind > 1.5 else 0.0
        if 0.0 <= ahead < 2.5:
            return max(pace, float(state.wish[0]) + 0.3) if self._in_group else pace
        return pace

    def _stand(self, person: int, dt: float, away: float) -> float:
        """Return the speed of somebody who walks to and fro until the robot has come, then stands for a while."""
        state, timer = self.state, self.state.timer
        low, high = self.casting.window[person]
        if state.arc[person] > high:
            state.sense[person] = -1.0
        elif state.arc[person] < low:
            state.sense[person] = 1.0
        if timer[person] < 0.0:
            timer[person] = min(0.0, timer[person] + dt)
            return 0.0
        timer[person] += dt if away < 6.0 else 0.0
        if timer[person] > 3.0:
            timer[person] = -25.0
        return float(self.casting.pace[person])

    def _wander(self, person: int, dt: float, robot: Array) -> float:
        """Return the speed of somebody who walks to and fro on a way of their own, and turns round when held up."""
        state, path = self.state, int(self.casting.path[person])
        arc, length = float(state.arc[person]), float(self._count[person] - 1) * SPACING
        if (arc > length - 0.5 and state.sense[person] > 0.0) or (arc < 0.5 and state.sense[person] < 0.0):
            state.sense[person] *= -1.0
            state.timer[person] = -self.casting.rest[person]
        if state.timer[person] < 0.0:
            state.timer[person] = min(0.0, state.timer[person] + dt)
            return 0.0
        held_up = state.wish[person] > 0.3 and math.hypot(*state.velocity[person].tolist()) < 0.15
        state.timer[person] = state.timer[person] + dt if held_up else max(0.0, state.timer[person] - dt)
        if state.timer[person] > self.casting.patience[person]:
            state.sense[person] *= -1.0
            state.timer[person] = 0.0
        if self.casting.gives_way[person] and self._group_comes(person, robot):
            return 0.0
        recorded = self.terrain.recorded_speed(arc, path)
        return float(self.casting.pace[person]) if math.isnan(recorded) else recorded

    def _group_comes(self, person: int, robot: Array) -> bool:
        """Return whether the robot or one of the group is within 2 m before a wanderer, walking."""
        state = self.state
        return group_comes(person, self._in_group, robot, state.position, state.velocity, self._direction)

    def _run_errand(self, person: int, dt: float) -> float:
        """Return the speed of somebody who goes from place to place: 0 while they wait, and at the last one."""
        state, errand = self.state, self._errand(person)
        state.face[person] = errand.face
        x, y, wait = errand.places[state.errand[person]]
        away = math.hypot(x - state.position[person, 0], y - state.position[person, 1])
        last = state.errand[person] + 1 == len(errand.places)
        if away > (_ARRIVED if last else _PASSED) and state.timer[person] == 0.0:
            return min(errand.pace, 0.25 + 0.8 * away)
        if state.timer[person] < wait:
            state.timer[person] += dt
            return 0.0
        if not last:
            state.errand[person] += 1
            state.timer[person] = 0.0
        return 0.0

    def _errand(self, person: int) -> Errand:
        return self.casting.errands[person - len(self) + len(self.casting.errands)]

    def _go_straight(self) -> None:
        """Point the scripted people to the places that they go to."""
        for person in range(len(self) - len(self.casting.errands), len(self)):
            x, y, _ = self._errand(person).places[self.state.errand[person]]
            dx, dy = x - self.state.position[person, 0], y - self.state.position[person, 1]
            away = max(math.hypot(dx, dy), 1e-6)
            self._direction[person] = (dx / away, dy / away)

    def _side(self, person: int) -> float:
        """Return the wanted offset from the path [m]: walkers keep right, and the group turns out for whom it meets.

        The leader and who walks with them stay in the middle of a bend, because the robot behind them cuts it.
        """
        state, role = self.state, self._roles[person]
        arc, side = float(state.arc[person]), float(self.casting.side[person])
        if role == Role.SCRIPTED:
            return 0.0
        if role == Role.WANDERER:
            return self.terrain.within_free(arc, -float(state.sense[person]) * side, int(self.casting.path[person]))
        if role == Role.STANDER or self.terrain.lap > 0.0:
            return side
        if role == Role.WALKER:
            return self.terrain.within_free(arc, -float(state.sense[person]) * self.terrain.passing)
        if self.terrain.in_bend(arc):
            return 0.0
        other = self._first_met(person, arc)
        if other is not None:
            return self.terrain.within_free(arc, math.copysign(self.terrain.turn_out, -state.lateral[other]))
        return self.terrain.within_free(arc, side)

    def _first_met(self, person: int, arc: float) -> int | None:
        """Return the first of those who come towards one of the group, `arc` along the route; None for nobody."""
        state = self.state
        wanderer = first_coming(person, self._wanders, state.position, state.velocity, self._direction)
        for other in range(self._in_group, len(self) if wanderer < 0 else wanderer):
            if self._roles[other] == Role.WANDERER:
                continue
            comes = state.sense[other] < 0.0 or self._roles[other] == Role.STANDER
            if comes and -1.0 < state.arc[other] - arc < 6.0:
                return other
        return wanderer if wanderer >= 0 else None
