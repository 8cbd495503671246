"""Noise laws: their moments against quadrature, scipy and draws, their modes, and what their skewness does to a robust mean."""

import numpy as np
import pytest
from scipy import stats
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from robins.foundation.noise_laws import GaussianMixture, Normal, ZeroMode, gaussian_mixture, normal_inverse_gaussian, robust_location
from robins.foundation.randomness import stream

SKEWNESS, EXCESS = 2.64, 19.91
SHARES = (0.02, 0.05, 0.10)
DRAWS = 606 * 33_000  # twenty million
GYROSCOPE = normal_inverse_gaussian(SKEWNESS, EXCESS)
MIXTURES = {
    0.02: GaussianMixture(0.02, core_mean=-0.068523, core_sd=0.763519, outlier_mean=3.357635, outlier_sd=3.151362),
    0.05: GaussianMixture(0.05, core_mean=-0.092074, core_sd=0.621903, outlier_mean=1.749411, outlier_sd=3.070826),
    0.10: GaussianMixture(0.10, core_mean=-0.124988, core_sd=0.344624, outlier_mean=1.124896, outlier_sd=2.743195),
}
"""Solutions found beforehand by another route, to six decimals."""

LAWS = {
    "normal": Normal(),
    "nig": GYROSCOPE,
    "nig-left": normal_inverse_gaussian(-1.0, 5.0),
    "nig-symmetric": normal_inverse_gaussian(0.0, 6.0),
    **{f"mixture-{share}": gaussian_mixture(share, SKEWNESS, EXCESS) for share in SHARES},
    "nig-zero-mode": ZeroMode(GYROSCOPE),
    "mixture-zero-mode": ZeroMode(gaussian_mixture(0.05, SKEWNESS, EXCESS)),
}
every_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())


def expectation(law, function):
    """E[function(x)] by adaptive quadrature, finer where the core is."""
    ends = (-80.0, -8.0, -1.0, 0.0, 1.0, 8.0, 80.0)
    return sum(quad(lambda x: function(x) * law.pdf(x), *part, limit=200, epsabs=1e-13)[0] for part in zip(ends, ends[1:], strict=False))


@pytest.fixture(scope="module")
def draws():
    """Draws of the gyroscope's law, in records of 3300 (one drive at 10 Hz)."""
    return GYROSCOPE.sample(stream(1, "test/noise-laws/0/gyroscope"), (DRAWS // 3300, 3300))


@every_law
def test_the_moments_of_the_density_are_the_analytic_ones_and_the_variance_is_one(law):
    assert expectation(law, lambda x: 1.0) == pytest.approx(1.0, abs=1e-9)
    assert expectation(law, lambda x: x) == pytest.approx(law.mean, abs=1e-9)
    for power, moment in ((2, 1.0), (3, law.skewness), (4, law.excess_kurtosis + 3.0)):
        assert expectation(law, lambda x, power=power: (x - law.mean) ** power) == pytest.approx(moment, abs=1e-8)


@every_law
def test_the_mode_is_where_the_density_is_largest(law):
    found = minimize_scalar(lambda x: -law.pdf(x), bounds=(law.mode - 0.4, law.mode + 0.3), method="bounded", options={"xatol": 1e-10})
    assert law.mode == pytest.approx(found.x, abs=1e-7)


@every_law
def test_draws_follow_the_density(law):
    sample = np.sort(law.sample(stream(1, "test/noise-laws/0/density"), (200_000,)))
    grid = np.linspace(law.mode - 3.0, law.mode + 6.0, 19)
    ends = zip(grid, grid[1:], strict=False)
    masses = np.array([quad(law.pdf, low, high)[0] for low, high in ends])
    shares = np.diff(np.searchsorted(sample, grid)) / sample.size
    np.testing.assert_allclose(shares, masses, atol=5e-3, rtol=0)
    assert np.all(np.abs(shares - masses) < 5.0 * np.sqrt(masses / sample.size) + 1e-5)


def test_the_normal_inverse_gaussian_law_has_the_given_moments_and_the_numbers_of_the_closed_form():
    assert GYROSCOPE.skewness == pytest.approx(SKEWNESS, abs=1e-12)
    assert GYROSCOPE.excess_kurtosis == pytest.approx(EXCESS, abs=1e-12)
    assert (GYROSCOPE.a, GYROSCOPE.b) == pytest.approx((0.31969382, 0.14954522), abs=5e-9)
    assert (GYROSCOPE.location, GYROSCOPE.scale) == pytest.approx((-0.24865313, 0.46982124), abs=5e-9)
    assert GYROSCOPE.mode == pytest.approx(-0.2158, abs=5e-5)
    assert ZeroMode(GYROSCOPE).mean == pytest.approx(0.2158, abs=5e-5)
    raw_reading = normal_inverse_gaussian(SKEWNESS, EXCESS - 3.0)
    assert (raw_reading.a, raw_reading.b) == pytest.approx((0.4724236, 0.2609019), abs=5e-8)


@pytest.mark.parametrize("name", ["nig", "nig-left", "nig-symmetric"])
def test_scipy_knows_the_same_law(name):
    law = LAWS[name]
    peer = stats.norminvgauss(law.a, law.b, loc=law.location, scale=law.scale)
    np.testing.assert_allclose(peer.stats("mvsk"), (0.0, 1.0, law.skewness, law.excess_kurtosis), atol=1e-12)
    x = np.linspace(-8.0, 20.0, 57)
    np.testing.assert_allclose(law.pdf(x), peer.pdf(x), rtol=1e-10)


@pytest.mark.parametrize(("skewness", "excess"), [(2.64, 5.0 / 3.0 * 2.64**2), (0.0, 0.0), (1.0, 1.0), (0.0, -1.0), (np.nan, 3.0)])
def test_moments_that_no_normal_inverse_gaussian_law_has_are_refused(skewness, excess):
    with pytest.raises(ValueError, match="no normal-inverse-Gaussian law"):
        normal_inverse_gaussian(skewness, excess)


@pytest.mark.parametrize("share", SHARES)
def test_the_mixture_has_mean_zero_variance_one_and_the_given_moments(share):
    law = gaussian_mixture(share, SKEWNESS, EXCESS)
    moments = (law.mean, law.variance, law.skewness, law.excess_kurtosis)
    assert moments == pytest.approx((0.0, 1.0, SKEWNESS, EXCESS), abs=1e-12)
    np.testing.assert_allclose(law.parts, MIXTURES[share].parts, atol=6e-7)


def test_moments_that_no_mixture_has_are_refused():
    with pytest.raises(ValueError, match="0 mixtures with 0.02 outliers"):
        gaussian_mixture(0.02, SKEWNESS, SKEWNESS**2 - 2.5)


def test_twenty_million_draws_have_the_published_skewness_and_kurtosis(draws):
    """.03 and .6 are four of the standard errors that the law's moments up to the eighth give by the delta method."""
    moments = [expectation(GYROSCOPE, lambda x, power=power: x**power) for power in range(9)]
    skewness_gradient = {3: 1.0, 2: -1.5 * SKEWNESS, 1: -3.0}
    kurtosis_gradient = {4: 1.0, 2: -2.0 * (EXCESS + 3.0), 1: -4.0 * SKEWNESS}
    for gradient, found, expected, margin in (
        (skewness_gradient, stats.skew(draws, axis=None), SKEWNESS, 0.03),
        (kurtosis_gradient, stats.kurtosis(draws, axis=None), EXCESS, 0.6),
    ):
        variance = sum(g * h * (moments[i + j] - moments[i] * moments[j]) for i, g in gradient.items() for j, h in gradient.items())
        assert margin == pytest.approx(4.0 * np.sqrt(variance / draws.size), rel=0.1)
        assert abs(found - expected) < margin


@pytest.mark.parametrize(
    ("length", "skewness", "excess", "skewness_margin", "excess_margin"),
    [(3300, (1.72, 3.96), (8.9, 43.9), 0.10, (0.8, 3.0)), (33_000, (2.30, 3.10), (14.6, 28.8), 0.10, (1.0, 3.0))],
)
def test_one_record_does_not_determine_the_moments(draws, length, skewness, excess, skewness_margin, excess_margin):
    """95 % ranges of the sample moments, against ranges found beforehand from some hundred records: the margins are their errors."""
    records = draws.reshape(-1, length)
    found = np.quantile(stats.skew(records, axis=1), (0.025, 0.975))
    np.testing.assert_allclose(found, skewness, atol=skewness_margin)
    low, high = np.quantile(stats.kurtosis(records, axis=1), (0.025, 0.975))
    assert low == pytest.approx(excess[0], abs=excess_margin[0])
    assert high == pytest.approx(excess[1], abs=excess_margin[1])


@pytest.mark.parametrize(("width", "bias", "tolerance"), [(1.0, -0.141, 2e-3), (1.5, -0.113, 2e-3), (3.0, -0.063, 2e-3)])
def test_correntropy_is_biased_by_skewed_noise(width, bias, tolerance):
    assert robust_location(GYROSCOPE, lambda e: np.exp(-0.5 * (e / width) ** 2)) == pytest.approx(bias, abs=tolerance)


def test_the_bias_falls_with_the_square_of_a_wide_kernel():
    """To first order in 1/width^2 the root of E[(1 - e^2 / 2 width^2) e] = 0 lies at minus the third moment over 2 width^2."""
    for width in (100.0, 1000.0):
        found = robust_location(GYROSCOPE, lambda e, width=width: np.exp(-0.5 * (e / width) ** 2))
        assert found == pytest.approx(-SKEWNESS / (2.0 * width**2), rel=0.02)


def test_huber_is_biased_by_skewed_noise():
    assert robust_location(GYROSCOPE, lambda e: 1.345 / max(abs(e), 1.345)) == pytest.approx(-0.071, abs=2e-3)


def test_a_robust_mean_of_draws_goes_where_the_quadrature_says(draws):
    sample, m = draws.ravel()[:2_000_000], 0.0
    for _ in range(12):
        weights = np.exp(-0.5 * (sample - m) ** 2)
        m = weights @ sample / weights.sum()
    assert m == pytest.approx(robust_location(GYROSCOPE, lambda e: np.exp(-0.5 * e * e)), abs=4.0 * 2.0 / np.sqrt(sample.size))


def test_zero_mode_noise_is_the_same_draws_moved():
    moved = LAWS["nig-zero-mode"].sample(stream(1, "a/b/0/c"), (50, 3))
    np.testing.assert_allclose(moved - GYROSCOPE.sample(stream(1, "a/b/0/c"), (50, 3)), 0.2158, atol=5e-5)
