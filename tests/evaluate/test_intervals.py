"""Intervals: hand numbers, identities, independent implementations and coverage."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats
from statsmodels.stats.proportion import proportion_confint

from robins.evaluate import intervals
from robins.evaluate.intervals import (
    bca_log_interval,
    mean_interval,
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
