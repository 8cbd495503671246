"""The arrays of the figures: what a normal series must look like in them, and what it must not."""

import numpy as np
import pytest
from scipy import stats

from robins.diagnostics import pictures


def test_quantile_band_holds_the_promised_share_of_normal_points():
    rng = np.random.default_rng(6)
    shares = []
    for _ in range(200):
        plot = pictures.quantile_plot(rng.standard_normal(400))
        shares.append(np.mean((plot.ordered >= plot.low) & (plot.ordered <= plot.high)))
    # the band is that of the fitted law, which lies closer to the points than the true law does
    assert 0.95 < np.mean(shares) < 1.0


def test_quantile_band_is_left_by_heavy_tails():
    plot = pictures.quantile_plot(np.random.default_rng(6).standard_t(3, size=2000))
    assert plot.ordered[0] < plot.low[0]
    assert plot.ordered[-1] > plot.high[-1]


def test_middle_of_the_band_is_the_law_of_the_median():
    # for 9 samples the 5th is the median; its rank is Beta(5, 5), symmetric, so the band is centred on the mean
    samples = np.array([-4.0, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0])
    plot = pictures.quantile_plot(samples)
    assert plot.line[4] == pytest.approx(0.0, abs=1e-12)
    assert plot.low[4] == pytest.approx(-plot.high[4])
    np.testing.assert_allclose(plot.low, -plot.high[::-1])


def test_a_long_series_is_thinned_but_keeps_its_tails(rng):
    samples = rng.standard_normal(50_000)
    plot = pictures.quantile_plot(samples)
    ordered = np.sort(samples)
    assert len(plot.ordered) <= pictures.QUANTILES
    np.testing.assert_array_equal(plot.ordered[:50], ordered[:50])
    np.testing.assert_array_equal(plot.ordered[-50:], ordered[-50:])
    assert np.diff(plot.theoretical[50:-50]).max() < 0.02


def test_histogram_is_a_density_and_shows_the_fitted_and_the_true_law(rng):
    samples = rng.laplace(size=20_000)
    shown = pictures.histogram(samples, stats.laplace())
    assert np.sum(shown.density * np.diff(shown.edges)) == pytest.approx(1.0)
    np.testing.assert_allclose(shown.fitted, stats.norm.pdf(shown.grid, samples.mean(), samples.std(ddof=1)))
    np.testing.assert_allclose(shown.true, 0.5 * np.exp(-np.abs(shown.grid)))


def test_histogram_without_a_known_law_has_no_true_density(rng):
    assert pictures.histogram(rng.standard_normal(50)).true is None


def test_all_pictures_of_a_channel_come_together(rng):
    shown = pictures.pictures(rng.standard_normal(300), 10.0)
    assert shown.allan.tau[0] == pytest.approx(0.1)
    assert len(shown.autocorrelation.values) == 21
    assert len(shown.quantiles.line) == 300
