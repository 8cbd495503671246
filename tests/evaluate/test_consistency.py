"""Consistency: chi-square bands and normalised squares."""

import numpy as np
import pytest

from robins.evaluate.consistency import chi_square_band, mean_nis_interval, normalised_squared
from robins.foundation.randomness import stream


@pytest.mark.parametrize(
    "dof, samples, low, high",
    [(6, 50, 5.08, 7.00), (2, 50, 1.48, 2.59)],  # the second: Bar-Shalom et al. 2001, section 5.4
)
def test_bands_are_those_of_the_literature(dof, samples, low, high):
    band = chi_square_band(dof, samples)
    assert band.expected == dof
    assert band.low == pytest.approx(low, abs=0.005)
    assert band.high == pytest.approx(high, abs=0.005)


def test_bands_of_many_samples_approach_the_normal_ones():
    # mean dof, variance 2 dof / samples; the skewness moves both ends up by about (z^2 - 1) 2/3 / samples
    half, shift = 1.959964 * np.sqrt(2 * 9 / 200), (1.959964**2 - 1) * 2 / 3 / 200
    np.testing.assert_allclose(chi_square_band(9, 200)[1:], [9 - half + shift, 9 + half + shift], atol=5e-4)


def test_one_sample_of_two_degrees_has_the_exponential_band():
    # chi-square with two degrees of freedom is exponential with mean 2
    band = chi_square_band(2, 1)
    np.testing.assert_allclose([band.low, band.high], [-2 * np.log(0.975), -2 * np.log(0.025)], rtol=1e-12)


def test_normalised_square_is_the_squared_norm_of_the_whitened_vector():
    rng = stream(0, "test/consistency/0/vectors")
    roots = rng.standard_normal((7, 4, 4)) + 4 * np.eye(4)
    white = rng.standard_normal((7, 4))
    vectors = np.einsum("kij,kj->ki", roots, white)
    covariances = roots @ np.swapaxes(roots, -1, -2)
    np.testing.assert_allclose(normalised_squared(vectors, covariances), np.sum(white**2, axis=1), rtol=1e-10)


def test_one_covariance_history_serves_all_runs():
    rng = stream(0, "test/consistency/0/broadcast")
    errors = rng.standard_normal((6, 5, 3))
    covariances = np.diag([1.0, 4.0, 9.0]) * np.arange(1, 6)[:, None, None]
    expected = np.sum(errors**2 / np.array([1.0, 4.0, 9.0]), axis=-1) / np.arange(1, 6)
    np.testing.assert_allclose(normalised_squared(errors, covariances), expected, rtol=1e-13)


def test_a_singular_covariance_is_an_error():
    with pytest.raises(np.linalg.LinAlgError):
        normalised_squared(np.ones(2), np.zeros((2, 2)))


def test_mean_of_honest_normalised_squares_is_within_its_band():
    rng = stream(0, "test/consistency/0/honest")
    nis = rng.chisquare(8, size=(200, 50))
    interval = mean_nis_interval(nis)
    sigma = np.sqrt(2 * 8 / nis.size)
    assert interval.n == 200
    assert interval.estimate == pytest.approx(8, abs=4 * sigma)
    # half-width of the Student interval: t(0.975, 199) = 1.972 standard errors; its own relative error is 5 %
    assert (interval.high - interval.low) / 2 == pytest.approx(1.972 * sigma, rel=0.2)


def test_correlated_epochs_do_not_narrow_the_interval():
    rng = stream(0, "test/consistency/0/correlated")
    once = rng.chisquare(8, size=(100, 1))
    repeated, single = mean_nis_interval(np.repeat(once, 50, axis=1)), mean_nis_interval(once)
    np.testing.assert_allclose(repeated[:3], single[:3], rtol=1e-12)
