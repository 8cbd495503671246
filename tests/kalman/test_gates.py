"""The hard gate."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robins.kalman.filter import run_filter
from robins.kalman.gates import close_gate, gate
from robins.kalman.predict import Ekf
from robins.kalman.update import update, workspace
from robins.kalman.weights import weighting


def weights_of(threshold, innovation, predicted, R):
    method, weights = gate(threshold), np.ones(len(innovation))
    close_gate(innovation, predicted, R, method.parameters, method.memory, 0, weights)
    return weights


def test_a_channel_is_left_out_beyond_the_threshold_and_whole_up_to_it():
    predicted, R = np.diag([3.0, 3.0, 0.0, 15.0]), np.diag([1.0, 1.0, 1.0, 1.0])
    innovation = np.array([6.0, -6.001, 3.001, 11.999])  # standard deviations 2, 2, 1, 4
    np.testing.assert_array_equal(weights_of(3.0, innovation, predicted, R), [1.0, 0.0, 0.0, 1.0])


@given(st.integers(0, 2**32 - 1), st.floats(0.1, 4.0))
def test_units_signs_and_the_order_of_channels_do_not_matter(random_covariance, seed, threshold):
    rng = np.random.default_rng(seed)
    innovation, predicted, R = 3.0 * rng.normal(size=4), random_covariance(rng, 4), random_covariance(rng, 4)
    expected = weights_of(threshold, innovation, predicted, R)
    D = np.diag(rng.choice([-1.0, 1.0], 4) * 2.0 ** rng.integers(-9, 9, 4))  # powers of two: no rounding
    np.testing.assert_array_equal(weights_of(threshold, D @ innovation, D @ predicted @ D, D @ R @ D), expected)
    order = rng.permutation(4)
    turned = np.ix_(order, order)
    np.testing.assert_array_equal(weights_of(threshold, innovation[order], predicted[turned], R[turned]), expected[order])


def test_an_outlier_beyond_the_gate_moves_nothing():
    """Influence: proportional to the innovation, then zero (imani2026, the control of every robust filter)."""
    for size, moved in ((2.0, True), (4.0, False)):
        x, P, innovation, weights = np.zeros(1), np.array([[1e-4]]), np.array([size]), np.ones(1)
        weights = weights_of(3.0, innovation, P, np.eye(1))
        update(x, P, innovation, np.eye(1), np.eye(1), np.zeros((1, 1)), np.zeros((1, 1)), False, weights, workspace(1, 1))
        assert x[0] == pytest.approx(size * 1e-4 / 1.0001 if moved else 0.0, abs=1e-18)


@pytest.mark.parametrize("limit", [1e15, np.inf])
def test_a_gate_that_never_closes_is_the_plain_filter_to_the_last_bit(problem, limit):
    case = problem(3)
    plain, limited, active = (
        run_filter(Ekf(), case.model, case.sensor, method, *case.arguments, 4, False)
        for method in (weighting("unit"), gate(limit), gate(1.0))
    )
    np.testing.assert_array_equal(limited.posterior, plain.posterior)
    np.testing.assert_array_equal(limited.posterior_variance, plain.posterior_variance)
    assert np.abs(active.posterior - plain.posterior).max() > 0.01


def test_a_gate_of_zero_width_closes_every_channel(problem):
    case = problem(3)
    shut = run_filter(Ekf(), case.model, case.sensor, gate(1e-300), *case.arguments, 4, False)
    np.testing.assert_array_equal(shut.posterior, shut.prior)
    assert np.nanmax(shut.nis) == 0.0 and np.all(shut.failed == -1)


@pytest.mark.parametrize("threshold", [0.0, -1.0, np.nan])
def test_a_threshold_that_is_not_positive_is_refused(threshold):
    with pytest.raises(ValueError, match=r"^threshold: .* is not positive$"):
        gate(threshold)
