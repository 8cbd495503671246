"""Geometric means and paired ratios: hand numbers, identities, an independent bootstrap, coverage, failures as losses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from robins.evaluate.geometric import geometric_mean, geometric_ratio, mean_of_logs
from robins.evaluate.intervals import proportion_interval
from robins.foundation.randomness import stream

RESAMPLES = 999


def generator(name="bootstrap"):
    return stream(0, f"test/geometric/0/{name}")


def lognormal(runs, centre=0.0, spread=0.4, name="errors"):
    return np.exp(centre + spread * generator(name).standard_normal(runs))


def mean_of(values, failed=()):
    return geometric_mean(values, np.isin(np.arange(len(values)), failed), generator(), RESAMPLES)


def ratio_of(numerator, denominator, lost=(), won=()):
    numbers = np.arange(len(numerator))
    return geometric_ratio(numerator, denominator, np.isin(numbers, lost), np.isin(numbers, won), generator(), RESAMPLES)


def test_a_geometric_mean_by_hand():
    found = mean_of(np.array([1.0, 10.0, 100.0]))
    assert found.estimate == pytest.approx(10.0) and (found.median, found.upper) == (10.0, 100.0)
    assert (found.n, found.failed) == (3, 0)
    low, high = stats.t.interval(0.95, 2, loc=np.log(10.0), scale=stats.sem(np.log([1.0, 10.0, 100.0])))
    assert (found.low, found.high) == pytest.approx((np.exp(low), np.exp(high)))  # few runs: Student


def test_an_interval_of_many_runs_is_scipys_percentile_bootstrap():
    values = lognormal(60)
    reference = stats.bootstrap(
        (np.log(values),), np.mean, n_resamples=9999, method="percentile", rng=generator("scipy")
    ).confidence_interval  # fmt: skip
    found = geometric_mean(values, np.zeros(60, bool), generator(), 9999)
    np.testing.assert_allclose(np.log([found.low, found.high]), reference, atol=0.01)


@pytest.mark.parametrize("runs", [20, 50])
def test_intervals_cover_the_true_mean_as_often_as_they_say(runs):
    hits = 0
    for draw in range(300):
        low, high = mean_of_logs(generator(f"draw-{runs}-{draw}").standard_normal(runs), generator(f"resample-{draw}"), 400)
        hits += low <= 0.0 <= high
    assert proportion_interval(hits, 300).high > 0.93  # a percentile interval of 50 runs covers a little less than 95 %
    assert proportion_interval(hits, 300).low < 0.96


def test_a_ratio_is_the_geometric_mean_of_single_ratios_and_turns_round_with_its_sides():
    above, below = lognormal(60, -0.3, name="a"), lognormal(60, name="b")
    found, back = ratio_of(above, below), ratio_of(below, above)
    assert found.estimate == pytest.approx(stats.gmean(above / below))
    assert found.estimate == pytest.approx(mean_of(above).estimate / mean_of(below).estimate)
    assert (found.estimate, found.low, found.high) == pytest.approx((1 / back.estimate, 1 / back.high, 1 / back.low), rel=1e-6)
    assert found.better.estimate == pytest.approx(np.mean(above < below)) and found.better.n == 60


def test_what_both_filters_share_does_not_widen_a_paired_ratio():
    shared, own = lognormal(60, spread=2.0, name="shared"), lognormal(60, spread=0.01, name="own")
    found = ratio_of(0.5 * shared * own, shared)
    assert found.high / found.low < 1.01 and found.low < 0.5 * stats.gmean(own) < found.high


def test_equal_filters_have_a_ratio_of_one_without_width_and_none_wins():
    found = ratio_of(lognormal(60), lognormal(60))
    assert (found.estimate, found.low, found.high, found.better.estimate) == (1.0, 1.0, 1.0, 0.0)


@given(st.integers(0, 59), st.floats(0.1, 10.0))
def test_a_failed_run_moves_the_interval_against_its_filter_and_leaves_the_estimate(run, scale):
    above, below = scale * lognormal(60, name="a"), lognormal(60, name="b")
    sound = ratio_of(np.delete(above, run), np.delete(below, run))
    lost, won = ratio_of(above, below, lost=[run]), ratio_of(above, below, won=[run])
    assert lost.estimate == won.estimate == pytest.approx(sound.estimate)
    assert lost.high >= won.high and lost.low >= won.low
    assert (lost.numerator_failed, lost.denominator_failed, lost.survivors, lost.n) == (1, 0, 59, 60)
    assert lost.better.estimate * 60 == pytest.approx(sound.better.estimate * 59)
    assert won.better.estimate * 60 == pytest.approx(sound.better.estimate * 59 + 1)


def test_a_run_that_failed_in_both_is_won_by_neither():
    found = ratio_of(np.full(60, 0.5), np.ones(60), lost=[3], won=[3])
    assert found.better.estimate == pytest.approx(59 / 60) and found.low < 0.5 <= found.high < 1.0


def test_a_failed_run_has_an_infinite_error_in_the_quantiles_and_none_in_the_mean():
    found = mean_of(np.array([1.0, 10.0, np.nan]), failed=[2])
    assert found.estimate == pytest.approx(np.sqrt(10.0)) and (found.median, found.upper) == (10.0, np.inf)
    assert (found.n, found.failed) == (3, 1)


@pytest.mark.parametrize("survivors", [0, 1])
def test_with_fewer_than_two_survivors_nothing_is_known(survivors):
    values, failed = np.ones(5), range(survivors, 5)
    found = mean_of(values, failed)
    assert (found.low, found.high) == (0.0, np.inf) and np.isnan(found.estimate) == (survivors == 0)
    if survivors == 0:
        ratio = ratio_of(values, values, lost=failed)
        assert np.isnan(ratio.estimate) and (ratio.low, ratio.high, ratio.survivors) == (0.0, np.inf, 0)


@pytest.mark.parametrize("wrong", [0.0, -1.0, np.nan, np.inf])
def test_an_error_that_is_not_positive_and_finite_is_refused_unless_its_run_failed(wrong):
    values = np.array([1.0, wrong, 2.0])
    with pytest.raises(ValueError, match="not positive and finite"):
        mean_of(values)
    with pytest.raises(ValueError, match="not positive and finite"):
        ratio_of(np.ones(3), values)
    assert mean_of(values, failed=[1]).failed == 1


def test_no_run_is_refused():
    with pytest.raises(ValueError, match="no run"):
        mean_of(np.array([]))
    with pytest.raises(ValueError, match="no run"):
        ratio_of(np.array([]), np.array([]))
