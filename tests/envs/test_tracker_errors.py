"""People known with the errors of a tracker, by a model of them."""

import json

import gymnasium as gym
import numpy as np
import pytest
from tagalong.envs.tracker_errors import kernel
from tagalong.envs.tracker_errors.errors import BORN, MISSED, PLACE, SHIPPED, chosen_errors, from_named, named
from tagalong.slam import InputError

OPEN = np.full(360, np.inf)
SPACING = np.radians(270.0) / 359
LASER = (0.1, 0.0, -np.radians(135.0), SPACING)


def tracked(position, velocity, steps=400, ranges=OPEN, seed=1, **changed):
    """Tracks (steps, 2 n + 1, COLUMNS) of people who are seen from the origin."""
    errors = chosen_errors("shipped")._replace(**changed)
    tracks, random = np.zeros((kernel.rows_for(len(position)), kernel.COLUMNS)), np.array([seed], dtype=np.uint64)
    kernel.forget(tracks)
    told = []
    for k in range(steps):
        kernel.track_people(
            0.1 * (k > 0), np.zeros(3), np.array(position), np.array(velocity), ranges, LASER, errors, random, tracks
        )
        told.append(tracks.copy())
    return np.array(told)


def test_nobody_is_known_in_the_first_scan_and_who_walks_nearby_soon_is():
    tracks = tracked([[1.5, 0.0]], [[0.0, 1.0]])
    assert tracks[0, 0, kernel.PHASE] == kernel.UNKNOWN
    assert (tracks[30:, 0, kernel.PHASE] == kernel.SEEN).mean() > 0.8


def first_known_s(velocity, drives=200, steps=100):
    """When each of `drives` people at 1.4 m, who begin to walk after 2 s, is first known [s]."""
    errors, first = chosen_errors("shipped"), []
    for seed in range(drives):
        tracks, random = np.zeros((3, kernel.COLUMNS)), np.array([seed * 7919], dtype=np.uint64)
        kernel.forget(tracks)
        place, motion = np.array([[1.4, 0.0]]), np.zeros((1, 2))
        for k in range(steps):
            motion[0] = velocity if k > 20 else 0.0
            place = place + 0.1 * motion * (k > 0)
            dt = 0.1 * (k > 0)
            kernel.track_people(dt, np.zeros(3), place, motion, OPEN, LASER, errors, random, tracks)
            if tracks[0, kernel.PHASE] != kernel.UNKNOWN:
                first.append(0.1 * k - 2.0)
                break
    return np.array(first)


def test_who_walks_is_known_sooner_than_who_stands_and_who_has_come_far_soonest():
    standing, walking = first_known_s((0.0, 0.0)), first_known_s((0.0, 1.0))
    assert (walking < 1.0).mean() > 0.9 > 0.8 > (standing < 1.0).mean()
    errors, near = chosen_errors("shipped"), np.array([1.4, 0.0])
    sight = kernel.seen(near, 1.0, np.zeros(3), OPEN, LASER)
    rates = [kernel.quantity(BORN, errors, sight, 0.0, 0.0, way) for way in (0.0, 0.2, 0.5)]
    assert rates[0] < rates[1] < rates[2]


def test_a_way_is_what_was_come_in_sight_and_no_longer_than_a_stride():
    way, hidden, half = np.zeros(2), (2.0, 1.0, 1.0, 1.0, 0.0, 0.5), (2.0, 1.0, 0.5, 0.0, 0.0, 0.5)
    sight = kernel.seen(np.array([1.4, 0.0]), 1.0, np.zeros(3), OPEN, LASER)
    kernel.come_on(way, np.array([1.0, 0.0]), sight, 0.1)
    assert way == pytest.approx([0.1, 0.0])
    kernel.come_on(way, np.array([0.0, 1.0]), hidden, 0.1)
    assert way == pytest.approx([0.1, 0.0])
    kernel.come_on(way, np.array([1.0, 0.0]), half, 0.1)
    assert way == pytest.approx([0.15, 0.0])
    for _ in range(20):
        kernel.come_on(way, np.array([1.0, 0.0]), sight, 0.1)
    assert way == pytest.approx([kernel.WAY_M, 0.0])


def test_who_was_seen_for_long_is_missed_more_seldom():
    errors = chosen_errors("shipped")
    sight = kernel.seen(np.array([1.4, 0.0]), 1.0, np.zeros(3), OPEN, LASER)
    times = np.array([kernel.quantity(MISSED, errors, sight, 0.05, kernel.seen_for(t)) for t in (0.0, 1.0, 10.0, 99.0)])
    assert (np.diff(times) < 0.0).all()


def test_who_is_behind_a_wall_is_not_met():
    assert (tracked([[3.0, 0.0]], [[0.0, 1.0]], ranges=np.full(360, 1.0))[:, 0, kernel.PHASE] > 0.0).mean() < 0.05


@pytest.mark.parametrize(("bearing", "hidden"), [(0.0, 0.0), (2.0, 0.0), (3.1, 1.0)])
def test_beams_behind_the_robot_see_nobody(bearing, hidden):
    assert kernel.hidden_share(2.0, bearing, OPEN, LASER[2], SPACING) == hidden


def test_half_of_somebody_is_hidden_by_what_stands_before_that_half():
    ranges = np.where(np.arange(360) < 180, 1.0, np.inf)
    assert kernel.hidden_share(3.0, 0.0, ranges, LASER[2], SPACING) == pytest.approx(0.5, abs=0.1)


def test_places_of_who_is_seen_are_off_as_the_numbers_say():
    errors = chosen_errors("shipped")
    tracks = tracked([[2.0, 0.0]], [[0.0, 1.0]], steps=20_000)[:, 0]
    seen = tracks[tracks[:, kernel.PHASE] == kernel.SEEN]
    sight = kernel.seen(np.array([2.0, 0.0]), 1.0, np.zeros(3), OPEN, LASER)
    off = seen[:, kernel.X : kernel.Y + 1] - (2.0, -errors.delay_s)
    assert off.mean(axis=0) == pytest.approx(0.0, abs=0.01)
    assert off.std(axis=0) == pytest.approx(kernel.quantity(PLACE, errors, sight, 0.0, 0.0), rel=0.05)
    assert seen[:, kernel.VY].std() == pytest.approx(errors.motion_mps, rel=0.05)


def test_two_who_meet_are_taken_for_each_other_and_for_who_they_are_again():
    places = [[1.5, 0.3], [1.5, -0.3]]
    body = tracked(places, np.ones((2, 2)), 4000, swap_per_s=1.0, swapped_s=0.5)[:, :2, kernel.BODY]
    assert set(map(tuple, body.tolist())) <= {(0.0, 1.0), (1.0, 0.0)}
    assert 100 < np.abs(np.diff(body[:, 0])).sum() < 4000


def test_a_thing_is_taken_for_a_person_where_a_beam_ends():
    tracks = tracked(np.zeros((0, 2)), np.zeros((0, 2)), 2000, np.full(360, 2.0), thing_per_s=0.5, thing_life_s=1.0)
    there = tracks[:, 0, kernel.PHASE] == kernel.SEEN
    assert 0.1 < there.mean() < 0.6
    apart = np.hypot(*(tracks[there, 0, kernel.X : kernel.Y + 1] - (LASER[0], 0.0)).T)
    assert apart == pytest.approx(2.0)


def drive(env, steps, seed=3):
    first, _ = env.reset(seed=seed)
    return [first, *(env.step(np.array([0.3, 0.1]))[0] for _ in range(steps))]


def test_both_simulators_know_people_by_the_model():
    given = {"people": "modelled", "people_count": 3, "beams": 90}
    one = gym.make("tagalong/Corridor-v0", disable_env_checker=True, slam=None, **given)
    ours, again = drive(one, 30), drive(one, 30)
    assert all(np.array_equal(a[key], b[key]) for a, b in zip(ours, again, strict=True) for key in a)
    assert ours[0]["leader"].tolist() == [0.0] * 6
    many = gym.make_vec(
        "tagalong/Corridor-v0", 4, "vector_entry_point", simulator="compiled", workers=1, episodes_ahead=4, **given
    )
    many.reset(seed=0)
    for _ in range(30):
        observation, *_ = many.step(np.tile([0.3, 0.1], (4, 1)))
    assert many.observation_space.contains(observation)
    trust = observation["leader"][:, 4]
    assert ((trust >= 0.0) & (trust < 1.0)).all()


def test_the_shipped_file_says_how_it_was_made_and_is_read_again():
    card = json.loads(SHIPPED.read_text(encoding="utf-8"))
    assert card["command"].startswith("tagalong train tracker-errors ")
    assert named(from_named(card["errors"], SHIPPED)) == card["errors"]


@pytest.mark.parametrize("text", ["", "[]", '{"errors": {}}', '{"errors": {"weights": 3}}'])
def test_a_file_that_holds_something_else_is_refused(tmp_path, text):
    path = tmp_path / "errors.json"
    path.write_text(text)
    with pytest.raises(InputError, match="errors"):
        gym.make("tagalong/Corridor-v0", people="modelled", tracker_errors=str(path))


def test_times_must_be_positive():
    table = named(chosen_errors("shipped"))
    with pytest.raises(InputError, match="`place_s` must be positive"):
        from_named({**table, "place_s": 0.0}, "here")


def test_nobody_is_new_in_the_model_so_who_is_lost_is_no_other_one_later():
    given = {
        "simulator": "compiled",
        "people": "modelled",
        "people_count": 12,
        "beams": 120,
        "episodes_ahead": 16,
        "lost_limit_s": 99.0,
    }
    env = gym.make_vec("tagalong/Office-v0", 16, "vector_entry_point", autoreset_mode="Disabled", **given)
    env.reset(seed=5)
    followed, known, lost = np.full(16, -1), np.zeros(16, int), 0
    for _ in range(300):  # whoever stands still loses its leader
        *_, info = env.step(np.zeros((16, 2), np.float32))
        who, known = info["leader_id"], known + ((info["leader_id"] >= 0) | (known > 0))
        chosen = known > 15  # the choice may change for a second
        followed = np.where(chosen, followed, who)
        assert (who == followed)[chosen & (who >= 0) & (followed >= 0)].all()
        lost += np.count_nonzero(chosen & (who < 0))
    assert lost > 100
    env.close()
