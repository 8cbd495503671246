"""Autocorrelation and Ljung-Box against analytic autocorrelations and a statistic computed by hand."""

import numpy as np
import pytest
from scipy import stats

from robins.diagnostics import whiteness


def test_autocorrelation_of_a_moving_average_is_theta_over_one_plus_theta_squared(rng):
    theta, n = 0.6, 100_000
    noise = rng.standard_normal(n + 1)
    result = whiteness.autocorrelation(noise[1:] + theta * noise[:-1], 5)
    assert result.values[0] == 1.0
    assert result.values[1] == pytest.approx(theta / (1 + theta**2), abs=4 / np.sqrt(n))
    np.testing.assert_allclose(result.values[2:], 0, atol=5 * 1.4 / np.sqrt(n))  # Bartlett: variance (1 + 2 rho_1^2) / n


def test_autocorrelation_is_the_sum_of_products_over_the_sum_of_squares(rng):
    samples = rng.standard_normal(40)
    centred = samples - samples.mean()
    expected = [centred[lag:] @ centred[: 40 - lag] / (centred @ centred) for lag in range(6)]
    np.testing.assert_allclose(whiteness.autocorrelation(samples, 5).values, expected, rtol=1e-12, atol=1e-14)


def test_white_noise_stays_within_the_band_at_95_percent_of_the_lags(rng):
    result = whiteness.autocorrelation(rng.standard_normal(20_000), 400)
    assert result.band == pytest.approx(1.959964 / np.sqrt(20_000))
    outside = np.count_nonzero(np.abs(result.values[1:]) > result.band)
    low, high = stats.binom.ppf([1e-4, 1 - 1e-4], 400, 0.05)
    assert low <= outside <= high


def test_ljung_box_is_what_its_formula_gives_by_hand():
    # centred 1 0 -1 0 1 0 -1 0: r_1 = 0, r_2 = (-1 -1 -1) / 4 = -3/4; Q = n (n + 2) (r_1^2 / 7 + r_2^2 / 6), n = 8
    result = whiteness.ljung_box([1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0, 0.0], lags=2)
    expected = 8 * 10 * (9 / 16) / 6
    assert result.statistic == pytest.approx(expected)
    assert result.p_value == pytest.approx(np.exp(-expected / 2))  # chi-squared with two degrees of freedom


def test_ljung_box_has_the_size_it_promises(rng):
    rejected = sum(whiteness.ljung_box(rng.standard_normal(300)).p_value < 0.05 for _ in range(400))
    low, high = stats.binom.ppf([1e-4, 1 - 1e-4], 400, 0.06)  # slightly liberal at n = 300
    assert low <= rejected <= high


def test_first_lag_of_white_noise_is_not_significant_and_that_of_a_random_walk_is(rng):
    noise = rng.standard_normal(2000)
    white, walk = whiteness.first_lag(noise), whiteness.first_lag(np.cumsum(noise))
    assert white.p_value > 1e-4
    assert white.ci_high - white.ci_low == pytest.approx(2 * 1.959964 / np.sqrt(2000))
    assert walk.statistic > 0.98
    assert walk.p_value < 1e-12
