"""Learned followers without torch: steering, what the network is told, the network in numpy, the shipped policy."""

import io
import json
from dataclasses import replace

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tagalong.agents import make_follower
from tagalong.agents.learned.features import FeatureConfig, Features
from tagalong.agents.learned.follower import SHIPPED, LearnedFollower, load_policy
from tagalong.agents.learned.guard import Guard, GuardConfig
from tagalong.agents.learned.network import Network
from tagalong.agents.learned.pilot import PilotConfig
from tagalong.agents.learned.steering import REST, SteeringConfig, steer, steer_many
from tagalong.agents.learned.trail import Trail
from tagalong.envs import rollout
from tagalong.envs.task import FollowInterface
from tagalong.slam import InputError

CONFIG = SteeringConfig()
wishes = st.lists(st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0)), min_size=1, max_size=40)


def observation(beams=1081, leader=(1.5, 0.2, 0.6, 0.0, 0.9, 1.0), scan=0.1):
    return {
        "scan": np.full(beams, scan, dtype=np.float32),
        "leader": np.array(leader, dtype=np.float32),
        "people": np.zeros((6, 6), dtype=np.float32),
        "velocity": np.array((0.5, 0.1), dtype=np.float32),
    }


def interface(beams=1081):
    return FollowInterface(bearings=np.deg2rad(np.linspace(-135.0, 135.0, beams)))


@given(st.floats(-0.4, 1.3), st.floats(-1.6, 1.6))
def test_output_is_the_inverse_of_wish(speed, turn):
    assert CONFIG.wish(CONFIG.output(speed, turn)) == pytest.approx((speed, turn), abs=1e-9)


@given(wishes)
def test_commands_keep_their_limits_whatever_is_wished(outputs):
    state = REST
    for output in outputs:
        before, state = state, steer(state, *CONFIG.wish(output), 0.1, CONFIG)
        assert -CONFIG.reverse_speed <= state[0] <= CONFIG.max_speed
        assert abs(state[2]) <= CONFIG.max_turn_rate
        assert abs(state[1]) <= CONFIG.braking + 1e-9
        assert abs(state[1] - before[1]) <= CONFIG.brake_jerk * 0.1 + 1e-9
        assert abs(state[0] - before[0]) <= CONFIG.braking * 0.1 + 1e-9


def test_a_kept_wish_is_reached():
    state = REST
    for _ in range(60):
        state = steer(state, 0.8, -0.5, 0.1, CONFIG)
    assert state == pytest.approx((0.8, 0.0, -0.5, 0.0), abs=0.01)


@settings(max_examples=20, deadline=None)
@given(wishes)
def test_the_teacher_thinks_ahead_with_the_very_steering_that_drives(outputs):
    from tagalong.agents.learned.braking import next_commands

    state, table = REST, np.array(CONFIG.as_tuple())
    for speed, turn in outputs:
        state = steer(state, speed, turn, 0.1, CONFIG)
        # the kernel from the same state before gives the same state after
    again = REST
    for speed, turn in outputs:
        again = next_commands(*again, speed, turn, 0.1, table)
    assert again == pytest.approx(state, abs=1e-9)


def test_the_trail_stays_where_the_leader_walked_while_the_robot_drives():
    trail = Trail()
    for k in range(20):
        trail.update((0.5, 0.0, 0.0), 0.1, (1.0 + 0.05 * k, 0.0))  # leader at 1.0 m/s, robot at 0.5, straight on
    assert trail.ahead(np.array([0.3])) == pytest.approx(
        np.array([[0.3 + trail.ahead(np.zeros(1))[0, 0], 0.0]]), abs=0.02
    )
    trail.update((0.0, 0.0, np.pi / 2.0 / 0.1), 0.1, None)  # the robot turns left: the trail is on its right
    assert trail.ahead(np.array([0.4]))[0] == pytest.approx(
        (0.0, -1.0 * np.hypot(*trail.ahead(np.array([0.4]))[0])), abs=1e-6
    )


def test_a_leader_who_is_seen_again_elsewhere_begins_a_new_trail():
    trail = Trail()
    for k in range(8):
        trail.update((0.0, 0.0, 0.0), 0.1, (1.0 + 0.15 * k, 0.0))
    trail.update((0.0, 0.0, 0.0), 0.1, None)
    trail.update((0.0, 0.0, 0.0), 0.1, (2.05, 0.9))  # a gap that may have been walked
    assert len(trail.points) > 5
    trail.update((0.0, 0.0, 0.0), 0.1, (-0.5, 2.0))
    assert trail.points == pytest.approx(np.array([[-0.5, 2.0]]))


@pytest.mark.parametrize("beams", [360, 1081])
def test_features_are_finite_and_of_the_shapes_that_are_promised(beams):
    config = FeatureConfig()
    features = Features(config, interface(beams))
    told = features.update(observation(beams), REST)
    assert {name: value.shape for name, value in told.items()} == config.shapes
    assert all(np.isfinite(value).all() and value.dtype == np.float32 for value in told.values())
    named = dict(zip(config.vector_names, told["vector"].tolist(), strict=True))
    assert named["leader x"] == pytest.approx(0.5)
    assert named["leader seen"] == 1.0
    assert named["forward"] == pytest.approx(0.5)


def test_a_sector_tells_its_nearest_return_whatever_the_number_of_beams():
    for beams in (360, 1081):
        scan = np.full(beams, 0.1, dtype=np.float32)
        scan[beams // 2] = 0.02  # 0.6 m straight ahead
        told = Features(FeatureConfig(), interface(beams)).update({**observation(beams), "scan": scan}, REST)["scan"]
        assert told[0].argmin() in (44, 45)
        assert told[0].min() == pytest.approx(0.6 / 6.0)


def test_a_lost_leader_is_taken_to_be_where_the_tracker_predicts_it():
    features = Features(FeatureConfig(), interface())
    features.update(observation(), REST)
    for _ in range(10):
        features.update(observation(leader=(0.4, 2.0, 0.0, 0.0, 0.0, 0.0)), REST)
    assert (features.goal.x, features.goal.y) == pytest.approx((0.4, 2.0))


def test_features_share_no_memory_between_steps():
    features = Features(FeatureConfig(), interface())
    first = features.update(observation(), REST)
    kept = {name: value.copy() for name, value in first.items()}
    features.update(observation(leader=(2.0, -0.4, 0.1, 0.2, 0.5, 1.0), scan=0.05), REST)
    assert all((first[name] == kept[name]).all() for name in kept)


def tiny_arrays(rng, recurrent=False):
    shapes = {
        "scan.mean": (2, 9), "scan.deviation": (2, 9), "vector.mean": (3,), "vector.deviation": (3,),
        "scan.0.weight": (4, 2, 3), "scan.0.bias": (4,), "dense.0.weight": (5, 19), "dense.0.bias": (5,),
        "output.weight": (2, 5), "output.bias": (2,),
    }  # fmt: skip
    if recurrent:
        shapes |= {"lstm.input.weight": (20, 5), "lstm.hidden.weight": (20, 5)}
        shapes |= {"lstm.input.bias": (20,), "lstm.hidden.bias": (20,)}
    arrays = {name: rng.normal(size=shape).astype(np.float32) for name, shape in shapes.items()}
    return {**arrays, "scan.deviation": np.ones((2, 9)), "vector.deviation": np.ones(3), "squash": np.zeros(())}


def test_the_network_convolves_as_sums_by_hand_do():
    rng = np.random.default_rng(0)
    a = tiny_arrays(rng)
    scan, vector = rng.normal(size=(2, 9)).astype(np.float32), rng.normal(size=3).astype(np.float32)
    normal = scan - a["scan.mean"]
    by_hand = np.zeros((4, 4))
    for out in range(4):
        for k in range(4):
            by_hand[out, k] = (a["scan.0.weight"][out] * normal[:, 2 * k : 2 * k + 3]).sum() + a["scan.0.bias"][out]
    joined = np.concatenate((np.maximum(by_hand, 0.0).ravel(), vector - a["vector.mean"]))
    hidden = np.tanh(a["dense.0.weight"] @ joined + a["dense.0.bias"])
    wanted = np.clip(a["output.weight"] @ hidden + a["output.bias"], -1.0, 1.0)
    assert Network(a)({"scan": scan, "vector": vector}) == pytest.approx(wanted, abs=1e-5)


def test_a_recurrent_network_remembers_until_reset():
    rng = np.random.default_rng(1)
    network = Network(tiny_arrays(rng, recurrent=True))
    inputs = {"scan": np.ones((2, 9), dtype=np.float32), "vector": np.ones(3, dtype=np.float32)}
    first, second = network(inputs), network(inputs)
    assert not np.allclose(first, second)
    network.reset()
    assert (network(inputs) == first).all()


def test_a_policy_that_is_not_there_or_does_not_fit_is_refused(tmp_path):
    with pytest.raises(InputError, match="shipped one"):
        LearnedFollower(policy="nobody")
    (tmp_path / "policy.npz").write_bytes((SHIPPED / "follower.npz").read_bytes())
    (tmp_path / "policy.json").write_text("{}")
    with pytest.raises(InputError, match="does not fit"):
        make_follower(str(tmp_path))


def test_a_laser_that_ends_a_little_later_is_the_same():
    bearings = np.deg2rad(np.arange(-135.0, 134.8, 0.36))
    assert LearnedFollower(FollowInterface(bearings=bearings)).act(observation(len(bearings))).shape == (2,)


def damaged(kind):
    """The bytes of a policy's weights, damaged."""
    whole = (SHIPPED / "follower.npz").read_bytes()
    if kind in ("empty", "cut"):
        return whole[: 0 if kind == "empty" else len(whole) // 2]
    if kind == "a byte":
        return whole[: len(whole) // 2] + bytes([whole[len(whole) // 2] ^ 255]) + whole[len(whole) // 2 + 1 :]
    arrays = dict(np.load(SHIPPED / "follower.npz"))
    if kind == "missing":
        del arrays["vector.deviation"]
    else:
        arrays["dense.0.bias"] = np.nan * arrays["dense.0.bias"]
    file = io.BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        ("empty", "no readable npz file"),
        ("cut", "no readable npz file"),
        ("a byte", "no readable npz file"),
        ("missing", "array vector.deviation is missing"),
        ("nan", "array dense.0.bias has values that are not finite numbers"),
    ],
)
def test_a_damaged_policy_is_refused_in_one_line(tmp_path, kind, said):
    (tmp_path / "policy.npz").write_bytes(damaged(kind))
    (tmp_path / "policy.json").write_bytes((SHIPPED / "follower.json").read_bytes())
    with pytest.raises(InputError, match=said):
        LearnedFollower(None, tmp_path)


def test_the_shipped_policy_is_small_and_its_card_tells_what_a_user_must_know():
    assert sum(file.stat().st_size for file in SHIPPED.glob("follower.*")) < 1_500_000
    card = json.loads((SHIPPED / "follower.json").read_text())
    assert {"data", "command", "seed", "suites", "limits", "pilot", "evaluation"} <= set(card)


def test_the_shipped_card_says_what_surrounds_the_network_now():
    config = load_policy("follower")[1]
    assert config == replace(PilotConfig(), features=config.features)


def test_the_shipped_policy_says_the_same_through_onnx():
    runtime = pytest.importorskip("onnxruntime")
    arrays, config = load_policy("follower")
    session, network = runtime.InferenceSession(str(SHIPPED / "follower.onnx")), Network(arrays)
    rng = np.random.default_rng(2)
    for _ in range(50):
        inputs = {name: rng.normal(size=shape).astype(np.float32) for name, shape in config.features.shapes.items()}
        (batch,) = session.run(["action"], {name: value[None] for name, value in inputs.items()})
        assert batch[0] == pytest.approx(network(inputs), abs=1e-5)


def test_the_shipped_policy_follows_its_leader_through_the_corridor_with_half_of_pids_jerk():
    env = gym.make("tagalong/Corridor-v0", slam=None, people_count=1)
    drivers = {name: make_follower(name, env.unwrapped.interface) for name in ("learned", "pid")}
    episodes = {name: [rollout(env, one, seed=seed) for seed in (3, 4, 5)] for name, one in drivers.items()}
    assert all(episode.ending == "tour_done" for episode in episodes["learned"])
    jerk = {name: np.mean([one.metrics["jerk_rms_mps3"] for one in part]) for name, part in episodes.items()}
    assert jerk["learned"] < 0.5 * jerk["pid"]


def look(wishes, points=(), people=()):
    from tagalong.agents.training.teacher_kernel import look_ahead

    return look_ahead(
        np.array(REST),
        np.array(wishes, dtype=np.float64),
        np.tile((1.0, 0.0), (10, 1)),
        np.array(points, dtype=np.float64).reshape(-1, 2),
        np.array(people, dtype=np.float64).reshape(-1, 6),
        np.array(CONFIG.as_tuple()),
        np.array((0.275, 0.26, 0.377)),
        np.array((3.0, 0.0)),
        np.array((1.0, 0.0, 0.0, 1.0, 0.2, 1.0, 0.0, 10.0)),
        0.1,
        7,
    )


def test_the_teacher_counts_the_way_to_its_place_things_and_people_as_sums_by_hand_do():
    wish = (0.7, 0.0, 0.0)
    state, path = REST, []
    for _ in range(20):
        state = steer(state, 0.7, 0.0, 0.1, CONFIG)
        path.append(state[0] * 0.1 + (path[-1] if path else 0.0))
    places = np.array(path[1::2])
    later = 1.0 - 0.05 * np.arange(10)
    far = np.abs(places - 1.0).mean()
    assert look([wish])[0] == pytest.approx(far)
    gap = np.clip(1.5 - places - 0.275, 0.0, 0.2)  # a thing straight ahead, 1.5 m away
    thing = ((1.0 - gap / 0.2) ** 2 * later).max() + 10.0 * (later * (gap < 0.03)).max()
    assert look([wish], points=[(1.5, 0.0)])[0] == pytest.approx(far + thing)
    space = np.hypot(0.5 - places, 1.2) - 0.25 - 0.377  # somebody who stands beside the way
    lack = (np.maximum(1.0 - space / 0.75, 0.0) * later).max()
    assert look([wish], people=[(0.5, 1.2, 0.0, 0.0, 0.25, 0.75)])[0] == pytest.approx(far + lack)


@given(wishes)
def test_many_are_steered_as_one_is(outputs):
    states = [steer(REST, *CONFIG.wish(output), 0.1, CONFIG) for output in outputs]
    targets = np.array([CONFIG.wish(output) for output in reversed(outputs)])
    many = steer_many(np.array(states), targets, 0.1, CONFIG)
    ones = [steer(state, *target, 0.1, CONFIG) for state, target in zip(states, targets.tolist(), strict=True)]
    assert many == pytest.approx(np.array(ones), abs=1e-12)


def scan_of_wall(pose, wall_x):
    """What the laser measures of a wall at x = wall_x, from a robot at `pose` (x, y, theta)."""
    scales = interface(360)
    bearings = scales.bearings + pose[2]
    x = pose[0] + 0.1 * np.cos(pose[2])
    with np.errstate(divide="ignore"):
        ranges = np.where(np.cos(bearings) > 1e-3, (wall_x - x) / np.cos(bearings), np.inf)
    return {**observation(360), "scan": np.minimum(ranges / 30.0, 1.0).astype(np.float32)}


@pytest.mark.parametrize("wish", [(1.3, 0.0), (1.0, 0.4), (0.6, -1.2), (-0.4, 1.6)])
def test_whoever_wishes_into_a_wall_is_stopped_before_it(wish):
    guard, pose, state, nearest = Guard(GuardConfig(), CONFIG, interface(360)), np.zeros(3), REST, np.inf
    corners = np.array([(x, y) for x in (-0.275, 0.275) for y in (-0.259, 0.259)])
    for _ in range(80):
        velocity = np.array((state[0], state[2]), dtype=np.float32)
        guard.observe({**scan_of_wall(pose, 1.6), "velocity": velocity})
        state = steer(state, *guard.limit(state, wish), 0.1, CONFIG)
        pose = pose + 0.1 * np.array((state[0] * np.cos(pose[2]), state[0] * np.sin(pose[2]), state[2]))
        reach = pose[0] + (corners * (np.cos(pose[2]), -np.sin(pose[2]))).sum(axis=1)
        nearest = min(nearest, 1.6 - reach.max())
    assert nearest > 0.0


def test_the_guard_leaves_a_wish_alone_where_nothing_is_near():
    guard = Guard(GuardConfig(), CONFIG, interface())
    guard.observe(observation(scan=0.5))
    assert guard.limit((1.0, 0.0, 0.3, 0.0), (1.3, -0.7)) == (1.3, -0.7)


def test_the_guard_remembers_what_the_laser_has_lost_behind_it():
    scan = np.ones(1081, dtype=np.float32)
    scan[10:40] = 0.4 / 30.0  # a post aft on the right
    guard = Guard(GuardConfig(), CONFIG, interface())
    still = {**observation(), "velocity": np.zeros(2, dtype=np.float32)}
    guard.observe({**still, "scan": scan})
    turned = {**observation(), "velocity": np.array((0.0, 6.0), dtype=np.float32)}
    guard.observe({**turned, "scan": np.ones(1081, dtype=np.float32)})  # 0.6 rad to the left: the post is out of sight
    assert guard.limit(REST, (-0.4, 0.0)) != (-0.4, 0.0)
    guard.reset()
    for velocity in [(0.0, 0.0), *[(1.0, 0.0)] * 10]:  # where it has come forward, it may back
        moving = {**still, "velocity": np.array(velocity, dtype=np.float32)}
        guard.observe({**moving, "scan": np.ones(1081, dtype=np.float32)})
    assert guard.limit(REST, (-0.4, 0.0)) == (-0.4, 0.0)
