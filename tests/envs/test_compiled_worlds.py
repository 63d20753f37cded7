"""Compiled worlds: what MuJoCo's worlds do, in arrays; the same bytes however they are grouped."""

import gymnasium as gym
import numba
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from tagalong.envs import FollowEnv
from tagalong.envs.compiled.rules import compiled_config, make_rules
from tagalong.envs.scenes import make_scene
from tagalong.perception import perception_preset
from tagalong.slam import InputError

EXACT = {
    "lidar.sigma_near": 0.0,
    "lidar.sigma_far": 0.0,
    "lidar.dropout": 0.0,
    "odometry": "perfect",
    "people": "truth",
    "slam": None,
    "ends_on_contact": False,
    "beams": 720,
}
SCENES = {
    "Corridor": {"people_count": 3},
    "FloorPlan": {"people_count": 5},
    "Lab": {},
    "Landmarks": {"field_of_view": 3.1, "robot": "dingo-o"},
    "MeetingRoom": {"standing": 1},
    "Office": {"people_count": 7, "split": "test"},
    "PlainCorridor": {"control_hz": 5.0},
}


def compiled(name="Corridor", worlds=3, **arguments):
    given = {"workers": 1, "episodes_ahead": 8, "beams": 90, "people_count": 3, **arguments}
    return gym.make_vec(f"tagalong/{name}-v0", worlds, "vector_entry_point", simulator="compiled", **given)


def terms_in(info):
    """The terms of the reward, without their masks."""
    return {name: values for name, values in info["reward_terms"].items() if not name.startswith("_")}


def of_all_facts(facts):
    """A term that no fact of a step may be wrong for."""
    flags = facts.following_leader + 2.0 * facts.collided + 4.0 * facts.tour_done
    space = min(facts.bystander_space, 20.0)
    return facts.distance + 10.0 * facts.bearing + 0.1 * space + facts.action_change + flags + facts.step_s


@pytest.mark.parametrize("name", SCENES)
def test_a_drive_is_that_of_mujoco(name):
    fields = {**EXACT, **SCENES[name], "reward.terms": {"mine": of_all_facts}}
    many = compiled(name, 1, **{"people_count": 2, **fields}, own_start=True)
    one = gym.make(f"tagalong/{name}-v0", disable_env_checker=True, **fields)
    got, told = many.reset(seed=4)
    wanted, info = one.reset(seed=4)
    inner, rng, compared = one.unwrapped, np.random.default_rng(0), 0
    assert isinstance(inner, FollowEnv)
    for _ in range(50 if fields.get("control_hz") is None else 25):
        touched = inner.truth.contact_person or inner.truth.contact_static
        assert told["reward_terms"]["collision"][0] == info["reward_terms"]["collision"]
        if touched:
            break
        compared += 1
        assert np.abs(got["scan"][0] - wanted["scan"]).max() * many.interface.range_max < 1e-3
        assert np.hypot(*(told["robot_pose"][0] - info["robot_pose"])[:2]) < 0.01
        for key in ("leader", "people", "velocity"):
            assert got[key][0] == pytest.approx(wanted[key], abs=1e-3)
        for key in ("leader_distance", "lost_s", "leader_id", "following_leader", "tracked_people", "time_s"):
            assert float(told[key][0]) == pytest.approx(float(info[key]), abs=1e-6), key
        for term, value in info["reward_terms"].items():
            assert told["reward_terms"][term][0] == pytest.approx(value, abs=1e-4)
        action = rng.uniform(-0.5, 1.0, many.single_action_space.shape).astype(np.float32)
        got, reward, *_, told = many.step(action[None])
        wanted, *_, info = one.step(action)
        assert reward[0] == pytest.approx(sum(values[0] for values in terms_in(told).values()), abs=1e-9)
    assert compared > 10
    many.close()


def test_the_real_tracker_knows_the_same_in_both_simulators():
    fields = {**EXACT, "people": "tracker", "people_count": 3, "beams": 360}
    many = compiled("Corridor", 1, own_start=True, **fields)
    one = gym.make("tagalong/Corridor-v0", disable_env_checker=True, **fields)
    got, told = many.reset(seed=4)
    wanted, info = one.reset(seed=4)
    known = 0
    for _ in range(40):
        for key in ("leader", "people"):
            assert got[key][0] == pytest.approx(wanted[key], abs=0.02)
        for key in ("leader_id", "following_leader", "tracked_people"):
            assert told[key][0] == info[key], key
        known += int(info["following_leader"])
        got, *_, told = many.step(np.array([[0.4, 0.0]], dtype=np.float32))
        wanted, *_, info = one.step(np.array([0.4, 0.0], dtype=np.float32))
    assert known > 5
    many.close()


def test_a_push_against_a_wall_ends_where_mujoco_ends_it():
    fields = {**EXACT, "people_count": 1, "lost_limit_s": 1e6}
    many = compiled("PlainCorridor", 1, own_start=True, **fields)
    one = gym.make("tagalong/PlainCorridor-v0", disable_env_checker=True, **fields)
    many.reset(seed=0)
    one.reset(seed=0)
    pressed = 0
    for k in range(60):
        action = np.array([1.0, 0.5 if k < 12 else 0.0], dtype=np.float32)
        *_, told = many.step(action[None])
        *_, info = one.step(action)
        pressed += info["reward_terms"]["collision"] < 0.0
        gap = told["robot_pose"][0] - info["robot_pose"]
        assert np.hypot(gap[0], gap[1]) < 0.02
    assert pressed > 20
    many.close()


def played(env, steps, seed=7, columns=slice(None)):
    """All that is told in `steps` steps, of the worlds `columns`, as bytes."""
    observation, info = env.reset(seed=seed)
    rng, bytes_ = np.random.default_rng(0), []
    actions = rng.uniform(-1.0, 1.0, (steps, 6, 2))[:, columns]
    for action in actions:
        bytes_ += [np.ascontiguousarray(observation[key]).tobytes() for key in sorted(observation)]
        bytes_.append(np.ascontiguousarray(info["robot_pose"]).tobytes())
        observation, reward, _, _, info = env.step(action)
        bytes_.append(reward.tobytes())
    env.close()
    return bytes_


KNOWN = pytest.mark.parametrize("people", ["truth", "modelled", "tracker"])


@KNOWN
def test_the_same_bytes_for_any_number_of_workers(people):
    options = {"max_episode_steps": 30, "people": people}
    assert played(compiled(worlds=6, **options), 50) == played(compiled(worlds=6, workers=3, **options), 50)


@KNOWN
def test_a_world_plays_the_same_beside_any_others(people):
    options = {"max_episode_steps": 30, "people": people}
    whole = compiled(worlds=6, **options)
    part = compiled(worlds=2, **options)
    whole.reset(seed=7)
    part.reset(seed=11)
    rng = np.random.default_rng(0)
    for _ in range(50):
        actions = rng.uniform(-1.0, 1.0, (6, 2))
        of_whole, of_part = whole.step(actions), part.step(actions[4:])
        for key in of_part[0]:
            assert of_whole[0][key][4:].tobytes() == of_part[0][key].tobytes()
        assert of_whole[1][4:].tobytes() == of_part[1].tobytes()


def test_worlds_of_an_own_start_begin_as_the_single_environments_of_their_seeds():
    many = compiled("Office", 2, own_start=True, **{**EXACT, "beams": 90})
    observation, info = many.reset(seed=20)
    for i in range(2):
        one = gym.make("tagalong/Office-v0", disable_env_checker=True, **{**EXACT, "beams": 90, "people_count": 3})
        wanted, told = one.reset(seed=20 + i)
        assert info["robot_pose"][i] == pytest.approx(told["robot_pose"])
        assert observation["people"][i] == pytest.approx(wanted["people"], abs=1e-4)


def test_another_seed_is_another_episode_and_the_same_seed_the_same():
    env = compiled()
    first, again, other = (env.reset(seed=seed)[0]["scan"] for seed in (3, 3, 30))
    assert first.tobytes() == again.tobytes()
    assert first.tobytes() != other.tobytes()


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_ended_episodes_are_followed_as_gymnasium_says(mode):
    env = compiled(autoreset_mode=mode, max_episode_steps=3)
    env.reset(seed=0)
    actions = np.zeros((3, 2))
    for _ in range(2):
        env.step(actions)
    last, _, _, truncated, info = env.step(actions)
    assert truncated.all()
    if mode == AutoresetMode.SAME_STEP:
        assert info["_final_obs"].all()
        assert info["final_info"]["time_s"].tolist() == pytest.approx([0.3] * 3)
        assert info["time_s"].tolist() == [0.0] * 3
        assert not np.array_equal(info["final_obs"][0]["scan"], last["scan"][0])
    elif mode == AutoresetMode.NEXT_STEP:
        _, reward, _, truncated, info = env.step(actions)
        assert not truncated.any()
        assert reward.tolist() == [0.0] * 3
        assert info["time_s"].tolist() == [0.0] * 3
    else:
        with pytest.raises(InputError, match="has ended: reset it first"):
            env.step(actions)
        mask = np.array([True, False, False])
        observation, info = env.reset(options={"reset_mask": mask})
        assert info["_time_s"].tolist() == mask.tolist()
        assert observation["scan"][1].tobytes() == last["scan"][1].tobytes()


@pytest.mark.parametrize("mode", [AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP])
def test_a_term_of_ones_own_is_zero_where_an_episode_begins(mode):
    env = compiled(autoreset_mode=mode, max_episode_steps=3, **{"reward.terms": {"mine": lambda facts: 5.0}})
    _, info = env.reset(seed=0)
    assert info["reward_terms"]["mine"].tolist() == [0.0] * 3
    rewards, told = [], []
    for _ in range(5):
        _, reward, _, _, info = env.step(np.zeros((3, 2)))
        rewards.append(reward - sum(value for name, value in terms_in(info).items() if name != "mine"))
        told.append(info["reward_terms"]["mine"].tolist())
        if "final_info" in info:
            assert info["final_info"]["reward_terms"]["mine"].tolist() == [5.0] * 3
    same = mode == AutoresetMode.SAME_STEP
    assert told == [[5.0] * 3, [5.0] * 3, [0.0] * 3 if same else [5.0] * 3, [5.0 if same else 0.0] * 3, [5.0] * 3]
    if not same:
        assert np.abs(np.array(rewards) - told).max() < 1e-9


def test_a_term_of_ones_own_knows_of_each_contact():
    env = compiled(
        worlds=6, ends_on_contact=False, **{"reward.terms": {"touched": lambda facts: float(facts.collided)}}
    )
    observation, _ = env.reset(seed=0)
    persons, things = 0, 0
    for _ in range(200):  # half of them chase their leaders, half go straight on
        x, y = observation["leader"][:, 0], observation["leader"][:, 1]
        turn = np.where(np.arange(6) < 3, np.clip(2.0 * np.arctan2(y, x), -1.0, 1.0), 0.0)
        observation, *_, info = env.step(np.stack((np.ones(6), turn), axis=1))
        touched = info["reward_terms"]["touched"] > 0.0
        assert (touched == (info["reward_terms"]["collision"] < 0.0)).all()
        persons += int((touched & env._state.touches[:, 0] & ~env._state.touches[:, 1]).sum())
        things += int((touched & env._state.touches[:, 1]).sum())
    assert persons > 0
    assert things > 0


def test_a_term_of_ones_own_that_is_no_number_is_named():
    env = compiled(**{"reward.terms": {"mine": lambda facts: float("nan")}})
    env.reset(seed=0)
    with pytest.raises(InputError, match=r"`reward.terms\['mine'\]` must return a finite number, got nan"):
        env.step(np.zeros((3, 2)))


def test_reset_options_hold_for_one_episode():
    env = compiled(people_count=1, autoreset_mode=AutoresetMode.SAME_STEP, max_episode_steps=2)
    env.reset(seed=0, options={"people": 6, "scene": "doorway"})
    assert env._pool.plans.people[env._state.slot].tolist() == [6] * 3
    for _ in range(2):
        env.step(np.zeros((3, 2)))
    assert env._pool.plans.people[env._state.slot].tolist() == [1] * 3
    with pytest.raises(InputError, match="unknown reset option"):
        env.reset(options={"peple": 2})


def test_what_is_told_lies_in_its_spaces_and_belongs_to_the_caller():
    env = compiled("Office", people_count=None)
    first, _ = env.reset(seed=1)
    kept = {key: value.copy() for key, value in first.items()}
    observation, reward, *_ = env.step(env.action_space.sample())
    assert env.observation_space.contains(observation)
    assert reward.shape == (3,)
    for key in first:
        assert np.array_equal(first[key], kept[key])
    assert env.spec is not None
    assert env.spec.kwargs["max_episode_steps"] == 3000


def form(nest):
    """Names, shapes and types in a nest of dicts and arrays."""
    if isinstance(nest, dict):
        return {name: form(value) for name, value in nest.items()}
    return nest.shape, nest.dtype


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_both_simulators_tell_in_the_same_form(mode):
    ours = compiled(autoreset_mode=mode, max_episode_steps=2)
    theirs = gym.make_vec(
        "tagalong/Corridor-v0", 3, "vector_entry_point", workers=1, beams=90, people_count=3, people="truth", slam=None,
        autoreset_mode=mode, max_episode_steps=2,
    )  # fmt: skip
    assert form(ours.reset(seed=0)[0]) == form(theirs.reset(seed=0)[0])
    assert form(ours.reset(seed=0)[1]) == form(theirs.reset(seed=0)[1])
    assert ours.observation_space == theirs.observation_space
    assert ours.action_space == theirs.action_space
    for _ in range(4):
        got, wanted = ours.step(np.zeros((3, 2))), theirs.step(np.zeros((3, 2)))
        for part, other in zip(got, wanted, strict=True):
            assert form(part) == form(other)
    theirs.close()


@pytest.mark.parametrize(
    ("fields", "named"),
    [
        ({"people": "camera", "camera": "kinect-v2"}, "`people` 'camera'"),
        ({"people": "tracker", "lidar.rate_hz": 40.0}, "`people` 'tracker': with 4 sweeps a step"),
        ({"people": "tracker", "perception": perception_preset("ye2021")}, "`perception.method` 'ye2021'"),
        ({"slam": "gmapping"}, "`slam`"),
        ({"camera": "kinect-v2"}, "`camera`"),
        ({"leader": False}, "`task.leader` False"),
        ({"coverage": True}, "`task.coverage` True"),
        ({"observation.entries": {"mine": (gym.spaces.Box(0, 1), float)}}, "`observation.entries`"),
        ({"render_mode": "rgb_array"}, "`render_mode`"),
        ({"workers": 4}, "`workers`"),
        ({"episodes_ahead": 0}, "`episodes_ahead`"),
        ({"pepole": 3}, "unknown argument"),
    ],
)
def test_what_is_not_supported_is_refused_in_one_line(fields, named):
    with pytest.raises(InputError) as refused:
        compiled(**fields)
    assert named in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_wrong_action_moves_nobody():
    env = compiled()
    env.reset(seed=0)
    for wrong in (np.zeros((2, 2)), np.zeros((3, 3)), np.full((3, 2), np.nan)):
        with pytest.raises(InputError):
            env.step(wrong)
    assert env._state.steps.tolist() == [0] * 3
    env.close()
    with pytest.raises(InputError, match="closed"):
        env.step(np.zeros((3, 2)))


def test_an_unknown_simulator_is_refused():
    with pytest.raises(InputError, match="unknown simulator 'gazebo'; simulators: compiled, cuda, mujoco"):
        gym.make_vec("tagalong/Corridor-v0", 2, "vector_entry_point", simulator="gazebo")


def test_a_building_without_room_for_so_many_gives_way_to_another():
    def cramped(rng, request):
        if rng.random() < 0.7:
            raise InputError("no room for 13 people in this building")
        return make_scene("corridor", rng, request=request)

    env = compiled(scene=cramped, episodes_ahead=12)
    observation, _ = env.reset(seed=0)
    assert env.observation_space.contains(observation)
    env.close()


def test_whole_numbers_where_fractions_may_stand_do_not_compile_the_kernels_anew():
    usual = make_rules(compiled_config({}), 0, 2)
    whole = {
        "robot.max_turn_rate": 3,
        "robot.max_speed": 1,
        "robot.mass": 20,
        "lidar.range_max": 20,
        "lidar.dropout": 0,
    }
    whole |= {"robot.max_acceleration": 1, "robot.max_turn_acceleration": 2, "lost_limit_s": 5}
    assert numba.typeof(make_rules(compiled_config(whole), 0, 2)) == numba.typeof(usual)


def test_the_kinds_of_episodes_take_turns_building_by_building():
    kinds = [{"people": 1}, {"scene": "doorway", "people": 4, "odometry": "perfect"}]
    env = compiled(worlds=40, episodes_ahead=16, kinds=kinds)
    env.reset(seed=0)
    plans = env._pool.plans
    assert plans.people[:16].tolist() == [1] * 4 + [4] * 4 + [1] * 4 + [4] * 4
    assert np.abs(plans.errors[4:8]).max() == 0.0
    assert set(plans.people[env._state.slot].tolist()) == {1, 4}


@pytest.mark.parametrize(
    ("kinds", "told"),
    [
        ([], "must be a list of reset options"),
        ({"people": 2}, "must be a list of reset options"),
        ([{"peple": 2}], "unknown reset option"),
        ([{"people": 0}], "must be at least 1"),
        ([{}, {}, {}], "3 `kinds` need at least 12 `episodes_ahead`"),
    ],
)
def test_kinds_that_are_none_are_refused_in_one_line(kinds, told):
    with pytest.raises(InputError, match=told):
        compiled(kinds=kinds)
