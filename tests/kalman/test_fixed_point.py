"""Iterated weights: against a textbook loop in the state's own coordinates, their limits, and what they lock out."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from robins.kalman.filter import run_filter
from robins.kalman.fixed_point import has_settled, update_iterated
from robins.kalman.gates import gate
from robins.kalman.m_estimators import correntropy, huber
from robins.kalman.predict import Ekf
from robins.kalman.update import update_error, workspace
from robins.kalman.weights import Iteration, weighting

SEEDS = st.integers(0, 2**32 - 1)
FLOOR = 1e-8


def iterated(method, limit=3, tolerance=0.0, floor=FLOOR, warm=False, prior=()):
    return method._replace(iteration=Iteration(limit, tolerance, floor, warm, np.array(prior, float)))


def kernel(width):
    return correntropy((width,), (1.0,))


def gaussian(e, width):
    return np.exp(-(e**2) / (2.0 * width**2))


class Case:
    """A random prior, sensor and innovation."""

    def __init__(self, seed, random_covariance, n=5, m=3):
        rng = np.random.default_rng(seed)
        self.P, self.R = random_covariance(rng, n), 0.3 * random_covariance(rng, m)
        self.H, self.innovation = rng.normal(size=(m, n)), 2.0 * rng.normal(size=m)

    def update(self, method):
        """Correction, posterior covariance, weights, NIS and the workspace."""
        m, n = self.H.shape
        P, work, weights = self.P.copy(), workspace(n, m), np.full(m, np.nan)
        C, memory = np.zeros((n, m)), method.memory.copy()
        nis = update_iterated(method, P, self.innovation, self.H, self.R, C, memory, 0, weights, work)
        return work.shift.copy(), P, weights, nis, work

    def plain(self):
        m, n = self.H.shape
        P, work, C, fixed = self.P.copy(), workspace(n, m), np.zeros((n, m)), np.zeros((m, m))
        nis = update_error(P, self.innovation, self.H, self.R, fixed, C, False, np.ones(m), work)
        return work.shift.copy(), P, nis, work


def textbook(case, width, limit, warm, prior_width):
    """Li et al. as they print it: factors, residuals, re-weighted P and R formed and inverted, in the state's coordinates."""
    P, R, H, y = case.P, case.R, case.H, case.innovation
    B_p, B_r, eye = np.linalg.cholesky(P), np.linalg.cholesky(R), np.eye(len(P))
    shift = P @ H.T @ np.linalg.inv(H @ P @ H.T + R) @ y if warm else np.zeros(len(P))
    for _ in range(limit):
        e_p, e_r = -np.linalg.inv(B_p) @ shift, np.linalg.inv(B_r) @ (y - H @ shift)
        w_r = np.maximum(gaussian(e_r, width), FLOOR)
        w_p = np.maximum(gaussian(e_p, prior_width), FLOOR)
        P_again, R_again = B_p @ np.diag(1 / w_p) @ B_p.T, B_r @ np.diag(1 / w_r) @ B_r.T
        K = P_again @ H.T @ np.linalg.inv(H @ P_again @ H.T + R_again)
        shift = K @ y
    return shift, (eye - K @ H) @ P @ (eye - K @ H).T + K @ R @ K.T, w_r, K


@pytest.mark.parametrize("warm", [False, True], ids=["cold", "warm"])
@pytest.mark.parametrize("prior_width", [np.inf, 2.0], ids=["prior as it is", "prior weighed"])
@given(seed=SEEDS, limit=st.integers(1, 4))
def test_the_iteration_is_the_textbook_one(random_covariance, warm, prior_width, seed, limit):
    """The prior's width is one for all, the noise's another; the weights go to both as the sources have it."""
    case, width = Case(seed, random_covariance), 1.5
    prior = kernel(prior_width).parameters if np.isfinite(prior_width) else ()
    shift, P, weights, _, work = case.update(iterated(kernel(width), limit, warm=warm, prior=prior))
    expected_shift, expected_P, expected_weights, K = textbook(case, width, limit, warm, prior_width)
    np.testing.assert_allclose(weights, expected_weights, rtol=1e-8, atol=1e-12)
    np.testing.assert_allclose(work.K, K, rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(shift, expected_shift, rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(P, expected_P, rtol=1e-8, atol=1e-9)


@given(SEEDS, st.booleans())
def test_infinite_widths_and_thresholds_are_the_plain_update(random_covariance, seed, warm):
    """A1, also where no weight is iterated away: width 1e8 and Huber's 1e9."""
    case = Case(seed, random_covariance)
    shift, P, nis, work = case.plain()
    for method in (kernel(np.inf), kernel(1e8), huber(1e9), huber(np.inf), correntropy((1e8, 2e8, 5e8), (0.3, 0.4, 0.3))):
        again = case.update(iterated(method, warm=warm, prior=method.parameters))
        np.testing.assert_allclose(again[0], shift, rtol=0, atol=1e-10)
        np.testing.assert_allclose(again[1], P, rtol=0, atol=1e-10)
        np.testing.assert_allclose(again[2], 1.0, rtol=0, atol=1e-10)
        np.testing.assert_allclose(again[4].K, work.K, rtol=0, atol=1e-10)
        assert again[3] == pytest.approx(nis, rel=1e-10)


@given(SEEDS, st.booleans())
def test_statistics_are_those_of_the_nominal_noise(random_covariance, seed, warm):
    case = Case(seed, random_covariance)
    _, _, nis, plain = case.plain()
    _, _, _, again, work = case.update(iterated(kernel(1.0), warm=warm, prior=kernel(2.0).parameters))
    assert again == pytest.approx(nis, rel=1e-12)
    for name in ("S", "L", "white"):
        np.testing.assert_allclose(getattr(work, name), getattr(plain, name), rtol=1e-10, atol=1e-12)


def test_a_whole_run_with_infinite_width_is_the_plain_filter(problem):
    """A1: every output of a run."""
    case, method = problem(3), kernel(np.inf)
    plain, limit, active = (
        run_filter(Ekf(), case.model, case.sensor, weights, *case.arguments, 4, False)
        for weights in (weighting("unit"), iterated(method, prior=method.parameters), iterated(kernel(1.0)))
    )
    for name, a, b in zip(plain._fields, plain, limit, strict=True):
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-10, err_msg=name)
    assert np.abs(active.posterior - plain.posterior).max() > 0.01


# One state, one channel.


def scalar(P, R, y, method):
    """Correction and weight of one update of one state."""
    work, weights = workspace(1, 1), np.ones(1)
    memory = method.memory.copy()
    update_iterated(method, np.array([[P]]), np.array([y]), np.eye(1), np.array([[R]]), np.zeros((1, 1)), memory, 0, weights, work)
    return work.shift[0], weights[0]


@pytest.mark.parametrize("y", [0.3, 1.5, -2.5, 4.0])
def test_the_fixed_point_of_chen_is_where_the_correntropy_is_largest(y):
    """One width for prior and noise, iterated to the end: a root of the derivative of G(x / sqrt P) + G((y - x) / sqrt R)."""
    P, R, width = 1.0, 0.5, 2.0
    method = iterated(kernel(width), 500, 1e-14, prior=kernel(width).parameters)
    shift, _ = scalar(P, R, y, method)

    def derivative(x):
        return -gaussian(x / np.sqrt(P), width) * x / P + gaussian((y - x) / np.sqrt(R), width) * (y - x) / R

    expected = brentq(derivative, 0.0, y, xtol=1e-14)
    assert shift == pytest.approx(expected, rel=1e-9)
    assert derivative(0.99 * expected) * y > 0.0 > derivative(1.01 * expected) * y  # a maximum


def test_a_jump_is_locked_out_from_the_prior_and_taken_from_least_squares():
    """Proposition 10: P >> R, a jump of ten noise sigmas, one of the prior. Only the starting point decides."""
    P, R, y, floor = 1.0, 0.01, 1.0, 1e-8
    cold, cold_weight = scalar(P, R, y, iterated(kernel(1.0), 3, floor=floor))
    warm, warm_weight = scalar(P, R, y, iterated(kernel(1.0), 3, floor=floor, warm=True))
    assert cold_weight == floor and cold == pytest.approx(P / (P + R / floor) * y, rel=1e-12)
    assert warm == pytest.approx(P / (P + R) * y, rel=1e-3) and warm_weight == pytest.approx(gaussian(0.0995, 1.0), rel=1e-3)


def test_what_takes_a_jump_takes_an_outlier_of_its_size_and_the_prior_to_noise_ratio_decides():
    """Proposition 10: one sample a step, so the innovation is all there is; five sigmas of it, started from least squares."""
    for P, taken in ((100.0, True), (0.01, False)):
        y = 5.0 * np.sqrt(P + 1.0)
        shift, _ = scalar(P, 1.0, y, iterated(kernel(1.0), 20, warm=True))
        assert (shift > 0.98 * y) if taken else (shift < 1e-3 * np.sqrt(P))


def test_floors_bound_the_weights_from_below():
    _, weight = scalar(1.0, 0.01, 100.0, iterated(kernel(1.0), 3, floor=0.125))
    assert weight == 0.125


# Iterating.


def test_an_iteration_that_has_settled_stops_and_another_goes_on(random_covariance):
    case = Case(1, random_covariance)
    once, twice, often = (case.update(iterated(kernel(1.5), limit))[0] for limit in (1, 2, 200))
    assert np.linalg.norm(twice - once) > 1e-3 * np.linalg.norm(once)
    np.testing.assert_array_equal(
        case.update(iterated(kernel(1.5), 200, tolerance=1e3, warm=True))[0], case.update(iterated(kernel(1.5), 1, warm=True))[0]
    )
    settled = case.update(iterated(kernel(1.5), 200, tolerance=1e-6))[0]
    assert 0.0 < np.linalg.norm(settled - often) < 1e-5 * np.linalg.norm(often)


def test_a_correction_has_settled_when_it_changes_by_the_tolerance_of_its_length():
    s, before = np.array([3.0, 4.0]), np.array([3.0, 4.05])
    assert has_settled(s, before, 0.0100001) and not has_settled(s, before, 0.0099999)
    assert has_settled(np.zeros(2), np.zeros(2), 0.0)


SPOILERS = {
    "P is not positive definite": {"P": -np.eye(5)},
    "R is not positive definite": {"R": np.diag([1.0, -1.0, 1.0])},
    "the innovation is not a number": {"innovation": np.array([1.0, np.nan, 1.0])},
    "the innovation is infinite": {"innovation": np.array([1.0, np.inf, 1.0])},
}


@pytest.mark.parametrize("reason", SPOILERS)
def test_an_update_that_cannot_be_done_is_nan_and_leaves_the_covariance(random_covariance, reason):
    case = Case(2, random_covariance)
    for name, value in SPOILERS[reason].items():
        setattr(case, name, value)
    _, P, _, nis, _ = case.update(iterated(kernel(1.5)))
    assert np.isnan(nis)
    np.testing.assert_array_equal(P, case.P)


@pytest.mark.parametrize("part", ["noise", "prior"])
def test_a_weight_of_zero_without_a_floor_fails_the_update(random_covariance, part):
    """A closed gate: there is no P / 0 and no R / 0, and no error of arithmetic either."""
    case, shut = Case(3, random_covariance), gate(1e-3)
    method = iterated(shut, floor=0.0) if part == "noise" else iterated(gate(1e9), floor=0.0, warm=True, prior=shut.parameters)
    _, P, _, nis, _ = case.update(method)
    assert np.isnan(nis)
    np.testing.assert_array_equal(P, case.P)


def test_weights_on_the_gain_cannot_be_iterated():
    with pytest.raises(ValueError, match="weights on the gain cannot be iterated"):
        weighting("huber", (1.345,), on_gain=True, iteration=Iteration(3, 1e-5, 1e-4, False, np.zeros(0)))
