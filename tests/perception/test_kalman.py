import numpy as np
import pytest
from scipy import stats
from tagalong.perception.tracking import kalman
from tagalong.perception.tracking.config import MotionConfig
from tagalong.perception.tracking.ye2021_config import Ye2021Config

CONFIG = MotionConfig()


def full_covariance(p):
    """(n, 4, 4) covariances in the order (x, y, vx, vy) from the three numbers (n, 3)."""
    return np.kron(np.stack((p[:, :2], p[:, 1:]), axis=1), np.eye(2))


def predict(x, p, dt, q):
    for row, covariance in zip(x, p, strict=True):
        kalman.predict_state(row, covariance, dt, q)


def correct(x, p, z, r):
    for row, covariance, measured in zip(x, p, z, strict=True):
        kalman.correct_state(row, covariance, *measured, r)


def start(n, rng):
    x = np.concatenate((rng.normal(0, 3, (n, 2)), np.zeros((n, 2))), axis=1)
    return x, np.tile((CONFIG.initial_variance, 0.0, CONFIG.initial_variance), (n, 1))


def test_the_batched_filter_equals_filterpy():
    rng = np.random.default_rng(1)
    x, p = start(5, rng)
    singles = [kalman.single_target(row[:2], CONFIG.initial_variance, CONFIG.r) for row in x]
    for dt in rng.uniform(0.02, 0.2, 60):
        q = CONFIG.process_variance(dt)
        predict(x, p, dt, q)
        z, seen = x[:, :2] + rng.normal(0, 0.3, (5, 2)), rng.random(5) < 0.7
        for i in np.flatnonzero(seen):
            kalman.correct_state(x[i], p[i], *z[i], CONFIG.r)
        for single, measured, is_seen in zip(singles, z, seen, strict=True):
            kalman.predict_single(single, dt, q)
            single.update(measured if is_seen else None)
    np.testing.assert_allclose(x, [single.x for single in singles], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(full_covariance(p), [single.P for single in singles], rtol=1e-12, atol=1e-14)


def test_errors_and_innovations_agree_with_the_covariance():
    # truth drawn from the filter's own model, so NEES and NIS must be chi-square distributed
    rng, n, steps, dt = np.random.default_rng(2), 200, 50, 0.1
    q, r = CONFIG.process_variance(dt), CONFIG.r
    x, p = start(n, rng)
    truth = x + rng.normal(0, np.sqrt(CONFIG.initial_variance), (n, 4))
    nees, nis = [], []
    for _ in range(steps):
        truth[:, :2] += dt * truth[:, 2:]
        truth += rng.normal(0, np.sqrt(q), (n, 4))
        predict(x, p, dt, q)
        z = truth[:, :2] + rng.normal(0, np.sqrt(r), (n, 2))
        nis.append(np.sum((z - x[:, :2]) ** 2, axis=1) / (p[:, 0] + r))
        correct(x, p, z, r)
        error = truth - x
        nees.append(np.einsum("ni,nij,nj->n", error, np.linalg.inv(full_covariance(p)), error))
    for values, degrees in ((np.array(nees), 4), (np.array(nis), 2)):
        low, high = stats.chi2.ppf((0.0005, 0.9995), degrees * n) / n  # of the mean of n independent targets
        assert low < values[0].mean() < high
        assert low < values[-1].mean() < high
        assert values.mean() == pytest.approx(degrees, rel=0.03)


@pytest.mark.parametrize("rate_hz", [10, 20, 40])
def test_process_noise_and_confidence_memory_last_equally_long_at_any_rate(rate_hz):
    assert rate_hz * CONFIG.process_variance(1 / rate_hz) == pytest.approx(CONFIG.q * CONFIG.reference_rate_hz)
    left = (1.0 - Ye2021Config().confidence_weight(1 / rate_hz)) ** rate_hz
    assert left == pytest.approx(0.95**CONFIG.reference_rate_hz)
