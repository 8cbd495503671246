"""Huber's weight and the multi-kernel correntropy's: definitions, limits, invariances and influence."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robins.kalman.filter import run_filter
from robins.kalman.m_estimators import correntropy, correntropy_weights, huber, huber_weights
from robins.kalman.predict import Ekf
from robins.kalman.update import update, workspace
from robins.kalman.weights import weighting

SEEDS = st.integers(0, 2**32 - 1)
WIDTHS, MIXING = (1.5, 3.0, 8.0), (0.3, 0.4, 0.3)
KERNELS = {
    "huber": (huber_weights, huber(1.345)),
    "single kernel": (correntropy_weights, correntropy((1.5,), (1.0,))),
    "three kernels": (correntropy_weights, correntropy(WIDTHS, MIXING)),
}


def weights_of(kernel, method, innovation, predicted=None, R=None):
    """Weights; of a standardised innovation where no covariance is given."""
    m = len(innovation)
    weights = np.ones(m)
    predicted, R = (np.zeros((m, m)), np.eye(m)) if R is None else (predicted, R)
    kernel(np.asarray(innovation, float), predicted, R, method.parameters, method.memory, 0, weights)
    return weights


def mixture_by_definition(e, widths, mixing):
    """imani2026 equation (40), divided by its value at zero."""
    w = sum(eta / sigma**2 * np.exp(-(e**2) / (2 * sigma**2)) for sigma, eta in zip(widths, mixing, strict=True))
    return w / sum(eta / sigma**2 for sigma, eta in zip(widths, mixing, strict=True))


def test_hubers_weight_is_one_up_to_the_threshold_and_falls_as_its_inverse_beyond():
    weights = weights_of(*KERNELS["huber"], [0.0, -1.345, 1.345, 2.69, -13.45])
    np.testing.assert_allclose(weights, [1.0, 1.0, 1.0, 0.5, 0.1], rtol=1e-15)


@pytest.mark.parametrize("count", [1, 3, 15])
def test_the_correntropy_weight_is_its_definition_for_any_number_of_channels(count):
    e = np.linspace(-9.0, 12.0, count)
    for widths, mixing in (((2.0,), (1.0,)), (WIDTHS, MIXING), ((0.5, 0.7, 1.0, 4.0, 9.0), (0.2,) * 5)):
        np.testing.assert_allclose(
            weights_of(correntropy_weights, correntropy(widths, mixing), e), mixture_by_definition(e, widths, mixing), rtol=1e-13
        )


@pytest.mark.parametrize("name", KERNELS)
def test_an_innovation_is_measured_by_the_diagonal_of_its_covariance(name, random_covariance):
    rng = np.random.default_rng(5)
    innovation, predicted, R = 3.0 * rng.normal(size=4), random_covariance(rng, 4), random_covariance(rng, 4)
    standardised = innovation / np.sqrt(np.diag(predicted + R))
    np.testing.assert_allclose(weights_of(*KERNELS[name], innovation, predicted, R), weights_of(*KERNELS[name], standardised), rtol=1e-13)


@given(SEEDS, st.sampled_from(sorted(KERNELS)))
def test_units_signs_and_the_order_of_channels_do_not_matter(random_covariance, seed, name):
    """Another unit for each channel; the order, because each channel is looked at by itself."""
    rng = np.random.default_rng(seed)
    innovation, predicted, R = 4.0 * rng.normal(size=4), random_covariance(rng, 4), random_covariance(rng, 4)
    expected = weights_of(*KERNELS[name], innovation, predicted, R)
    assert np.all((expected > 0.0) & (expected <= 1.0))
    D = np.diag(rng.choice([-1.0, 1.0], 4) * 10.0 ** rng.uniform(-6, 6, 4))
    np.testing.assert_allclose(weights_of(*KERNELS[name], D @ innovation, D @ predicted @ D, D @ R @ D), expected, rtol=1e-12)
    order = rng.permutation(4)
    turned = np.ix_(order, order)
    np.testing.assert_array_equal(weights_of(*KERNELS[name], innovation[order], predicted[turned], R[turned]), expected[order])


def updated(innovation, H, P, R, kernel, method):
    """State correction, from zero, of one weighted update."""
    m, n = H.shape
    x, zero = np.zeros(n), np.zeros((m, m))
    weights = weights_of(kernel, method, innovation, H @ P @ H.T, R)
    update(x, P.copy(), innovation, H, R, zero, np.zeros((n, m)), False, weights, workspace(n, m))
    return x


@pytest.mark.parametrize("name", KERNELS)
def test_degrees_instead_of_radians_change_neither_weights_nor_update(name, random_covariance):
    """A11 of the wing: accelerometer channels as they are, gyroscope channels in other units."""
    rng = np.random.default_rng(6)
    H, P, R = rng.normal(size=(6, 9)), 1e-3 * random_covariance(rng, 9), np.diag([0.05**2] * 3 + [0.002**2] * 3)
    innovation = 4.0 * np.sqrt(np.diag(H @ P @ H.T + R)) * rng.normal(size=6)
    D = np.diag([1.0] * 3 + [180.0 / np.pi] * 3)
    expected = updated(innovation, H, P, R, *KERNELS[name])
    assert np.abs(expected).max() > 1e-4
    np.testing.assert_allclose(updated(D @ innovation, D @ H, P, D @ R @ D, *KERNELS[name]), expected, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(
    ("name", "influence"),
    [("huber", lambda y: np.minimum(y, 1.345)), ("single kernel", lambda y: y * np.exp(-(y**2) / 4.5))],
)
def test_the_influence_saturates_for_huber_and_redescends_for_a_kernel(name, influence):
    """Proposition 6: a channel dominated by R moves the state by K w(y) y, to first order in P / R."""
    P, y = 1e-8, np.linspace(0.0, 7.0, 29)
    moved = [updated(np.array([value]), np.eye(1), P * np.eye(1), np.eye(1), *KERNELS[name])[0] for value in y]
    np.testing.assert_allclose(np.array(moved) / P, influence(y), rtol=1e-6, atol=1e-9)
    peak = y[np.argmax(moved)]
    assert peak == (1.5 if name == "single kernel" else peak)  # the kernel's width


def run(problem, method):
    case = problem(4)
    return run_filter(Ekf(), case.model, case.sensor, method, *case.arguments, 4, False)


LIMITS = {
    "huber 1e9": (huber(1e9), 0.0),
    "huber without end": (huber(np.inf), 0.0),
    "width 1e8": (correntropy((1e8,), (1.0,)), 1e-10),
    "widths from 1e8": (correntropy((1e8, 2e8, 5e8), MIXING), 1e-10),
    "infinite width": (correntropy((np.inf,), (1.0,)), 0.0),
    "infinite widths": (correntropy((np.inf,) * 3, MIXING), 0.0),
    "width 1e200": (correntropy((1e200,), (1.0,)), 0.0),
}


@pytest.mark.parametrize("limit", LIMITS)
def test_wide_kernels_and_thresholds_have_the_plain_filter_as_their_limit(problem, limit):
    method, tolerance = LIMITS[limit]
    plain, limited = run(problem, weighting("unit")), run(problem, method)
    np.testing.assert_allclose(limited.posterior, plain.posterior, rtol=0, atol=tolerance)
    np.testing.assert_allclose(limited.posterior_variance, plain.posterior_variance, rtol=0, atol=tolerance)


@pytest.mark.parametrize("name", KERNELS)
def test_the_usual_settings_are_another_filter_than_the_plain_one(problem, name):
    plain, active = run(problem, weighting("unit")), run(problem, KERNELS[name][1])
    assert np.abs(active.posterior - plain.posterior).max() > 0.01
    assert np.all(active.failed == -1)


def test_an_infinite_width_has_no_part_beside_finite_ones():
    e = np.linspace(0.0, 5.0, 6)
    mixed = weights_of(correntropy_weights, correntropy((np.inf, 2.0), (0.6, 0.4)), e)
    np.testing.assert_allclose(mixed, weights_of(correntropy_weights, correntropy((2.0,), (1.0,)), e), rtol=1e-15)


def test_a_kernel_without_mixing_weight_has_no_part():
    e = np.linspace(0.0, 5.0, 6)
    mixed = weights_of(correntropy_weights, correntropy((1e-3, 2.0, np.inf), (0.0, 1.0, 0.0)), e)
    np.testing.assert_array_equal(mixed, weights_of(correntropy_weights, correntropy((2.0,), (1.0,)), e))


@pytest.mark.parametrize("widths", [(1e-200,), (1e-200, 1e200), WIDTHS])
def test_nothing_to_explain_has_weight_one_and_no_width_overflows(widths):
    mixing = np.full(len(widths), 1 / len(widths))
    np.testing.assert_array_equal(weights_of(correntropy_weights, correntropy(widths, mixing), [0.0]), 1.0)


def test_a_weight_too_small_for_its_inverse_is_zero():
    """exp(-38.5^2 / 2) is a number still, but R divided by it is none."""
    np.testing.assert_array_equal(weights_of(correntropy_weights, correntropy((1.0,), (1.0,)), [38.5, 1e3, 1e200]), 0.0)
    assert weights_of(correntropy_weights, correntropy((1.0,), (1.0,)), [20.0])[0] == pytest.approx(np.exp(-200.0))


@pytest.mark.parametrize("name", KERNELS)
def test_an_innovation_that_is_not_a_number_has_no_weight_either(name):
    weights = weights_of(*KERNELS[name], [np.nan, 0.0])
    assert np.isnan(weights[0]) and weights[1] == 1.0


@pytest.mark.parametrize("threshold", [0.0, -1.0, np.nan])
def test_a_threshold_that_is_not_positive_is_refused(threshold):
    with pytest.raises(ValueError, match=r"^threshold: .* is not positive$"):
        huber(threshold)


@pytest.mark.parametrize(
    ("widths", "mixing", "message"),
    [
        ((1.0, 0.0), (0.5, 0.5), r"^widths: \[1.0, 0.0\] are not all positive$"),
        ((1.0, -2.0), (0.5, 0.5), r"^widths: "),
        ((1.0, np.nan), (0.5, 0.5), r"^widths: "),
        ((1.0, 2.0), (1.0,), r"^mixing: 1 weights for 2 widths$"),
        ((1.0,), (0.5, 0.5), r"^mixing: 2 weights for 1 widths$"),
        ((), (), r"^mixing: \[\] are not weights that sum to one$"),
        ((1.0, 2.0), (1.5, -0.5), r"^mixing: \[1.5, -0.5\] are not weights that sum to one$"),
        ((1.0, 2.0), (0.5, 0.4), r"^mixing: "),
        ((1.0, 2.0), (np.nan, 1.0), r"^mixing: "),
    ],
)
def test_kernels_that_are_no_mixture_are_refused(widths, mixing, message):
    with pytest.raises(ValueError, match=message):
        correntropy(widths, mixing)
