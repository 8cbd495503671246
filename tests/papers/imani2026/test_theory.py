"""Propositions 2 to 9 in numbers: the brief's analytic values, and draws that agree with them."""

import numpy as np
import pytest

from robins.papers.imani2026 import theory
from robins.papers.imani2026.drive import CHANNELS, drive
from robins.papers.imani2026.formulations import formulation
from robins.papers.imani2026.observability import UNITS, information
from robins.papers.imani2026.sensors import Sensors
from robins.papers.protocol import Settings

OPTIONS = {
    "rate_hz": 10, "kernel_widths": [1.5, 3.0, 8.0], "kernel_weights": [0.3, 0.4, 0.3], "chi_square_probability": 0.95,
    "huber_threshold": 1.345,
}  # fmt: skip
SETTINGS = Settings("smoke", 1, {"runs": 8, "sweep_runs": 4}, OPTIONS)


@pytest.fixture(scope="module")
def table():
    return theory.theory(SETTINGS).table


@pytest.fixture(scope="module")
def facts(table):
    return {row.quantity: row for row in table.itertuples()}


def test_every_fact_is_finite_and_named_once(table):
    assert table["quantity"].is_unique and list(table) == ["quantity", "expected", "value", "low", "high", "n"]
    numbers = table.drop(columns="quantity").to_numpy(float)
    assert np.isfinite(numbers).all() and (table["low"] <= table["value"]).all() and (table["value"] <= table["high"]).all()


def test_draws_agree_with_what_theory_expects(facts):
    drawn = [row for row in facts.values() if row.n > 0 and not row.quantity.startswith(("sample", "share of runs"))]
    assert len(drawn) > 20
    for row in drawn:  # three half-widths: a right formula fails one of thirty with probability 1e-7
        assert abs(row.value - row.expected) <= 3 * max(row.high - row.value, row.value - row.low), row.quantity


def test_facts_without_draws_equal_what_theory_expects(facts):
    for row in facts.values():
        if row.n == 0:
            assert row.value == pytest.approx(row.expected, rel=1e-12), row.quantity


@pytest.mark.parametrize(
    ("quantity", "value", "tolerance"),
    [
        ("exceedance of 3.841, sequential increment, n = 6", 0.05, 0.002),
        ("exceedance of 3.841, difference in time, n = 6", 0.195, 0.002),
        ("exceedance of 6.635, difference in time, n = 6", 0.081, 0.002),
        ("exceedance of 3.841, difference in time, n = 1", 0.0338, 0.001),
        ("w(0) as printed, accelerometer", 73.0, 0.073),
        ("w(0) as printed, gyroscope", 4.56e4, 46),
        ("posterior variance, w = 0.25", 0.7083, 0.005),
        ("posterior variance, w = 1.6", 0.5733, 0.005),
        ("posterior variance as printed, w = 0.25", 0.8333, 5e-5),
        ("posterior variance as printed, w = 1.6", -0.0667, 5e-5),
        ("gain, printed, P/R = 17.6", 0.514, 5e-4),
        ("gain, corrected, P/R = 17.6", 0.057, 5e-4),
        ("gain, printed, P/R = 1", 0.057, 5e-4),
        ("gain, corrected, P/R = 1", 0.030, 5e-4),
        ("location bias, kernel 1 sd", -0.141, 0.004),
        ("location bias, kernel 3 sd", -0.063, 0.004),
        ("location bias, Huber 1.345", -0.071, 0.004),
        ("rms error of the reference rate, 0.1 deg of white noise", 0.0123, 1e-4),
        ("RMSE needed for an improvement of 99 %, 0.1 deg of white noise", 1.23, 0.01),
        ("P(improvement above 37%), one cell", 0.36, 0.005),
        ("P(improvement above 90%), one cell", 0.064, 0.002),
        ("P(any of 24 cells above 90%)", 0.79, 0.02),
        ("P(any of 24 cells above 99%)", 0.14, 0.02),
        ("information rank of 15 at 1e-06, F0", 8, 0),
        ("information rank of 21 at 1e-06, F1, tau = 2 s", 14, 0),
        ("information rank of 21 at 1e-06, F1", 6, 0),
        ("information rank of 21 at 1e-09, F1", 14, 0),
        ("information rank of 15 at 1e-06, F2", 6, 0),
    ],
)
def test_the_briefs_values(facts, quantity, value, tolerance):
    assert facts[quantity].value == pytest.approx(value, abs=tolerance)


@pytest.mark.parametrize(
    ("quantity", "low", "high"),
    [
        ("sample skewness, 3300 samples", 1.72, 3.96),
        ("sample excess kurtosis, 3300 samples", 8.9, 43.9),
        ("sample skewness, 33000 samples", 2.30, 3.10),
        ("sample excess kurtosis, 33000 samples", 14.6, 28.8),
    ],
)
def test_one_record_of_the_law_shows_almost_any_moments(facts, quantity, low, high):
    assert (facts[quantity].low, facts[quantity].high) == pytest.approx((low, high), rel=0.12)


def test_the_constructed_noise_is_rejected_in_every_run_and_normal_noise_is_not(facts):
    for test in ("Shapiro-Wilk", "Lilliefors"):
        assert facts[f"share of runs rejected, {test}, gyroscope"].value == 1.0
        assert facts[f"share of runs rejected, {test}, normal noise"].low < 0.05


def test_the_car_never_turns_as_fast_as_an_improvement_of_99_per_cent_needs():
    assert np.abs(drive(10).rate_n).max() == pytest.approx(0.589, abs=0.002)
    assert len(CHANNELS) * 2 == theory.CELLS


@pytest.mark.parametrize(("name", "unseen"), [("F1", ("r",)), ("F2", ("r", "v", "theta"))])
def test_what_is_never_observed_has_no_information(name, unseen):
    """Of F1's velocity only what the transport rate shows, 1e-13 of the largest eigenvalue."""
    driven = drive(1)
    matrix = information(formulation(name, 1, Sensors()), driven, Sensors())
    for i, part in enumerate(UNITS):
        if part in unseen:
            assert np.abs(matrix[3 * i : 3 * i + 3]).max() <= 1e-12 * np.abs(matrix).max()
