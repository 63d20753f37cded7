import numpy as np
import pytest
from scipy.stats import binom
from tagalong.scripts.lab.statistics import (
    holm,
    metric_mean,
    paired_shares,
    quantile_interval,
    ratio,
    share,
    t_mean,
    upper_bound,
)
from tagalong.slam import InputError


def test_nan_values_are_left_out_and_nothing_gives_nan():
    assert t_mean([1.0, np.nan, 3.0]).mean == 2.0
    assert np.isnan(t_mean([]).mean)
    assert np.isnan(share([]).mean)


def test_one_value_has_no_interval():
    one = t_mean([0.021])
    assert (one.mean, one.n) == (0.021, 1)
    assert np.isnan([one.low, one.high]).all()
    assert one.text(100.0, 1) == "2.1"
    assert t_mean([1.0, 1.0]).text() == "1.00 [1.00, 1.00]"
    assert t_mean([2.0, np.nan]).n == 1
    assert t_mean([]).text() == t_mean([np.nan]).text() == "-"


def test_a_share_of_all_successes_has_an_upper_end_of_one_and_an_honest_lower_end():
    estimate = share([True] * 30)
    assert estimate.mean == 1.0
    assert estimate.high > 0.999
    assert 0.85 < estimate.low < 0.9


@pytest.mark.parametrize("n", [2, 5, 30])
def test_the_interval_of_a_mean_covers_it_as_often_as_it_says_however_few_the_values(n):
    rng = np.random.default_rng(2)
    estimates = [t_mean(rng.normal(3.0, 1.0, n)) for _ in range(1000)]
    assert 0.93 <= np.mean([e.low <= 3.0 <= e.high for e in estimates]) <= 0.97


def test_an_interval_ends_where_the_mean_cannot_be():
    assert t_mean([0.0, 0.0, 3.0]).low < -3.0
    assert t_mean([0.0, 0.0, 3.0], least=0.0).low == 0.0
    assert t_mean([0.9, 1.0], most=1.0).high == 1.0
    assert metric_mean("losses", [0.0, 0.0, 3.0]).low == metric_mean("map/coverage", [0.1, 0.9]).low == 0.0
    assert metric_mean("map/coverage", [0.1, 0.9]).high == metric_mean("leader_visible_share", [0.9, 1.0]).high == 1.0
    assert metric_mean("sparc", [-0.1, -3.0]).high > 0.0
    assert metric_mean("min_distance_bystander_m", [0.1, 3.0]).low < 0.0


def test_tests_that_are_judged_together_are_corrected_by_holm():
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.9, 0.6]) == [1.0, 1.0]
    assert holm([]) == []


def test_paired_answers_are_compared_where_they_differ():
    first = [True] * 80 + [True] * 9 + [False] * 1 + [False] * 10
    second = [True] * 80 + [False] * 9 + [True] * 1 + [False] * 10
    paired = paired_shares(first, second)
    assert (paired.only_first, paired.only_second, paired.n) == (9, 1, 100)
    assert paired.difference == pytest.approx(-0.08)
    assert paired.p == pytest.approx(22 / 1024)  # two tails of ten coins
    assert paired.low < -0.08 < paired.high < 0.0
    assert paired_shares(first, first).p == 1.0
    with pytest.raises(InputError):
        paired_shares(first, second[:-1])


def test_the_interval_of_a_quantile_covers_it_about_as_often_as_it_says():
    rng = np.random.default_rng(2)
    intervals = np.array([quantile_interval(rng.random(400), 0.95) for _ in range(400)])
    inside = ((intervals[:, 0] <= 0.95) & (intervals[:, 1] >= 0.95)).mean()
    assert 0.92 < inside < 0.985
    assert quantile_interval(np.arange(1.0, 101.0), 0.5) == (40.0, 61.0)  # ranks by the binomial distribution
    assert np.isnan(quantile_interval([], 0.95)).all()
    assert quantile_interval([3.0], 0.95) == (3.0, 3.0)


def test_the_most_that_is_believable_of_a_share():
    assert upper_bound(0, 223) == pytest.approx(1.0 - 0.05 ** (1.0 / 223.0))
    assert upper_bound(5, 5) == 1.0
    bound = upper_bound(3, 40)
    assert binom.cdf(3, 40, bound) == pytest.approx(0.05)
    for wrong in ((1, 0), (3, 2), (-1, 4)):
        with pytest.raises(InputError, match="share"):
            upper_bound(*wrong)


def test_the_interval_of_a_ratio_covers_it_about_as_often_as_it_says():
    rng = np.random.default_rng(4)
    inside = 0
    for _ in range(1000):
        below = rng.normal(4.0, 2.0, 5)
        found = ratio(1.5 * below + rng.normal(0.0, 2.0, 5), below)
        inside += found.low <= 1.5 <= found.high
    assert 0.93 < inside / 1000 < 0.98


def test_a_ratio_to_what_may_be_nothing_has_no_upper_end():
    assert ratio([3.8, 4.0, 4.2], [1.9, 2.0, 2.1]).to_dict() == pytest.approx({"mean": 2, "low": 2, "high": 2, "n": 3})
    open_ended = ratio([9.0, 9.1, 8.9, 9.0], [0.0, 0.0, 2.0, 0.0])
    assert open_ended.mean == pytest.approx(18.0)
    assert 0.0 < open_ended.low < 9.0
    assert open_ended.high == np.inf
    assert ratio([0.0, 0.0, 2.0, 0.0], [0.0, 0.0, 2.0, 0.0]).low == 0.0
    assert np.isnan(ratio([1.0, 2.0], [0.0, 0.0]).mean)
    assert np.isnan(ratio([1.0], [2.0]).low)
