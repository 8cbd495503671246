"""Intervals: hand numbers, identities, independent implementations and coverage."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats
from statsmodels.stats.multitest import multipletests
from statsmodels.stats.proportion import proportion_confint

from robins.evaluate import intervals
from robins.evaluate.intervals import (
    bca_log_interval,
    ensemble_improvement,
    ensemble_level,
    ensemble_value,
    holm,
    mean_interval,
    multiplicities,
    paired_ratio,
    proportion_interval,
)
from robins.foundation.randomness import stream

errors_of_runs = st.lists(st.floats(1e-6, 1e6), min_size=2, max_size=30)


def generator(name="bootstrap"):
    return stream(0, f"test/intervals/0/{name}")


def lognormal(runs, centre, spread, name):
    return np.exp(centre + spread * generator(name).standard_normal(runs))


def test_student_interval_of_five_hand_numbers():
    # 1..5: mean 3, variance 2.5, standard error sqrt(0.5); t(0.975, 4) = 2.776445 from tables.
    interval = mean_interval(np.array([1.0, 2.0, 3.0, 4.0, 5.0]))
    half = 2.7764451 * np.sqrt(0.5)
    assert interval.estimate == 3.0 and interval.n == 5
    np.testing.assert_allclose([interval.low, interval.high], [3 - half, 3 + half], rtol=1e-8)


def test_student_interval_of_several_channels_is_that_of_each_alone():
    values = generator().standard_normal((12, 3, 2))
    together = mean_interval(values)
    assert together.low.shape == (3, 2)
    alone = mean_interval(values[:, 2, 1])
    np.testing.assert_allclose([together.low[2, 1], together.high[2, 1]], [alone.low, alone.high], rtol=1e-14)


def test_one_run_has_an_infinitely_wide_interval():
    assert mean_interval(np.array([2.0])) == (2.0, -np.inf, np.inf, 1)


@pytest.mark.parametrize("values", [[], [1.0, np.nan], [np.inf]])
def test_a_mean_of_nothing_or_of_failed_runs_is_refused(values):
    with pytest.raises(ValueError, match="leave failed runs out"):
        mean_interval(np.array(values))


@pytest.mark.parametrize("successes, n", [(0, 10), (1, 10), (5, 10), (10, 10), (37, 1000), (999, 1000)])
def test_wilson_interval_equals_that_of_statsmodels(successes, n):
    expected = proportion_confint(successes, n, method="wilson")
    interval = proportion_interval(successes, n)
    np.testing.assert_allclose([interval.low, interval.high], expected, atol=1e-14)
    assert interval.estimate == successes / n


def test_wilson_interval_at_no_success_ends_at_the_closed_form():
    z = 1.959963984540054
    interval = proportion_interval(0, 10)
    assert interval.low == 0.0
    assert interval.high == pytest.approx(z**2 / (10 + z**2), rel=1e-12)


def test_a_share_of_no_runs_is_unknown_and_an_impossible_count_is_refused():
    unknown = proportion_interval(0, 0)
    assert np.isnan(unknown.estimate) and (unknown.low, unknown.high) == (0.0, 1.0)
    with pytest.raises(ValueError, match="11 successes among 10"):
        proportion_interval(11, 10)


def test_geometric_mean_of_two_and_eight_is_four():
    summary = paired_ratio(np.array([2.0, 8.0]), np.ones(2), generator())
    half = 1.959963984540054 * np.std([np.log(2), np.log(8)], ddof=1) / np.sqrt(2)
    assert summary.estimate == pytest.approx(4.0, rel=1e-14)
    np.testing.assert_allclose([summary.low, summary.high], [4 * np.exp(-half), 4 * np.exp(half)], rtol=1e-12)
    assert summary.median == pytest.approx(5.0)


@settings(max_examples=50, deadline=None)
@given(errors_of_runs)
def test_a_filter_compared_with_itself_is_exactly_one(values):
    summary = paired_ratio(np.array(values), np.array(values), generator())
    assert summary[:7] == (1.0,) * 7
    assert (summary.central_low, summary.central_high, summary.median) == (1.0, 1.0, 1.0)
    assert summary.share_below_one.estimate == 0.0


@settings(max_examples=30, deadline=None)
@given(st.lists(st.tuples(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3)), min_size=2, max_size=20))
def test_swapping_the_filters_inverts_the_ratio(pairs):
    a, b = np.array(pairs).T
    forward, backward = paired_ratio(a, b, generator(), 200), paired_ratio(b, a, generator(), 200)
    assert forward.estimate == pytest.approx(1 / backward.estimate, rel=1e-9)
    for low, high in (("low", "high"), ("bca_low", "bca_high"), ("verdict_low", "verdict_high"), ("central_low", "central_high")):
        assert getattr(forward, low) == pytest.approx(1 / getattr(backward, high), rel=1e-6)
    assert forward.low <= forward.estimate * (1 + 1e-12) and forward.estimate <= forward.high * (1 + 1e-12)
    ties = np.mean(np.abs(np.log(a) - np.log(b)) < intervals.TIE)
    assert forward.share_below_one.estimate + backward.share_below_one.estimate + ties == pytest.approx(1.0)


def test_the_same_ratio_in_every_run_has_no_uncertainty():
    denominator = lognormal(20, 0.0, 1.0, "level")
    summary = paired_ratio(0.5 * denominator, denominator, generator())
    np.testing.assert_allclose(summary[:7], 0.5, rtol=1e-12)


def test_a_difference_of_rounding_size_is_a_tie():
    numerator = lognormal(20, 0.0, 1.0, "level")
    summary = paired_ratio(numerator * (1 - 1e-12), numerator, generator())
    assert summary.estimate == summary.low == summary.high == 1.0
    assert summary.share_below_one.estimate == 0.0


@pytest.mark.parametrize("cells", [1, 37, 10**6])
def test_bca_interval_is_that_of_scipy_whatever_the_batch(monkeypatch, cells):
    monkeypatch.setattr(intervals, "BATCH_CELLS", cells)
    a, b = lognormal(60, 0.1, 0.5, "a"), lognormal(60, 0.0, 0.5, "b")
    summary = paired_ratio(a, b, generator(), 300)
    expected = stats.bootstrap((np.log(a / b),), np.mean, n_resamples=300, method="BCa", rng=generator()).confidence_interval
    # ours rounds the means of the resamples to ten decimals, see `rounded_mean`
    np.testing.assert_allclose([summary.bca_low, summary.bca_high], np.exp([expected.low, expected.high]), rtol=2e-10)


def test_normal_interval_covers_the_true_ratio_as_often_as_theory_says():
    runs, trials, truth = 50, 4000, np.log(0.8)
    logs = truth + 0.4 * generator("coverage").standard_normal((trials, runs))
    ends = np.array([intervals.log_interval(row)[1:] for row in logs])
    covered = np.mean((ends[:, 0] < truth) & (truth < ends[:, 1]))
    expected = 2 * stats.t.cdf(intervals.Z, runs - 1) - 1  # a normal quantile with an estimated spread: 0.944
    assert covered == pytest.approx(expected, abs=4 * np.sqrt(expected * (1 - expected) / trials))


def test_bca_interval_covers_a_skewed_mean_within_two_per_cent():
    runs, trials = 100, 600
    rng = generator("skewed")
    covered = 0
    for row in rng.standard_exponential((trials, runs)):
        low, high = intervals.bca_log_interval(row, rng, 400)
        covered += low < 1.0 < high
    # 4 standard errors of a share of 0.95 over the trials are 0.036; BCa at this n loses at most 0.02.
    assert 0.95 - 0.02 - 0.036 < covered / trials < 0.95 + 0.036


def test_a_failed_run_is_a_loss_for_its_filter():
    ratios = np.array([0.5, 0.6, 0.7, 0.8, 1.2, np.nan, np.nan, np.nan])
    lost = np.array([0, 0, 0, 0, 0, 1, 0, 1], dtype=bool)
    won = np.array([0, 0, 0, 0, 0, 0, 1, 1], dtype=bool)
    summary = paired_ratio(ratios, np.ones(8), generator(), 200, lost, won)
    assert (summary.n, summary.survivors, summary.failed) == (8, 5, 3)
    assert (summary.numerator_failed, summary.denominator_failed) == (2, 2)
    assert summary.estimate == pytest.approx(np.prod(ratios[:5]) ** 0.2)
    assert summary.share_below_one.estimate == 5 / 8  # four survivors and the run that only the other filter lost
    assert summary.median == pytest.approx(np.median([0.5, 0.6, 0.7, 0.8, 1.2, np.inf, 0.0, 1.0]))
    logs = np.log([0.5, 0.6, 0.7, 0.8, 1.2, 1.2, 0.5, 1.0])
    half = intervals.Z * logs.std(ddof=1) / np.sqrt(8)
    np.testing.assert_allclose([summary.verdict_low, summary.verdict_high], np.exp(logs.mean() + np.array([-half, half])), rtol=1e-12)


def test_the_stand_in_for_a_failed_run_is_never_on_its_winning_side():
    logs = np.log(np.array([0.5, 0.6]))
    filled = intervals.with_losses(logs, np.array([0, 0, 1], dtype=bool), np.zeros(3, dtype=bool))
    assert filled.tolist() == [*logs, 0.0]


def test_median_is_infinite_when_most_runs_fail():
    lost = np.array([False, True, True])
    assert paired_ratio(np.ones(3), np.ones(3), generator(), 50, lost).median == np.inf


def test_without_survivors_the_level_is_unknown_and_every_run_is_lost():
    summary = paired_ratio(np.full(4, np.nan), np.ones(4), generator(), 50, np.ones(4, dtype=bool))
    assert np.isnan(summary.estimate) and (summary.low, summary.high) == (0.0, np.inf)
    assert summary.share_below_one.estimate == 0.0 and summary.survivors == 0


@pytest.mark.parametrize("bad", [np.nan, np.inf, 0.0, -1.0])
def test_an_unmarked_run_without_a_positive_finite_error_is_refused(bad):
    with pytest.raises(ValueError, match="not marked as failed"):
        paired_ratio(np.array([1.0, bad]), np.ones(2), generator())


@pytest.mark.parametrize("a, b", [(np.ones(3), np.ones(2)), (np.ones(0), np.ones(0)), (np.ones((2, 2)), np.ones((2, 2)))])
def test_runs_that_cannot_be_paired_are_refused(a, b):
    with pytest.raises(ValueError, match="paired runs"):
        paired_ratio(a, b, generator())


def test_the_bootstrap_interval_does_not_hang_on_the_last_bit():
    """In a small sample some resamples are permutations of it: their means equal the sample's but for round-off."""
    generator = np.random.default_rng(4)
    for _ in range(50):
        logs = generator.normal(size=8)
        intervals = [bca_log_interval(logs + shift, np.random.default_rng(1), 200) for shift in (0.0, 1e-13)]
        np.testing.assert_allclose(intervals[1], intervals[0], rtol=0, atol=1e-9)


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
    assert 1.0 <= found.low[0] < 2.0 < found.high[0] <= 3.0
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
