import itertools
import pickle
from dataclasses import replace

import numpy as np
import pytest
from tagalong.slam.engine import make_slam
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between, compose
from tagalong.slam.scan import LaserScan

ROOM = np.array([[-3.0, -2.0], [4.0, 2.5]])  # lower and upper corner [m]
PILLAR = np.array([[1.5, -1.0], [1.9, -0.6]])
BEARINGS = np.deg2rad(np.arange(-135.0, 135.5, 1.5))


def exits(pose, box, inside):
    """Ranges from a pose to the border of a box, from inside or outside; inf where it is missed."""
    angles = pose[2] + BEARINGS
    directions = np.stack((np.cos(angles), np.sin(angles)), axis=-1)
    with np.errstate(divide="ignore"):
        crossings = np.sort((box[:, None] - pose[:2]) / directions, axis=0)
    near, far = crossings[0].max(axis=-1), crossings[1].min(axis=-1)
    return far if inside else np.where((near > 0) & (near < far), near, np.inf)


def scan_at(pose, rng, time_s=0.0):
    ranges = np.minimum(exits(pose, ROOM, True), exits(pose, PILLAR, False))
    return LaserScan(ranges + rng.normal(0.0, 0.01, len(ranges)), BEARINGS, 0.1, 30.0, time_s)


def drive(seed=0, steps=60):
    """A loop in a room with a pillar: true poses, odometry that drifts, scans."""
    rng = np.random.default_rng(seed)
    angles = np.linspace(0.0, 2.0 * np.pi, steps)
    truth = np.stack((1.2 * np.cos(angles) - 1.0, 1.2 * np.sin(angles), angles + np.pi / 2.0), axis=-1)
    odometry = [truth[0]]
    for before, after in itertools.pairwise(truth):
        step = between(before, after) * [1.05, 1.0, 0.97] + rng.normal(0.0, [0.005, 0.002, 0.005])
        odometry.append(compose(odometry[-1], step))
    return truth, np.array(odometry), [scan_at(pose, rng, 0.1 * i) for i, pose in enumerate(truth)]


def run(slam, odometry, scans):
    for pose, scan in zip(odometry, scans, strict=True):
        slam.update(pose, scan)
    return slam


def test_a_room_is_mapped_within_two_centimetres_though_odometry_drifts():
    truth, odometry, scans = drive()
    slam = run(make_slam("gmapping", particles=10, seed=1), odometry, scans)
    errors = np.linalg.norm(slam.trajectory()[:, :2] - truth[:, :2], axis=1)
    assert np.linalg.norm(odometry[:, :2] - truth[:, :2], axis=1).max() > 0.15
    assert errors.max() < 0.05
    assert np.sqrt(np.mean(errors**2)) < 0.02
    points = slam.map().occupied_points
    from_room = np.abs(np.stack((points - ROOM[0], points - ROOM[1]))).min(axis=(0, 2))
    centre, half = PILLAR.mean(axis=0), np.diff(PILLAR, axis=0)[0] / 2
    from_pillar = np.abs((np.abs(points - centre) - half).max(axis=1))
    assert np.percentile(np.minimum(from_room, from_pillar), 95) < 0.06


def test_one_seed_gives_the_same_bytes_with_any_number_of_threads_and_another_seed_others():
    _, odometry, scans = drive(steps=30)
    results = [
        run(make_slam("gmapping", particles=7, seed=seed, threads=threads), odometry, scans)
        for seed, threads in ((3, 1), (3, 1), (3, 3), (4, 1))
    ]
    first, again, threaded, other = (slam.trajectory().tobytes() + slam.map().probability.tobytes() for slam in results)
    assert first == again == threaded
    assert first != other


def test_the_particles_own_map_agrees_with_the_rendered_one_and_copies_go_their_own_way():
    _, odometry, scans = drive(steps=40)
    slam = run(make_slam("gmapping", particles=4), odometry[:20], scans[:20])
    own, drawn = slam.live_map().occupied_points, slam.map().occupied_points
    assert np.linalg.norm(own[:, None] - drawn, axis=-1).min(axis=0).max() < 0.11
    twin = pickle.loads(pickle.dumps(slam))
    before = slam.trajectory().tobytes()
    run(twin, odometry[20:], scans[20:])
    assert slam.trajectory().tobytes() == before
    run(slam, odometry[20:], scans[20:])
    assert slam.trajectory().tobytes() == twin.trajectory().tobytes()
    assert slam.live_map().probability.tobytes() == twin.live_map().probability.tobytes()


def test_every_scan_has_a_pose_and_the_first_is_the_first_odometry():
    _, odometry, scans = drive(steps=60)
    slam = make_slam("gmapping", particles=3)
    assert slam.trajectory().shape == (0, 3)
    updates = [slam.update(pose, scan) for pose, scan in zip(odometry, scans, strict=True)]
    np.testing.assert_allclose(slam.trajectory()[0], odometry[0])
    assert slam.trajectory().shape == (60, 3)
    assert updates[0].integrated
    assert 2 < sum(update.integrated for update in updates) < 30
    np.testing.assert_array_equal(updates[-1].pose, slam.pose)
    np.testing.assert_array_equal(slam.trajectory()[-1], slam.pose)


@pytest.mark.parametrize("engine", ["gmapping", "ekf"])
def test_scans_of_a_robot_that_stands_still_are_not_called_integrated(engine):
    pose, rng = np.array([-1.0, 0.5, 0.3]), np.random.default_rng(0)
    slam = make_slam(engine)
    updates = [slam.update(pose, scan_at(pose, rng, 0.1 * i)) for i in range(6)]
    assert [update.integrated for update in updates] == [True] + 5 * [False]


@pytest.mark.parametrize("ranges", [np.full(181, np.nan), np.full(181, np.inf), np.zeros(181), np.zeros(0)])
def test_a_scan_without_returns_is_carried_by_odometry(ranges):
    bearings = np.linspace(-1.0, 1.0, len(ranges))
    slam = make_slam("gmapping", particles=3)
    for step in range(4):
        update = slam.update((0.6 * step, 0.0, 0.0), LaserScan(ranges, bearings, 0.1, 30.0))
    np.testing.assert_allclose(update.pose, [1.8, 0.0, 0.0])
    assert not slam.map().occupied.any()


def test_a_scan_of_three_points_and_a_blind_spell_do_not_break_a_run():
    _, odometry, scans = drive(steps=40)
    keep = np.arange(len(BEARINGS)) < 3
    scans = [
        scan.without(~keep) if i % 5 == 0 else scan.without(keep | ~keep) if 10 < i < 15 else scan
        for i, scan in enumerate(scans)
    ]
    slam = run(make_slam("gmapping", particles=5), odometry, scans)
    assert np.isfinite(slam.trajectory()).all()


def test_odometry_may_begin_anywhere_as_in_a_map_of_the_country():
    _, odometry, scans = drive(steps=20)
    near, far = (make_slam("gmapping", particles=4, seed=0) for _ in range(2))
    corner = np.array((5.0e5, -5.4e6, 0.0))
    run(near, odometry, scans)
    run(far, odometry + corner, scans)
    np.testing.assert_allclose(far.trajectory() - corner, near.trajectory(), atol=1e-4)
    assert far.live_map().probability.shape == near.live_map().probability.shape


def test_a_minimum_score_that_none_reaches_leaves_the_pose_to_odometry():
    _, odometry, scans = drive(steps=20)
    noise_free = {"srr": 0.0, "srt": 0.0, "str_": 0.0, "stt": 0.0}
    slam = run(make_slam("gmapping", particles=3, minimum_score=1.0, **noise_free), odometry, scans)
    assert np.abs(between(odometry, slam.trajectory()))[:, :2].max() < 0.15
    assert np.abs(slam.trajectory() - odometry).max() > 0.0


def worst_errors(slam, truth):
    off = between(truth, slam.trajectory())
    return np.hypot(*off[:, :2].T).max(), np.rad2deg(np.abs(off[:, 2])).max()


@pytest.mark.parametrize("seed", range(5))
def test_sixty_metres_in_the_open_do_not_throw_the_robot_out_of_the_hall(seed):
    slam, odometry = make_slam("gmapping", particles=10, seed=seed), np.zeros((301, 3))
    odometry[:, 0] = 0.2 * np.arange(301)
    for k, pose in enumerate(odometry):
        slam.update(pose, LaserScan(np.full(len(BEARINGS), np.inf), BEARINGS, 0.1, 30.0, 0.1 * k))
    update = slam.update(odometry[-1], scan_at(np.zeros(3), np.random.default_rng(seed), 30.1))
    assert np.hypot(*(update.pose - odometry[-1])[:2]) < 120.0
    assert 10.0 < np.sqrt(np.trace(update.covariance[:2, :2])) < 80.0  # 0.2 rad/m of one sign all the way: 360 m


def test_scans_between_matched_ones_are_followed_not_left_to_odometry():
    truth, _, scans = drive(steps=120)
    steps = between(truth[:-1], truth[1:]) * [1.0, 1.0, 0.8]
    slow = np.array(list(itertools.accumulate(steps, compose, initial=truth[0])))
    metres, degrees = worst_errors(run(make_slam("gmapping", particles=5), slow, scans), truth)
    assert metres < 0.05
    assert degrees < 1.0


def test_an_odometry_that_freezes_and_then_catches_up_is_not_believed():
    truth, odometry, scans = drive()
    for start in (10, 25, 40):
        odometry[start : start + 6] = odometry[start - 1]
    metres, degrees = worst_errors(run(make_slam("gmapping", particles=5), odometry, scans), truth)
    assert metres < 0.1
    assert degrees < 2.0


def test_a_scan_that_a_driver_gives_twice_is_no_measurement():
    truth, odometry, scans = drive()
    for k in range(5, len(scans), 5):
        scans[k] = scans[k - 1]
    metres, _ = worst_errors(run(make_slam("gmapping", particles=5), odometry, scans), truth)
    assert metres < 0.1


def test_a_robot_that_was_carried_out_of_reach_is_told_and_an_undisturbed_one_never():
    _, odometry, scans = drive()
    slam = make_slam("gmapping", particles=5)
    undisturbed = [slam.update(pose, scan) for pose, scan in zip(odometry, scans, strict=True)]
    assert all(update.located for update in undisturbed)
    assert all(np.linalg.eigvalsh(update.covariance).min() > -1e-12 for update in undisturbed)
    elsewhere = [replace(scan, ranges=0.4 * scan.ranges[::-1]) for scan in scans[:5]]
    assert not all(slam.update(odometry[-1], scan).located for scan in elsewhere)


def test_bad_input_is_named():
    with pytest.raises(InputError, match="particels"):
        make_slam("gmapping", particels=3)
    with pytest.raises(InputError, match=r"`delta` must be within 0\.001 \.\. 100, got -1"):
        make_slam("gmapping", delta=-1)
    with pytest.raises(InputError, match="`particles` must be a whole number"):
        make_slam("gmapping", particles=2.5)
    slam, scan = make_slam("gmapping", particles=2), drive(steps=2)[2][0]
    slam.update((0.0, 0.0, 0.0), scan)
    with pytest.raises(InputError, match="the map would grow to"):
        slam.update((7e3, 7e3, 0.0), replace(scan, ranges=0.3 * scan.ranges))  # nothing speaks for another place
    with pytest.raises(InputError, match="`odometry` must be a finite pose"):
        make_slam("gmapping").update((0, 0, np.nan), drive(steps=2)[2][0])
