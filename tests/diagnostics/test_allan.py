"""Allan deviation against the closed forms of white noise, random walk and quantisation, and its interval's coverage."""

import numpy as np
import pytest

from robins.diagnostics import allan

RATE = 50.0


def test_allan_variance_is_half_the_mean_square_of_differences_of_averages(rng):
    """Independent: straight from the definition, for every overlapping pair of neighbouring averages."""
    samples, factor = rng.standard_normal(200), 7
    averages = np.convolve(samples, np.full(factor, 1 / factor), mode="valid")
    overlapping = np.sqrt(0.5 * np.mean((averages[factor:] - averages[:-factor]) ** 2))
    disjoint = np.sqrt(0.5 * np.mean(np.diff(samples[:196].reshape(28, 7).mean(axis=1)) ** 2))
    assert allan.allan_deviation(samples, RATE, [factor]).deviation[0] == pytest.approx(overlapping)
    assert allan.allan_deviation(samples, RATE, [factor], overlapping=False).deviation[0] == pytest.approx(disjoint)


def test_white_noise_falls_with_the_square_root_of_the_averaging_time(rng):
    sigma = 0.3
    curve = allan.allan_deviation(sigma * rng.standard_normal(100_000), RATE)
    np.testing.assert_array_equal(curve.exponent[curve.tau < 10], 0)
    expected = sigma / np.sqrt(curve.tau * RATE)
    outside = (expected < curve.low) | (expected > curve.high)
    assert outside.sum() <= 3
    np.testing.assert_allclose(curve.deviation[curve.tau < 1], expected[curve.tau < 1], rtol=0.02)
    assert allan.slope(curve, 0.02, 2.0) == pytest.approx(-0.5, abs=0.02)


def test_random_walk_rises_with_the_square_root_of_the_averaging_time(rng):
    # K^2 tau / 3 for a continuous walk of K^2 = sigma^2 rate; the sum over samples adds half a sample at short times
    sigma = 0.01
    curve = allan.allan_deviation(np.cumsum(sigma * rng.standard_normal(100_000)), RATE)
    inside = (curve.tau >= 0.2) & (curve.tau <= 4)
    np.testing.assert_allclose(curve.deviation[inside], sigma * np.sqrt(RATE * curve.tau[inside] / 3), rtol=0.06)
    assert allan.slope(curve, 0.2, 4.0) == pytest.approx(0.5, abs=0.05)
    np.testing.assert_array_equal(curve.exponent[inside], -2)


def test_quantisation_of_the_angle_falls_with_the_averaging_time(rng):
    # white noise of variance q^2/12 on the angle: sqrt(3) Q / tau with Q = q / sqrt(12)
    quantum = 0.02
    angle = rng.uniform(-quantum / 2, quantum / 2, 50_001)
    curve = allan.allan_deviation(np.diff(angle) * RATE, RATE)
    np.testing.assert_allclose(curve.deviation, np.sqrt(3) * quantum / np.sqrt(12) / curve.tau, rtol=0.03)
    assert allan.slope(curve, curve.tau[0], curve.tau[-1]) == pytest.approx(-1, abs=0.01)


def test_interval_of_white_noise_covers_its_allan_deviation(rng):
    runs, factors = 300, np.array([1, 10, 50])
    covered = np.zeros(3)
    for _ in range(runs):
        curve = allan.allan_deviation(rng.standard_normal(1000), 1.0, factors)
        covered += (curve.low <= factors**-0.5) & (factors**-0.5 <= curve.high)
    # at 50 of 1000 samples the noise type cannot be identified and the exponent of 10 samples stands
    np.testing.assert_allclose(covered / runs, 0.95, atol=0.06)


def test_long_averages_are_never_given_the_certainty_of_quantisation(rng):
    curve = allan.allan_deviation(np.diff(rng.standard_normal(1001)), 1.0, [1, 200])
    assert curve.high[1] / curve.low[1] > 2  # five averages


def test_averaging_factors_run_in_a_one_two_five_ladder_to_a_fifth_of_the_samples():
    np.testing.assert_array_equal(allan.averaging_factors(1000), [1, 2, 5, 10, 20, 50, 100, 200])
    np.testing.assert_array_equal(allan.averaging_factors(8), [1])


def test_an_average_too_long_for_the_series_is_refused(rng):
    with pytest.raises(ValueError, match="averaging over 60 of 100 samples"):
        allan.allan_deviation(rng.standard_normal(100), 1.0, [1, 60])


def test_findings_stand_at_the_decades_of_the_averaging_time(rng):
    names = [finding.test for finding in allan.allan_findings(rng.standard_normal(700), 10.0)]
    assert names == [
        "allan deviation tau = 0.1 s",
        "allan deviation tau = 1 s",
        "allan deviation tau = 10 s",
        "allan slope tau = 0.1 to 1 s",
    ]
