"""Steps of people: where the feet stand, and how long the steps are."""

import numpy as np
import pytest
from tagalong.envs.people.body import ANKLE, HIP_HALF_WIDTH
from tagalong.envs.people.gait import advance_gait
from tagalong.envs.people.movement.things import things_around
from tagalong.envs.people.posture import pose_bodies

DT = 0.025
THIGH, SHIN, LEG, HALF, RATIO = 0.43, 0.43, 0.06, 0.1, 0.4
NOTHING = things_around(np.zeros((0, 6)), np.zeros((0, 3)), 1.0)
SIZE = np.array([[THIGH, SHIN, LEG, HALF, RATIO]])


def walk(velocities, turn_rate=0.0):
    """Walk one person with the given velocities (k, 2); return feet (k, 2, 2), lift (k, 2), bodies (k, 2)."""
    position, heading = np.zeros((1, 2)), np.zeros(1)
    feet = np.array([[[0.0, HALF], [0.0, -HALF]]])
    origin, lift, phase, swing = np.zeros((1, 2)), np.zeros((1, 2)), np.zeros(1), np.full(1, -1)
    history = []
    for velocity in velocities:
        position += DT * velocity
        heading += DT * turn_rate
        advance_gait(DT, position, velocity[None], heading, SIZE, feet, origin, lift, phase, swing, NOTHING)
        history.append((feet[0].copy(), lift[0].copy(), position[0].copy()))
    return tuple(np.array(rows) for rows in zip(*history, strict=True))


def footfalls(feet, lift):
    """Places (k, 2) of all footfalls, in time order."""
    landed = (lift[1:] == 0.0) & (lift[:-1] > 0.0)
    when, foot = np.nonzero(landed)
    return feet[when + 1, foot], when * DT


def test_a_foot_on_the_floor_stands_still():
    speed = 0.7 + 0.6 * np.sin(np.arange(1200) * DT)
    way = 0.5 * np.sin(0.7 * np.arange(1200) * DT)
    feet, lift, _ = walk(np.stack((speed * np.cos(way), speed * np.sin(way)), axis=-1))
    standing = (lift[1:] == 0.0) & (lift[:-1] == 0.0)
    moved = np.hypot(*(feet[1:] - feet[:-1]).transpose(2, 0, 1))
    assert standing.mean() > 0.5
    assert moved[standing].max() == 0.0


def test_one_foot_is_always_on_the_floor():
    _, lift, _ = walk(np.tile([1.2, 0.0], (400, 1)))
    assert np.all(lift.min(axis=1) == 0.0)


@pytest.mark.parametrize("speed", [0.5, 0.9, 1.3])
def test_step_length_and_cadence_follow_the_speed_at_a_constant_ratio(speed):
    places, times = footfalls(*walk(np.tile([speed, 0.0], (800, 1)))[:2])
    steps, intervals = np.diff(places[4:, 0]), np.diff(times[4:])
    assert steps.mean() == pytest.approx(np.sqrt(RATIO * speed), rel=0.04)
    assert steps.mean() / intervals.mean() == pytest.approx(speed, rel=0.04)


def test_feet_land_symmetrically_about_the_body():
    feet, _, bodies = walk(np.tile([1.0, 0.0], (800, 1)))
    assert (feet[200:, :, 0].mean(axis=1) - bodies[200:, 0]).mean() == pytest.approx(0.0, abs=0.03)
    assert feet[200:, 0, 1] == pytest.approx(HALF, abs=0.01)


def test_who_stops_brings_the_feet_together_and_stands():
    feet, lift, bodies = walk(np.concatenate((np.tile([1.0, 0.0], (200, 1)), np.zeros((200, 2)))))
    assert np.all(lift[-40:] == 0.0)
    assert np.abs(feet[-1, :, 0] - bodies[-1, 0]).max() < 0.12


def test_legs_do_not_pass_through_each_other_in_a_turn():
    way = 2.0 * np.arange(400) * DT
    velocity = 0.6 * np.stack((np.cos(way), np.sin(way)), axis=-1)
    feet, _, _ = walk(velocity, turn_rate=2.0)
    assert np.hypot(*(feet[:, 0] - feet[:, 1]).T).min() > 2.0 * LEG


def test_thighs_and_shins_join_at_the_knees_and_keep_their_length():
    feet, lift, bodies = walk(np.tile([1.1, 0.0], (300, 1)))
    mocap, quaternion, legs = np.zeros((6, 3)), np.zeros((6, 4)), np.zeros((1, 2, 2))
    for heading in (0.0, np.pi - 1e-9, -2.0):
        for foot, height, body in zip(feet[100:140], lift[100:140], bodies[100:140], strict=True):
            turn = np.array([[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]])
            rotated = foot @ turn.T
            pose_bodies((turn @ body)[None], np.array([heading]), SIZE, rotated[None], height[None], 0.2, mocap,
                        quaternion, legs)  # fmt: skip
            assert np.linalg.norm(quaternion, axis=1) == pytest.approx(1.0)
            for side in range(2):
                thigh, shin = _axis(quaternion[2 + 2 * side]), _axis(quaternion[3 + 2 * side])
                knee = mocap[3 + 2 * side] + shin * SHIN / 2.0
                assert mocap[2 + 2 * side] - thigh * THIGH / 2.0 == pytest.approx(knee, abs=0.01)
                ankle = mocap[3 + 2 * side] - shin * SHIN / 2.0
                assert ankle == pytest.approx([*rotated[side], ANKLE + height[side]], abs=1e-6)
                assert legs[0, side] == pytest.approx((ankle + shin * (0.2 - ankle[2]) / shin[2])[:2], abs=1e-6)
    assert abs(mocap[0, 2] - ANKLE - THIGH - SHIN) < 0.15
    assert HIP_HALF_WIDTH < HALF


def _axis(quaternion):
    w, x, y, z = quaternion
    return np.array([2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)])
