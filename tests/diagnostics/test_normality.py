"""The tests of normality against hand-computed statistics, known limits and the size they promise."""

import numpy as np
import pytest
from scipy import stats

from robins.diagnostics import normality


def test_kolmogorov_smirnov_statistic_is_the_largest_gap_of_the_empirical_distribution():
    # eight samples of a uniform law; the steps of the empirical distribution are 1/8. Largest gap by hand: just below
    # 0.7, where 4 samples lie beneath and the law has 0.7: 0.7 - 4/8 = 0.2
    samples = [0.1, 0.2, 0.3, 0.45, 0.7, 0.75, 0.9, 0.95]
    assert normality.kolmogorov_smirnov(samples, stats.uniform()).statistic == pytest.approx(0.2)


def test_jarque_bera_is_what_its_formula_gives_by_hand():
    # 2 x (-1, -1, -1, 3) has mean 0, m2 = 3, m3 = 6, m4 = 21: g = 6 / 3^1.5, k - 3 = 21/9 - 3
    samples = [-1.0, -1.0, -1.0, 3.0] * 2
    expected = 8 / 6 * ((6 / 3**1.5) ** 2 + (21 / 9 - 3) ** 2 / 4)
    result = normality.jarque_bera(samples)
    assert result.statistic == pytest.approx(expected)
    assert result.p_value == pytest.approx(np.exp(-expected / 2))  # chi-squared with two degrees of freedom


def test_shapiro_wilk_weighs_normal_quantiles_as_normal_and_an_outlier_as_not(rng):
    quantiles = stats.norm.ppf((np.arange(200) + 0.5) / 200)
    assert normality.shapiro_wilk(quantiles, rng).p_value > 0.99
    quantiles[-1] = 20.0
    assert normality.shapiro_wilk(quantiles, rng).p_value < 1e-6


def test_shapiro_wilk_uses_a_whole_series_up_to_its_limit(rng):
    samples = rng.standard_normal(normality.SHAPIRO_LIMIT)
    result = normality.shapiro_wilk(samples, rng)
    assert (result.n, result.note) == (5000, "")
    assert result.statistic == stats.shapiro(samples).statistic


def test_shapiro_wilk_thins_a_longer_series_by_its_generator_and_says_so():
    samples = np.random.default_rng(4).standard_normal(20_000)
    first, again, other = (normality.shapiro_wilk(samples, np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert first.n == 5000
    assert "subsample" in first.note
    assert first == again
    assert first.statistic != other.statistic


def test_estimated_parameters_need_lilliefors_because_the_known_law_test_hardly_ever_rejects(rng):
    # normal samples tested against their own fit: Lilliefors keeps its 10 %, the uncorrected test stays near 0 %
    corrected = uncorrected = 0
    for _ in range(300):
        samples = rng.standard_normal(60)
        corrected += normality.lilliefors(samples).p_value < 0.10
        fitted = stats.norm(samples.mean(), samples.std(ddof=1))
        uncorrected += normality.kolmogorov_smirnov(samples, fitted).p_value < 0.10
    low, high = stats.binom.ppf([1e-4, 1 - 1e-4], 300, 0.10)
    assert low <= corrected <= high
    assert uncorrected < low


def test_lilliefors_statistic_is_the_gap_to_the_fitted_normal_law(rng):
    samples = np.sort(rng.exponential(size=50))
    fitted = stats.norm.cdf(samples, samples.mean(), samples.std(ddof=1))
    gaps = np.concatenate([np.arange(1, 51) / 50 - fitted, fitted - np.arange(50) / 50])
    assert normality.lilliefors(samples).statistic == pytest.approx(gaps.max())


@pytest.mark.parametrize(
    ("samples", "message"),
    [
        (np.zeros(20), "constant"),
        (np.arange(7.0), "8 or more"),
        (np.zeros((10, 2)), "one channel"),
        (np.r_[np.nan, np.arange(20.0), np.inf], "2 of 22 samples are not finite"),
    ],
)
def test_samples_that_cannot_be_tested_are_refused_with_the_reason(samples, message):
    with pytest.raises(ValueError, match=message):
        normality.jarque_bera(samples)


def test_thinning_never_draws_a_sample_twice(rng):
    # of 5001 evenly spread normal quantiles one is left out, which hardly shows; repeated draws would leave ties and gaps
    quantiles = stats.norm.ppf((np.arange(5001) + 0.5) / 5001)
    assert 1 - normality.shapiro_wilk(quantiles, rng).statistic < 1e-4
    assert 1 - stats.shapiro(rng.choice(quantiles, 5000)).statistic > 1e-4
