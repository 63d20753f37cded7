import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from tagalong.slam.geometry import between, compose, inverse, transform_points, wrap_angle, wrap_one

poses = arrays(np.float64, 3, elements=st.floats(-50, 50))


def apart(a, b):
    """The largest difference of two poses (3,) [m, rad]."""
    return max(*np.abs(a[:2] - b[:2]), abs(wrap_angle(a[2] - b[2])))


@given(st.floats(-1e3, 1e3))
def test_wrapped_angle_lies_in_the_half_open_interval_and_keeps_its_direction(angle):
    wrapped = wrap_angle(angle)
    assert -np.pi <= wrapped < np.pi
    np.testing.assert_allclose([np.cos(wrapped), np.sin(wrapped)], [np.cos(angle), np.sin(angle)], atol=1e-9)


@given(poses)
def test_a_pose_composed_with_its_inverse_is_the_identity(pose):
    assert apart(compose(pose, inverse(pose)), np.zeros(3)) < 1e-9
    assert apart(compose(inverse(pose), pose), np.zeros(3)) < 1e-9


@given(poses, poses)
def test_between_undoes_compose(a, b):
    assert apart(between(a, compose(a, b)), b) < 1e-9


@settings(deadline=None)  # the kernel may have to be compiled first
@given(poses, poses)
def test_transforming_twice_is_transforming_by_the_composition(a, b):
    points = np.array([[1.0, 2.0], [-3.0, 0.5]])
    np.testing.assert_allclose(
        transform_points(a, transform_points(b, points)), transform_points(compose(a, b), points), atol=1e-9
    )


def test_functions_broadcast_over_leading_axes():
    many = np.zeros((4, 5, 3))
    assert compose(many, [1.0, 2.0, 3.0]).shape == (4, 5, 3)
    assert inverse(many).shape == (4, 5, 3)
    assert transform_points(many[0], np.zeros((5, 7, 2))).shape == (5, 7, 2)


@pytest.mark.parametrize("count", [0, 1, 17])
def test_the_kernel_for_one_pose_says_the_same_as_numpy_for_many(count):
    rng = np.random.default_rng(count)
    pose, points = rng.normal(size=3) * 3.0, rng.normal(size=(count, 2))
    assert transform_points(pose, points) == pytest.approx(transform_points(pose[None], points[None])[0], abs=1e-14)
    strided = np.zeros((count, 5))
    strided[:, 1:4:2] = points
    strided.setflags(write=False)
    assert np.array_equal(transform_points(pose, strided[:, 1:4:2]), transform_points(pose, points))


@pytest.mark.parametrize("angle", [0.0, 3.0, np.pi, -np.pi, np.nextafter(np.pi, 4.0), -3.2, 100.0, -1e-17])
def test_one_angle_is_wrapped_as_many_are(angle):
    assert wrap_one(angle) == wrap_angle(angle)
