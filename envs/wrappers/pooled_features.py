"""Observations of many worlds at once, pooled into vectors; one world is a batch of one.

All of it is elementwise or a least value, so that a world's numbers are the same beside any others, to the bit.
"""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError
from ..task.interface import FollowInterface
from .pooled_config import LEADER_NAMES, LIMIT, PooledConfig

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Rows = NDArray[np.intp]
Batch = Mapping[str, NDArray[np.float32]]

NEVER_S = 1e3
"""For how long a leader was not seen whom nobody has seen yet [s]; told as `LIMIT`."""


class PooledFeatures:
    """Remembers what the episodes of some worlds have shown, and tells it.

    Args:
        config: What is told.
        interface: Scales of the environment.
        count: How many worlds.

    Raises:
        InputError: If the laser has fewer beams than there are sectors.
    """

    def __init__(self, config: PooledConfig, interface: FollowInterface, count: int = 1) -> None:
        beams = len(interface.bearings)
        if beams < config.sectors:
            raise InputError(f"{config.sectors} sectors need a laser of as many beams, got {beams}")
        self.config, self.count = config, count
        self._step_s, self._range_max = 1.0 / interface.control_hz, interface.range_max
        self._body = body_ranges(interface).astype(np.float32)
        self._starts = np.floor(np.arange(config.sectors) * beams / config.sectors).astype(np.intp)
        self._axes = 3 if interface.holonomic else 2
        self._unseen_s = np.full(count, NEVER_S)
        self._trail = np.zeros((count, config.trail, 2))
        self._actions = np.zeros((count, config.actions, self._axes))
        self._stack = np.zeros((count, config.stack, config.size(interface.holonomic) // config.stack), np.float32)
        self._all: Rows = np.arange(count)

    @property
    def size(self) -> int:
        """How many numbers are told of a world."""
        return self._stack.shape[1] * self._stack.shape[2]

    def begin(self, batch: Batch, rows: Rows | None = None) -> Floats:
        """Return (r, size) what is told at the start of episodes.

        Args:
            batch: Observations of the worlds `rows`, arrays (r, ...).
            rows: Which worlds; None for all.
        """
        rows = self._all if rows is None else rows
        if not len(rows):
            return np.zeros((0, self.size), dtype=np.float32)
        self._unseen_s[rows] = NEVER_S
        self._trail[rows], self._actions[rows] = 0.0, 0.0
        now = self._now(batch, rows)
        self._stack[rows] = now[:, None]
        return self._stack[rows].reshape(len(rows), -1)

    def update(self, batch: Batch, actions: NDArray[np.floating], rows: Rows | None = None) -> Floats:
        """Return (r, size) what is told after a step.

        Args:
            batch: Observations of the worlds `rows`, arrays (r, ...).
            actions: (r, a) that led to them, cut to [-1, 1] here.
            rows: Which worlds; None for all.
        """
        rows = self._all if rows is None else rows
        if not len(rows):
            return np.zeros((0, self.size), dtype=np.float32)
        if self.config.actions:
            cut = np.clip(np.asarray(actions, dtype=np.float64), -1.0, 1.0).reshape(len(rows), 1, self._axes)
            self._actions[rows] = np.concatenate((cut, self._actions[rows, :-1]), axis=1)
        now = self._now(batch, rows)
        self._stack[rows] = np.concatenate((now[:, None], self._stack[rows, :-1]), axis=1)
        return self._stack[rows].reshape(len(rows), -1)

    def _now(self, batch: Batch, rows: Rows) -> Floats:
        velocity = batch["velocity"].astype(np.float64)
        leader = batch["leader"].astype(np.float64)
        self._remember(leader, velocity, rows)
        parts = (
            self._sectors(batch["scan"]),
            self._leader(leader, rows),
            self._trail[rows].reshape(len(rows), -1) / self.config.length_scale,
            self._people(batch["people"].astype(np.float64)),
            velocity,
            self._actions[rows].reshape(len(rows), -1),
        )
        return np.clip(np.concatenate(parts, axis=1), -LIMIT, LIMIT).astype(np.float32)

    def _sectors(self, scan: Floats) -> Array:
        """Return (r, sectors) readings; the gap is along the beam, from the robot's body on."""
        gaps = np.minimum.reduceat(scan * np.float32(self._range_max) - self._body, self._starts, axis=1)
        return np.exp(-np.maximum(gaps, 0.0) / self.config.gap_scale).astype(np.float64)

    def _leader(self, leader: Array, rows: Rows) -> Array:
        """Return (r, 11) the leader, names `LEADER_NAMES`."""
        told = np.zeros((len(rows), len(LEADER_NAMES)))
        away = np.hypot(leader[:, 0], leader[:, 1])
        scale, known = self.config.length_scale, self._unseen_s[rows] < NEVER_S
        told[:, 0:2], told[:, 2:4] = leader[:, 0:2] / scale, leader[:, 2:4]
        told[:, 4], told[:, 5:7] = away / scale, leader[:, 0:2] / np.maximum(away, 1e-3)[:, None]
        told[:, 7], told[:, 8], told[:, 9] = leader[:, 4], leader[:, 5], known
        told[:, 10] = self._unseen_s[rows] / self.config.unseen_scale
        return told

    def _people(self, people: Array) -> Array:
        told = np.zeros((len(people), self.config.people, 6))
        shown = people[:, : self.config.people]
        away = np.hypot(shown[..., 0], shown[..., 1])
        there = shown[..., 5]
        part = told[:, : shown.shape[1]]
        part[..., 0:2], part[..., 2:4] = shown[..., 0:2] / self.config.length_scale, shown[..., 2:4]
        part[..., 4], part[..., 5] = np.exp(-away) * there, there
        return told.reshape(len(people), -1)

    def _remember(self, leader: Array, velocity: Array, rows: Rows) -> None:
        """Carry the trail into the robot frame of now, and take note of a leader who is seen."""
        left = velocity[:, 1] if self._axes == 3 else np.zeros(len(rows))
        moved = self._trail[rows] - self._step_s * np.stack((velocity[:, 0], left), axis=1)[:, None]
        turned = velocity[:, -1:] * self._step_s
        cos, sin, x, y = np.cos(turned), np.sin(turned), moved[..., 0], moved[..., 1]
        trail = np.stack((cos * x + sin * y, cos * y - sin * x), axis=2)
        seen, fresh = leader[:, 5] > 0.5, self._unseen_s[rows] >= NEVER_S
        place = leader[:, None, 0:2]
        apart = np.hypot(*(trail[:, 0] - leader[:, 0:2]).T)
        new = seen & (fresh | (apart > self.config.trail_jump))
        on = seen & ~new & (apart > self.config.trail_spacing)
        trail = np.where(new[:, None, None], place, trail)
        trail = np.where(on[:, None, None], np.concatenate((place, trail[:, :-1]), axis=1), trail)
        self._trail[rows] = np.where((fresh & ~seen)[:, None, None], 0.0, trail)
        waited = np.where(fresh, NEVER_S, np.minimum(self._unseen_s[rows] + self._step_s, 0.5 * NEVER_S))
        self._unseen_s[rows] = np.where(seen, 0.0, waited)


def body_ranges(interface: FollowInterface) -> Array:
    """Return (N,) how far the robot's own box reaches along each beam [m]; 0 for a laser outside of it."""
    x, y, turn = interface.T_robot_lidar
    half = np.array((interface.half_length, interface.half_width))
    if abs(x) >= half[0] or abs(y) >= half[1]:
        return np.zeros(len(interface.bearings))
    bearings = interface.bearings + turn
    directions = np.stack((np.cos(bearings), np.sin(bearings)), axis=1)
    room = half - np.sign(directions) * np.array((x, y))
    with np.errstate(divide="ignore"):
        ways = np.where(np.abs(directions) > 1e-9, room / np.abs(directions), math.inf)
    return ways.min(axis=1)
