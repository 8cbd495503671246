"""Ensemble values and improvements: hand numbers, identities, independent implementations and coverage."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats
from statsmodels.stats.multitest import multipletests

from robins.evaluate import ensembles
from robins.evaluate.ensembles import (
    ensemble_improvement,
    ensemble_level,
    ensemble_value,
    holm,
    multiplicities,
)
from robins.foundation.randomness import stream


def generator(name="bootstrap"):
    return stream(0, f"test/intervals/0/{name}")


def lognormal(runs, centre, spread, name):
    return np.exp(centre + spread * generator(name).standard_normal(runs))


def improvement_of(numerator, denominator, power=2, lost=None, won=None, resamples=999, name="bootstrap"):
    lost, won = (np.zeros(len(numerator), dtype=bool) if side is None else side for side in (lost, won))
    counts = multiplicities(generator(name), len(numerator), resamples)
    return ensemble_improvement(numerator[:, None], denominator[:, None], lost, won, power, counts)


def test_multiplicities_count_draws_with_replacement():
    counts = multiplicities(generator(), 7, 4000)
    assert counts.shape == (4000, 7) and np.all(counts.sum(axis=1) == 7)
    # The number of times one run is drawn is binomial (7, 1/7): mean 1, variance 6/7.
    np.testing.assert_allclose([counts.mean(), counts.var()], [1.0, 6 / 7], atol=0.02)


def test_ensemble_values_by_hand():
    values = np.array([[3.0, -1.0], [-4.0, 1.0]])
    np.testing.assert_allclose(ensemble_value(values, 1), [3.5, 1.0])
    np.testing.assert_allclose(ensemble_value(values, 2), [np.sqrt(12.5), 1.0])


@pytest.mark.parametrize("power", [1, 2])
def test_an_ensemble_improvement_equals_scipys_paired_percentile_bootstrap(power):
    numerator, denominator = lognormal(60, -0.3, 0.4, "a"), lognormal(60, 0.0, 0.4, "b")

    def statistic(above, below, axis=-1):
        return 1 - (np.mean(above**power, axis=axis) / np.mean(below**power, axis=axis)) ** (1 / power)

    ours = improvement_of(numerator, denominator, power, resamples=9999)
    reference = stats.bootstrap(
        (numerator, denominator), statistic, paired=True, n_resamples=9999, method="percentile", rng=generator("scipy")
    ).confidence_interval
    np.testing.assert_allclose(ours.estimate, statistic(numerator, denominator))
    np.testing.assert_allclose([ours.low[0], ours.high[0]], reference, atol=0.01)


def test_the_p_value_counts_resamples_on_the_rarer_side_and_itself():
    numerator, denominator = lognormal(60, -0.05, 0.3, "a"), lognormal(60, 0.0, 0.3, "b")
    ours = improvement_of(numerator, denominator)
    indices = generator().integers(0, 60, (999, 60))
    ratios = np.sqrt(np.mean(numerator[indices] ** 2, axis=1) / np.mean(denominator[indices] ** 2, axis=1))
    rarer = min(np.sum(ratios <= 1), np.sum(ratios >= 1))
    assert ours.p[0] == pytest.approx(2 * (1 + rarer) / 1000) and 0.002 < ours.p[0] < 1


def test_equal_errors_have_no_improvement_and_a_p_value_of_one():
    values = lognormal(30, 0.0, 1.0, "a")
    ours = improvement_of(values, values)
    assert (ours.estimate[0], ours.low[0], ours.high[0], ours.p[0]) == (0.0, 0.0, 0.0, 1.0)


def test_equal_errors_but_for_the_last_bit_have_the_same_interval():
    values = lognormal(30, 0.0, 1.0, "a")
    nudged = np.where(np.arange(30) % 2, np.nextafter(values, np.inf), np.nextafter(values, 0.0))
    assert improvement_of(values, values) == improvement_of(nudged, values)


def test_a_failed_run_counts_as_the_worst_ratio_of_its_filter():
    numerator, denominator = np.array([1.0, 2.0, 9.0, 1.0]), np.array([2.0, 1.0, 1.0, 2.0])
    failed = np.array([False, False, True, False])
    sound = np.zeros(4, dtype=bool)
    ours = improvement_of(numerator, denominator, 1, lost=failed)
    assert ours.estimate[0] == pytest.approx(1 - (1 + 2 + 2 + 1) / 6)  # ratio 2 of run 1, times the denominator's error of 1
    ours = improvement_of(numerator, denominator, 1, won=failed)
    assert ours.estimate[0] == pytest.approx(1 - 13 / (2 + 1 + 18 + 2))  # ratio 1/2 of run 0
    ours = improvement_of(numerator, denominator, 1, lost=failed, won=failed)
    assert ours.estimate[0] == pytest.approx(1 - (4 + 5 / 3) / (5 + 5 / 3)) and ours.survivors == 3
    assert improvement_of(numerator, denominator, 1, sound, sound).estimate[0] == pytest.approx(1 - 13 / 6)


def test_a_filter_that_wins_every_run_never_gains_by_failing():
    numerator, denominator = np.full(10, 0.5), np.ones(10)
    failed = np.arange(10) == 0
    assert improvement_of(numerator, denominator, lost=failed).estimate[0] == pytest.approx(1 - np.sqrt((9 * 0.25 + 1) / 10))


def test_without_survivors_there_is_no_improvement_and_with_one_no_interval():
    ours = improvement_of(np.ones(3), np.ones(3), lost=np.ones(3, dtype=bool))
    assert np.isnan(ours.estimate[0]) and (ours.low[0], ours.high[0], ours.p[0]) == (-np.inf, np.inf, 1.0)
    ours = improvement_of(np.full(3, 0.5), np.ones(3), lost=np.array([True, True, False]))
    assert np.isfinite(ours.estimate[0]) and (ours.low[0], ours.high[0], ours.p[0]) == (-np.inf, np.inf, 1.0)


@pytest.mark.parametrize("value", [0.0, np.nan, np.inf])
def test_an_error_that_is_no_error_is_refused_unless_its_run_is_marked_as_failed(value):
    numerator = np.array([1.0, value, 2.0])
    with pytest.raises(ValueError, match="zero or not finite"):
        improvement_of(numerator, np.ones(3))
    assert np.isfinite(improvement_of(numerator, np.ones(3), lost=np.array([False, True, False])).estimate[0])


def test_the_interval_of_an_improvement_covers_the_truth_as_often_as_it_says():
    true = 1 - np.exp(-0.2)
    hits = 0
    for i in range(400):
        common = lognormal(100, 0.0, 0.2, f"common-{i}")
        ours = improvement_of(common * lognormal(100, -0.2, 0.2, f"a-{i}"), common * lognormal(100, 0.0, 0.2, f"b-{i}"), name=f"c-{i}")
        hits += ours.low[0] <= true <= ours.high[0]
    assert 0.91 <= hits / 400 <= 0.98  # percentile intervals cover a little less than they say; the share has a deviation of 0.011


def test_a_level_is_that_of_the_survivors_and_its_median_that_of_all():
    values = np.array([[1.0], [-2.0], [3.0], [99.0]])
    found = ensemble_level(values, np.array([False, False, False, True]), 1, generator(), 500)
    assert found.estimate[0] == 2.0 and found.median[0] == 2.5 and (found.n, found.failed) == (4, 1)
    assert 0.0 < found.low[0] < 2.0 < found.high[0]
    lost = ensemble_level(values, np.ones(4, dtype=bool), 1, generator(), 500)
    assert np.isnan(lost.estimate[0]) and (lost.low[0], lost.high[0], lost.median[0]) == (0.0, np.inf, np.inf)


def test_holms_adjustment_by_hand():
    # Sorted .01 .02 .04: times 3, 2, 1 is .03 .04 .04, and never falls.
    np.testing.assert_allclose(holm([0.04, 0.01, 0.02]), [0.04, 0.03, 0.04])


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=15))
@settings(max_examples=30, deadline=None)
def test_holms_adjustment_equals_that_of_statsmodels(p_values):
    np.testing.assert_allclose(holm(p_values), multipletests(p_values, method="holm")[1], rtol=1e-14)


def test_with_few_runs_an_improvement_has_the_interval_of_students_t():
    """With a denominator of one and errors near to one the log ratio is the mean less one: compare with scipy."""
    rng = np.random.default_rng(4)
    errors = 1.0 + 1e-4 * rng.standard_normal((6, 1))
    ones, none = np.ones((6, 1)), np.zeros(6, bool)
    found = ensemble_improvement(errors, ones, none, none, 1, multiplicities(rng, 6, 100))
    interval = stats.ttest_1samp(errors[:, 0], 1.0).confidence_interval(0.95)
    assert (found.low[0], found.high[0]) == pytest.approx((1.0 - interval.high, 1.0 - interval.low), abs=1e-7)


def test_the_p_value_of_few_runs_counts_exchanges_as_scipy_does():
    rng = np.random.default_rng(6)
    above, below = rng.uniform(0.5, 2.0, (2, 7, 1))

    def log_ratio(a, b, axis):
        return np.log(np.mean(a, axis=axis) / np.mean(b, axis=axis))

    expected = stats.permutation_test((above[:, 0], below[:, 0]), log_ratio, permutation_type="samples", n_resamples=np.inf)
    found = ensemble_improvement(above, below, np.zeros(7, bool), np.zeros(7, bool), 1, np.ones((10, 7)))
    assert found.p[0] == pytest.approx(expected.pvalue, rel=1e-12)


def test_five_runs_can_never_exclude_chance_in_twelve_channels():
    clear = np.full((5, 12), 0.1)
    found = ensemble_improvement(clear, 10.0 * clear, np.zeros(5, bool), np.zeros(5, bool), 2, np.ones((10, 5)))
    assert found.p == pytest.approx(np.full(12, 2 / 32)) and (holm(found.p) > 0.05).all()


def test_twenty_equal_runs_are_seldom_called_different_in_any_of_twelve_channels():
    rng, none = np.random.default_rng(5), np.zeros(20, bool)
    counts, wrong = multiplicities(rng, 20, 50), 0
    for _ in range(400):
        above, below = rng.standard_normal((2, 20, 12)) ** 2 + 0.5
        wrong += bool((holm(ensemble_improvement(above, below, none, none, 2, counts).p) <= 0.05).any())
    assert wrong <= stats.binom.ppf(0.999, 400, 0.05)


def test_few_runs_with_the_same_errors_show_no_difference():
    errors, none = np.array([[1.0], [2.0], [3.0]]), np.zeros(3, bool)
    found = ensemble_improvement(errors, errors, none, none, 2, np.ones((10, 3)))
    assert (found.estimate[0], found.low[0], found.high[0], found.p[0]) == (0.0, 0.0, 0.0, 1.0)


def test_five_equal_runs_would_mislead_a_bootstrap_more_often_than_not(monkeypatch):
    """Why few runs have an interval and a p value of their own."""
    monkeypatch.setattr(ensembles, "BOOTSTRAP_RUNS", 0)
    rng, none, wrong = np.random.default_rng(7), np.zeros(5, bool), 0
    for trial in range(200):
        counts = multiplicities(np.random.default_rng(trial), 5, 500)
        above, below = np.exp(0.5 * rng.standard_normal((2, 5, 12)))
        wrong += bool((holm(ensemble_improvement(above, below, none, none, 2, counts).p) <= 0.05).any())
    assert wrong > 100


def test_a_level_of_few_runs_has_students_interval_on_its_logarithm():
    rng = np.random.default_rng(8)
    values = 1.0 + 1e-4 * rng.standard_normal((6, 1))  # so near to one that the logarithm is linear
    found = ensemble_level(values, np.zeros(6, bool), 1, rng, 100)
    interval = stats.ttest_1samp(values[:, 0], 1.0).confidence_interval(0.95)
    assert (found.low[0], found.high[0]) == pytest.approx((interval.low, interval.high), abs=1e-7)


@pytest.mark.parametrize("runs", [6, 60])
def test_an_error_that_is_zero_in_every_run_is_zero_without_doubt(runs):
    values = np.column_stack([np.zeros(runs), np.linspace(1.0, 2.0, runs)])
    found = ensemble_level(values, np.zeros(runs, bool), 2, np.random.default_rng(1), 50)
    assert (found.estimate[0], found.low[0], found.high[0]) == (0.0, 0.0, 0.0)
    assert 0.0 < found.low[1] < found.estimate[1] < found.high[1]
