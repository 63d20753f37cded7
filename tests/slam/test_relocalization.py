"""A robot that is kidnapped while it maps: SLAM notices, says so, and joins the rest of the drive to its map."""

import numpy as np
import pytest
from tagalong.slam.engine import make_slam
from tagalong.slam.geometry import between, compose, transform_points
from tagalong.slam.graph.engine import Cartographer, CartographerConfig
from tagalong.slam.local.match_monitor import MatchMonitor, MatchMonitorConfig, contradictions
from tagalong.slam.local.submap import Submap, SubmapConfig
from tagalong.slam.local.sweep import Sweep
from tagalong.slam.scan_to_scan import make_matcher
from walls import cast


def ring(*corners):
    return [(*a, *b) for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)]


WALLS = np.array(
    ring((-5.0, -3.0), (6.0, -3.0), (6.0, 1.0), (3.0, 1.0), (3.0, 4.0), (-1.0, 4.0), (-1.0, 2.0), (-5.0, 2.0))
    + ring((-3.0, -0.5), (-2.0, -0.5), (-2.0, 0.3), (-3.0, 0.3))
    + ring((1.0, 0.5), (1.6, 0.5), (1.6, 1.1))
)
ELSEWHERE = np.array(
    ring((-9.0, -1.0), (2.0, -1.0), (2.0, -6.0), (4.0, -6.0), (4.0, 5.0), (2.0, 5.0), (2.0, 1.0), (-9.0, 1.0))
)


def ahead(start, motion, count):
    poses = [np.array(start)]
    for _ in range(count - 1):
        poses.append(compose(poses[-1], motion))
    return poses


def tour():
    """Return true poses of a loop through the building."""
    phase = np.linspace(0.0, 2.0 * np.pi, 90)
    x, y = 0.5 + 4.0 * np.cos(phase), -1.6 + 0.7 * np.sin(phase)
    return np.stack((x, y, np.arctan2(0.7 * np.cos(phase), -4.0 * np.sin(phase))), axis=-1)


def fed(engine, poses, odometry, rng, lines=WALLS):
    """Feed scans at true `poses`; the odometry goes on from `odometry` by their motions. Return updates, odometry."""
    updates = []
    for k, pose in enumerate(poses):
        if k:
            odometry = compose(odometry, between(poses[k - 1], pose) * [1.02, 1.02, 1.01])
        updates.append(engine.update(odometry, cast(lines, pose, rng)))
    return updates, odometry


def among_people(pose, bearings, away=0.9, half=0.2):
    """Return the building and people around a robot at `pose`, each a box of side 2 `half`."""
    people = []
    for bearing in bearings:
        x, y = transform_points(pose, away * np.array([[np.cos(bearing), np.sin(bearing)]]))[0]
        people += ring((x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half))
    return np.concatenate((WALLS, people))


@pytest.fixture
def mapped():
    """Return an engine that has mapped the building, the odometry and the true pose there; the map frame is true."""
    rng, engine, poses = np.random.default_rng(0), make_slam("cartographer"), tour()
    updates, odometry = fed(engine, poses, poses[0], rng)
    assert all(update.located for update in updates)
    assert isinstance(engine, Cartographer)
    assert (engine.losses, engine.relocalizations) == (0, 0)
    return engine, odometry, poses[-1], rng


def distance(a, b):
    return float(np.hypot(*between(a, b)[:2]))


def test_slam_finds_a_kidnapped_robot_on_its_map_within_ten_scans(mapped):
    engine, odometry, _, rng = mapped
    after = ahead((-3.8, 0.9, -1.2), (0.1, 0.0, 0.03), 40)
    updates, _ = fed(engine, after, odometry, rng)
    located = [update.located for update in updates]
    assert not any(located[:2])  # contradicted from the first scan on
    assert all(located[9:])
    for update, pose in zip(updates[9:], after[9:], strict=True):
        assert distance(update.pose, pose) < 0.1
    engine.finish()
    assert (engine.losses, engine.relocalizations) == (1, 1)
    final = engine.trajectory()
    assert max(distance(a, b) for a, b in zip(final[-40:], after, strict=True)) < 0.15
    assert max(distance(a, b) for a, b in zip(final[:90], tour(), strict=True)) < 0.1


def test_where_slam_recovers_icp_from_the_last_scan_does_not(mapped):
    engine, odometry, last, rng = mapped
    after = ahead((-3.8, 0.9, -1.2), (0.1, 0.0, 0.03), 12)
    reference, new = cast(WALLS, last, rng), cast(WALLS, after[0], rng)
    match = make_matcher("icp").match(reference, new, (0.0, 0.0, 0.0))
    assert distance(compose(last, match.pose), after[0]) > 1.0
    updates, _ = fed(engine, after, odometry, rng)
    assert distance(updates[-1].pose, after[-1]) < 0.1


def test_the_map_stays_clean_of_what_was_seen_before_the_robot_was_found(mapped):
    engine, odometry, _, rng = mapped
    engine.finish()
    before = engine.map().occupied.sum()
    fed(engine, ahead((-3.8, 0.9, -1.2), (0.1, 0.0, 0.03), 30), odometry, rng)
    engine.finish()
    occupied = engine.map().occupied_points
    a, e = WALLS[:, :2], WALLS[:, 2:] - WALLS[:, :2]
    share = np.clip(((occupied[:, None] - a) * e).sum(-1) / (e**2).sum(-1), 0.0, 1.0)
    off = np.linalg.norm(occupied[:, None] - (a + share[..., None] * e), axis=-1).min(axis=1)
    assert (off > 0.15).mean() < 0.01
    assert len(occupied) >= before


def test_kidnapped_into_another_building_it_is_not_located_and_its_map_stays(mapped):
    engine, odometry, _, rng = mapped
    engine.finish()
    before = engine.map().occupied.sum()
    updates, _ = fed(engine, ahead((-4.0, 0.0, 0.0), (0.15, 0.0, 0.0), 25), odometry, rng, ELSEWHERE)
    assert not any(update.located for update in updates[5:])
    assert engine.relocalizations == 0
    engine.finish()
    assert abs(engine.map().occupied.sum() - before) < 20
    assert len(engine.trajectory()) == 115


def test_what_a_robot_sees_that_is_never_found_is_not_drawn(mapped):
    engine, odometry, _, rng = mapped
    engine.finish()
    before = engine.map().occupied_points
    fed(engine, ahead((-4.0, 0.0, 0.0), (0.15, 0.0, 0.0), 25), odometry, rng, ELSEWHERE)
    engine.finish()
    assert engine.losses == 1
    drawn = engine.map().occupied_points
    new = np.linalg.norm(drawn[:, None] - before[None], axis=-1).min(axis=1) > 0.1
    assert not new.any()


def test_people_all_around_do_not_make_the_robot_lost(mapped):
    engine, odometry, last, rng = mapped
    after, located = ahead(last, (0.1, 0.0, 0.05), 20), []
    for k, pose in enumerate(after):
        odometry = compose(odometry, between(after[k - 1], pose)) if k else odometry
        update = engine.update(odometry, cast(among_people(pose, (0.3, -0.8, 1.5, 2.6, -2.0)), pose, rng))
        located.append(update.located)
        assert distance(update.pose, pose) < 0.05
    assert (engine.losses, engine.relocalizations) == (0, 0)
    assert sum(located) >= 2  # once a doubt is raised the map says so


def round_room():
    """Return a submap of a round room, the scan (200, 2) that drew it, and one that contradicts it by a quarter."""
    submap = Submap(SubmapConfig(), np.zeros(3))
    bearings = np.linspace(-np.pi, np.pi, 200, endpoint=False)
    circle = 3.0 * np.stack((np.cos(bearings), np.sin(bearings)), axis=-1)
    submap.insert(Sweep(np.concatenate((np.zeros((1, 2)), circle)), len(circle), 0))
    odd = circle.copy()
    odd[:50] *= 0.5  # these beams end where the others went through
    return submap, circle, odd


def test_what_score_is_usual_follows_the_scores_up_and_down():
    submap, circle, odd = round_room()

    def rejected(usual, score):
        monitor = MatchMonitor(MatchMonitorConfig())
        for old in usual:
            assert not monitor.rejects(submap, circle, np.zeros(2), np.zeros(3), old)
        return monitor.rejects(submap, odd, np.zeros(2), np.zeros(3), score)

    high, low = [0.8] * 100, [0.4] * 100
    assert [rejected(low, score) for score in (0.28, 0.32, 0.58)] == [True, False, False]
    assert [rejected(low + high, score) for score in (0.32, 0.58, 0.62)] == [True, True, False]
    assert [rejected(high + low, score) for score in (0.28, 0.32, 0.58)] == [True, False, False]
    assert rejected([0.8, 0.4], 0.58)  # one scan says little
    assert not rejected([0.8, 0.4], 0.595)  # 0.75 of 0.78


def test_kidnapped_along_a_corridor_that_looks_alike_everywhere_it_is_found_and_not_sure_before():
    niches = [(1.0, 0.9), (4.5, 0.9), (6.0, 1.4), (11.0, 0.9), (15.5, 2.0), (19.0, 0.9), (21.0, 0.9), (26.0, 1.4)]
    outline = [(0.0, -1.2), (30.0, -1.2), (30.0, 1.2)]
    for start, width in reversed(niches):
        outline += [(start + width, 1.2), (start + width, 1.7), (start, 1.7), (start, 1.2)]
    corridor = np.array(ring(*outline, (0.0, 1.2)))
    engine, rng = make_slam("cartographer"), np.random.default_rng(0)
    assert isinstance(engine, Cartographer)
    poses = ahead((1.0, 0.0, 0.0), (0.15, 0.0, 0.0), 180)
    updates, odometry = fed(engine, poses, poses[0], rng, corridor)
    assert all(update.located for update in updates)
    after = ahead((9.0, 0.3, 0.0), (0.1, 0.0, 0.0), 30)
    updates, _ = fed(engine, after, odometry, rng, corridor)
    wrong = [u.located and distance(u.pose, pose) > 0.3 for u, pose in zip(updates, after, strict=True)]
    assert not any(wrong)
    assert updates[-1].located
    engine.finish()
    assert (engine.losses, engine.relocalizations) == (1, 1)


def test_without_recovery_or_a_graph_nobody_notices():
    for settings in ({"recovery": False}, {"global_": None}):
        engine = Cartographer(CartographerConfig(**settings))
        rng, poses = np.random.default_rng(0), tour()
        _, odometry = fed(engine, poses, poses[0], rng)
        fed(engine, ahead((-3.8, 0.9, -1.2), (0.1, 0.0, 0.03), 12), odometry, rng)
        engine.finish()
        assert engine.losses == 0


def test_the_kernel_of_the_monitor_counts_beams_through_walls_and_ends_in_seen_free_space():
    rng = np.random.default_rng(0)
    field = np.where(rng.random((60, 80)) < 0.03, rng.uniform(0.3, 1.0, (60, 80)), 0.0).astype(np.float32)
    known, corner, sensor = rng.random((60, 80)) < 0.8, np.array([-2.0, -1.5]), np.array([0.1, 0.0])
    for _ in range(20):
        points, pose = rng.uniform(-2.5, 2.5, (30, 2)), rng.uniform(-1.0, 1.0, 3)
        start = (transform_points(pose, sensor[None])[0] - corner) / 0.05 + 0.5
        expected = 0
        for end in (transform_points(pose, points) - corner) / 0.05 + 0.5:
            length = np.hypot(*(end - start))
            steps = np.arange(1, int(length - 0.4 / 0.05) + 1)
            x, y = np.floor(start + (steps / length)[:, None] * (end - start)).astype(int).T
            inside = (x >= 0) & (y >= 0) & (x < 80) & (y < 60)
            blocked = bool((field[y[inside], x[inside]] > 0.5).any())
            j, i = np.floor(end).astype(int)
            if not blocked and 0 <= i < 60 and 0 <= j < 80 and known[i, j]:
                blocked = bool(field[max(i - 3, 0) : i + 4, max(j - 3, 0) : j + 4].max() < 0.15)
            expected += blocked
        assert contradictions(field, known.astype(np.float32), corner, 0.05, sensor, points, pose, 0.4) == expected


def test_a_monitor_without_sense_is_refused():
    with pytest.raises(ValueError, match="patience"):
        MatchMonitorConfig(patience=0)


def test_submaps_that_grew_lose_what_was_drawn_into_them_since_the_scans_that_are_taken_back(mapped):
    engine, odometry, last, rng = mapped
    mapping = engine._mapping  # pyright: ignore[reportPrivateUsage]
    mark, submaps = mapping.mark(), mapping.local.submaps
    growing = [s for s, submap in enumerate(submaps) if not submap.finished]
    walls = [submaps[s].field > 0.5 for s in growing]
    fed(engine, ahead(last, (0.1, 0.0, 0.0), 12), odometry, rng, ELSEWHERE)
    mapping.rewind(mark)
    assert len(submaps) == len(mark.graph.submap_poses)
    assert growing
    for s, before in zip(growing, walls, strict=True):
        assert submaps[s].finished
        assert (submaps[s].field > 0.5).sum() == before.sum()
