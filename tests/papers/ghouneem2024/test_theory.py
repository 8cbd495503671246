"""Analytic numbers of the brief (check 14), and moments of the transform against integrals."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import expon, norm

from robins.kalman.predict import unscented
from robins.papers.ghouneem2024.theory import LAWS, MEAN, POWERS, SD, central_moments, exact, linearised, transformed

DIGITS = {21.0: 1, 103.92: 2, 0.0825: 4, 0.0162: 4, 11.5: 1, 7.8: 1, 22.46: 2}
"""The brief's numbers, and how many decimals it gives of each."""


@pytest.fixture(scope="module")
def table(results):
    return results.table("theory")


def test_14_every_analytic_number_is_the_briefs_to_its_last_digit(table):
    rows = table[table["topic"] == "analytic"]
    assert set(rows["expected"]) == set(DIGITS) and len(rows) == len(DIGITS)
    for row in rows.itertuples():
        assert round(row.value, DIGITS[row.expected]) == pytest.approx(row.expected, abs=1e-12), row.quantity


def test_a_uniform_azimuth_has_the_rms_of_half_a_turn_over_root_three():
    assert np.sqrt(quad(lambda angle: angle**2 / 360.0, -180.0, 180.0)[0]) == pytest.approx(103.92, abs=0.005)


def law(name):
    return norm(MEAN, SD) if name == "normal" else expon(MEAN - SD, SD)


@pytest.mark.parametrize("name", LAWS)
def test_central_moments_are_those_of_the_law(name):
    standard = norm(0, 1) if name == "normal" else expon(-1, 1)
    found = central_moments(name, 6)
    expected = [standard.expect(lambda x, k=k: x**k, epsabs=1e-12) for k in range(7)]
    np.testing.assert_allclose(found, expected, atol=1e-6, rtol=1e-6)


@pytest.mark.parametrize("power", POWERS.values())
@pytest.mark.parametrize("name", LAWS)
def test_exact_moments_are_integrals_over_the_density(name, power):
    mean = law(name).expect(lambda x: x**power, epsabs=1e-12)
    variance = law(name).expect(lambda x: (x**power - mean) ** 2, epsabs=1e-12)
    np.testing.assert_allclose(exact(name, power), (mean, variance), rtol=1e-6)


def test_the_transform_has_mean_and_variance_of_a_square_of_a_normal_number_and_no_more():
    """Mean and variance of the square are exact with the paper's beta; the mean of the cube too, its variance not."""
    points = unscented(1, 0.1, 2.0, 0.0)
    np.testing.assert_allclose(transformed(points, 2), exact("normal", 2), rtol=1e-9)
    mean, variance = transformed(points, 3)
    assert mean == pytest.approx(exact("normal", 3)[0], rel=1e-9)
    assert abs(variance / exact("normal", 3)[1] - 1.0) > 0.01


def test_a_skewed_law_is_beyond_the_transform_in_the_third_order_already():
    points = unscented(1, 0.1, 2.0, 0.0)
    assert transformed(points, 2)[0] == pytest.approx(exact("exponential", 2)[0], rel=1e-9)
    assert abs(transformed(points, 2)[1] / exact("exponential", 2)[1] - 1.0) > 0.1
    assert abs(transformed(points, 3)[0] / exact("exponential", 3)[0] - 1.0) > 0.01


def test_a_first_order_expansion_misses_the_mean_by_half_the_curvature_times_the_variance():
    assert exact("normal", 2)[0] - linearised(2)[0] == pytest.approx(SD**2)
    assert linearised(3)[1] == pytest.approx(9 * SD**2)


def test_the_table_has_every_law_map_method_and_moment(table):
    rows = table[table["topic"] == "moments"]
    assert list(table.columns) == ["topic", "quantity", "expected", "value", "unit"]
    assert len(rows) == 2 * 2 * 3 * 2 and rows["quantity"].is_unique and np.isfinite(rows["value"]).all()
