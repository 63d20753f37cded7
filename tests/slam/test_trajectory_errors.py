import numpy as np
import pytest
from evo.core import metrics
from evo.core.trajectory import PosePath3D
from hypothesis import given, settings
from hypothesis import strategies as st
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import compose
from tagalong.slam.quality.trajectory import ErrorStatistics, absolute_error, associate, relative_error


def wandering(n, seed):
    rng = np.random.default_rng(seed)
    poses = [np.zeros(3)]
    for _ in range(n - 1):
        poses.append(compose(poses[-1], (0.1, 0.0, rng.normal(0, 0.2))))
    return np.array(poses)


def evo_path(poses):
    matrices = []
    for x, y, theta in poses:
        matrix = np.eye(4)
        matrix[:2, :2] = [[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]]
        matrix[:2, 3] = x, y
        matrices.append(matrix)
    return PosePath3D(poses_se3=matrices)


@pytest.fixture
def pair():
    reference = wandering(80, 1)
    drifting = compose((4.0, -2.0, 0.7), reference) + np.random.default_rng(2).normal(0, 0.05, reference.shape)
    return drifting, reference


@pytest.mark.parametrize("align", [True, False])
def test_ate_agrees_with_evo(pair, align):
    estimate, reference = pair
    path, truth = evo_path(estimate), evo_path(reference)
    if align:
        path.align(truth)
    metric = metrics.APE(metrics.PoseRelation.translation_part)
    metric.process_data((truth, path))
    turn = metrics.APE(metrics.PoseRelation.rotation_angle_deg)
    turn.process_data((truth, path))
    ours = absolute_error(estimate, reference, align=align)
    for name, value in metric.get_all_statistics().items():
        if hasattr(ours.translation, name):
            assert getattr(ours.translation, name) == pytest.approx(value, rel=1e-9)
    assert ours.rotation.mean == pytest.approx(turn.get_statistic(metrics.StatisticsType.mean), rel=1e-6)


@pytest.mark.parametrize("step", [1, 7])
def test_rpe_agrees_with_evo(pair, step):
    estimate, reference = pair
    for relation, part in (
        (metrics.PoseRelation.translation_part, "translation"),
        (metrics.PoseRelation.rotation_angle_deg, "rotation"),
    ):
        metric = metrics.RPE(relation, delta=step, delta_unit=metrics.Unit.frames, all_pairs=True)
        metric.process_data((evo_path(reference), evo_path(estimate)))
        ours = getattr(relative_error(estimate, reference, step), part)
        assert ours.rmse == pytest.approx(metric.get_statistic(metrics.StatisticsType.rmse), rel=1e-6)
        assert ours.max == pytest.approx(metric.get_statistic(metrics.StatisticsType.max), rel=1e-6)


def test_a_moved_copy_has_no_error_when_aligned():
    reference = wandering(50, 3)
    moved = compose((1.0, 2.0, 3.0), reference)
    assert absolute_error(moved, reference).translation.max < 1e-9
    assert absolute_error(moved, reference, align=False).translation.mean > 1.0
    assert relative_error(moved, reference).translation.max < 1e-9


def test_known_errors_without_alignment():
    reference = np.zeros((4, 3))
    estimate = np.array([(0.0, 0, 0), (3, 4, 0), (0, 0, np.pi / 2), (0, 0, 0)])
    error = absolute_error(estimate, reference, align=False)
    assert error.translation.rmse == pytest.approx(2.5)
    assert error.translation.mean == pytest.approx(1.25)
    assert error.translation.max == pytest.approx(5.0)
    assert error.rotation.max == pytest.approx(90.0)


def test_shapes_and_steps_that_do_not_fit_are_named():
    with pytest.raises(InputError, match=r"\(3, 3\) and \(2, 3\)"):
        absolute_error(np.zeros((3, 3)), np.zeros((2, 3)))
    with pytest.raises(InputError, match=r"\[1, 2\]"):
        relative_error(np.zeros((3, 3)), np.zeros((3, 3)), step=3)
    with pytest.raises(InputError, match="at least one"):
        ErrorStatistics.of(np.empty(0))


def test_poses_are_associated_by_nearest_time_once_each():
    a, b = associate(np.array([0.0, 0.1, 0.2, 0.5]), np.array([0.201, 0.099, 0.1, 0.9]), 0.01)
    assert a.tolist() == [1, 2]
    assert b.tolist() == [2, 0]


def test_pose_to_pose_errors_do_not_depend_on_the_order_of_the_lines():
    rng = np.random.default_rng(0)
    times = 0.1 * np.arange(50)
    reference = np.stack((times, np.sin(times), 0.1 * times), axis=-1)
    estimate = reference + rng.normal(0.0, 0.01, reference.shape)
    mixed = rng.permutation(50)
    a, b = associate(times[mixed], times)
    assert b.tolist() == list(range(50))
    assert relative_error(estimate[mixed][a], reference[b]) == relative_error(estimate, reference)


@settings(deadline=None, max_examples=50)
@given(st.integers(1, 40), st.integers(1, 40), st.integers(0, 10_000))
def test_associated_pairs_are_unique_and_near(n, m, seed):
    rng = np.random.default_rng(seed)
    times_a, times_b = rng.uniform(0, 1, n), rng.uniform(0, 1, m)
    a, b = associate(times_a, times_b, 0.05)
    assert len(set(a)) == len(a) == len(set(b)) == len(b)
    assert np.all(np.abs(times_a[a] - times_b[b]) <= 0.05)
