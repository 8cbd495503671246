"""The one measurement update: three independent implementations, weights, and what happens when it cannot be done."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st

from robins.kalman.update import innovation_covariance, joseph, update, update_error, weighted_noise, workspace

SEEDS = st.integers(0, 2**32 - 1)
DIMENSIONS = st.tuples(st.integers(1, 8), st.integers(1, 5))


class Case:
    """A random prior, sensor and measurement; `correlated` adds a cross-covariance that keeps the joint covariance positive."""

    def __init__(self, seed, n, m, correlated=False, diagonal=False):
        rng = np.random.default_rng(seed)
        root = rng.normal(size=(n + m, n + m)) / np.sqrt(n + m)
        joint = root @ root.T + 0.3 * np.eye(n + m)  # of the state's error and the measurement noise
        self.x, self.P, self.H, self.innovation = rng.normal(size=n), joint[:n, :n].copy(), rng.normal(size=(m, n)), rng.normal(size=m)
        self.R = np.diag(np.diag(joint[n:, n:])) if diagonal else joint[n:, n:].copy()
        self.C = joint[:n, n:].copy() if correlated else np.zeros((n, m))
        self.R_fixed, self.correlated, self.weights = np.zeros((m, m)), correlated, np.ones(m)
        self.rng = rng

    def update(self):
        """Posterior state, covariance, NIS and the workspace."""
        x, P, work = self.x.copy(), self.P.copy(), workspace(*self.C.shape)
        nis = update(x, P, self.innovation, self.H, self.R, self.R_fixed, self.C, self.correlated, self.weights, work)
        return x, P, nis, work

    def textbook(self, R=None):
        """Inverse of S and the short form of the covariance."""
        R = self.R if R is None else R
        cross = self.P @ self.H.T + self.C
        S = self.H @ self.P @ self.H.T + R + self.H @ self.C + self.C.T @ self.H.T
        K = cross @ np.linalg.inv(S)
        return self.x + K @ self.innovation, self.P - K @ S @ K.T, self.innovation @ np.linalg.inv(S) @ self.innovation, K, S


def assert_close(actual, expected, tolerance=1e-10):
    np.testing.assert_allclose(actual, expected, rtol=tolerance, atol=tolerance)


@given(SEEDS, DIMENSIONS, st.booleans(), st.booleans())
def test_the_update_is_the_textbook_one(seed, dimensions, correlated, diagonal):
    case = Case(seed, *dimensions, correlated=correlated and not diagonal, diagonal=diagonal)
    x, P, nis, work = case.update()
    expected_x, expected_P, expected_nis, K, S = case.textbook()
    assert_close(x, expected_x)
    assert_close(P, expected_P)
    assert_close(nis, expected_nis)
    assert_close(work.K, K)
    assert_close(work.S, S)
    assert_close(work.L @ work.white, case.innovation)
    np.testing.assert_array_equal(P, P.T)


@given(SEEDS, DIMENSIONS)
def test_the_update_is_the_information_form(seed, dimensions):
    """Independent formulation: information adds up, P^-1 + H^T R^-1 H."""
    case = Case(seed, *dimensions)
    x, P, _, _ = case.update()
    gathered = case.H.T @ np.linalg.inv(case.R)
    assert_close(P, np.linalg.inv(np.linalg.inv(case.P) + gathered @ case.H))
    assert_close(x, case.x + P @ gathered @ case.innovation)


@given(SEEDS, DIMENSIONS)
def test_the_update_is_batch_least_squares(seed, dimensions):
    """Independent formulation: the prior is a measurement of the state, and everything is solved at once by QR."""
    case = Case(seed, *dimensions)
    x, P, _, _ = case.update()
    whiten_prior, whiten_noise = (np.linalg.inv(np.linalg.cholesky(c)) for c in (case.P, case.R))
    design = np.vstack([whiten_prior, whiten_noise @ case.H])
    target = np.concatenate([whiten_prior @ case.x, whiten_noise @ (case.innovation + case.H @ case.x)])
    assert_close(x, np.linalg.lstsq(design, target, rcond=None)[0])
    assert_close(P, np.linalg.inv(design.T @ design))


@given(SEEDS, DIMENSIONS)
def test_a_cross_covariance_gives_the_conditional_gaussian(seed, dimensions):
    """Independent formulation: the joint covariance of state and measurement is built, then conditioned."""
    n, m = dimensions
    case = Case(seed, n, m, correlated=True)
    x, P, _, _ = case.update()
    error_and_noise = np.block([[case.P, case.C], [case.C.T, case.R]])
    to_state_and_measurement = np.block([[np.eye(n), np.zeros((n, m))], [case.H, np.eye(m)]])
    joint = to_state_and_measurement @ error_and_noise @ to_state_and_measurement.T
    solved = scipy.linalg.solve(joint[n:, n:], joint[n:, :n], assume_a="pos").T
    assert_close(x, case.x + solved @ case.innovation)
    assert_close(P, joint[:n, :n] - solved @ joint[n:, :n])


@given(SEEDS, DIMENSIONS, st.floats(0.0, 100.0))
def test_the_joseph_form_is_a_covariance_for_any_gain(seed, dimensions, size):
    n, m = dimensions
    case = Case(seed, n, m, correlated=True)
    P, K = case.P.copy(), size * case.rng.normal(size=(n, m))
    joseph(P, K.T.copy(), case.H @ P, case.H, case.R, case.C, True, np.empty((n, n)), np.empty((m, n)))
    transfer = np.block([np.eye(n) - K @ case.H, -K])  # posterior error from prior error and noise
    expected = transfer @ np.block([[case.P, case.C], [case.C.T, case.R]]) @ transfer.T
    scale = np.abs(expected).max()
    np.testing.assert_allclose(P / scale, expected / scale, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(P, P.T)
    assert np.linalg.eigvalsh(P).min() > -1e-12 * scale


@given(SEEDS, DIMENSIONS, st.booleans(), st.booleans())
def test_the_joseph_form_is_the_triple_product_to_rounding(seed, dimensions, correlated, best):
    """In any order of the products, for the best gain and for any; states in units nine decades apart, against extended precision."""
    n, m = dimensions
    case = Case(seed, n, m, correlated=correlated)
    units = 10.0 ** case.rng.uniform(-6.0, 3.0, n)
    P, C, H = np.outer(units, units) * case.P, units[:, None] * case.C, case.H / units
    S = H @ P @ H.T + case.R + H @ C + C.T @ H.T
    K = (P @ H.T + C) @ np.linalg.inv(S) if best else units[:, None] * case.rng.normal(size=(n, m))
    out = P.copy()
    joseph(out, K.T.copy(), H @ P, H, case.R, C, correlated, np.empty((n, n)), np.empty((m, n)))
    exact = [M.astype(np.longdouble) for M in (P, C, H, case.R, K)]

    def triple(P, C, H, R, K, A):
        return A @ P @ A.T + K @ R @ K.T, A @ C @ K.T + K @ C.T @ A.T

    A = np.eye(n) - exact[4] @ exact[2]
    squares, cross = triple(*exact, A)
    magnitude = sum(triple(*(np.abs(M) for M in exact), np.eye(n) + np.abs(exact[4]) @ np.abs(exact[2])))
    assert np.all(np.abs(out - (squares - cross)) <= 1e-15 * (n + m) * magnitude)


@given(SEEDS, DIMENSIONS, st.booleans())
def test_a_gain_factor_multiplies_the_columns_of_the_plain_gain(seed, dimensions, correlated):
    """Correction and covariance are those of the gain K W; S and the NIS are those of the plain update."""
    n, m = dimensions
    case, work = Case(seed, n, m, correlated=correlated), workspace(n, m)
    work.gain_factor[:] = case.rng.uniform(0.0, 1.8, m)
    P = case.P.copy()
    nis = update_error(P, case.innovation, case.H, case.R, case.R_fixed, case.C, correlated, case.weights, work)
    _, _, expected_nis, K, S = case.textbook()
    K = K * work.gain_factor
    transfer = np.block([np.eye(n) - K @ case.H, -K])
    assert_close(P, transfer @ np.block([[case.P, case.C], [case.C.T, case.R]]) @ transfer.T)
    assert_close(work.shift, K @ case.innovation)
    assert_close(work.K, K)
    assert_close(work.S, S)
    assert_close(nis, expected_nis)


@pytest.mark.parametrize(("factor", "variance"), [(0.25, 0.7083), (1.0, 0.3333), (1.6, 0.5733)])
def test_the_covariance_of_a_weighted_gain_is_the_spread_of_the_errors(factor, variance):
    """A9: one state, P = 1, R = 0.5; analytic, P (1 - kappa w (2 - w)), and by two million draws."""
    P, work, one, zero = np.eye(1), workspace(1, 1), np.eye(1), np.zeros((1, 1))
    work.gain_factor[0] = factor
    update_error(P, np.ones(1), one, 0.5 * one, zero, zero, False, np.ones(1), work)
    assert P[0, 0] == pytest.approx(1.0 - factor * (2.0 - factor) * 2.0 / 3.0, rel=1e-14) == pytest.approx(variance, abs=5e-5)
    error, noise = np.random.default_rng(9).standard_normal((2, 2_000_000)) * [[1.0], [np.sqrt(0.5)]]
    left = error - work.K[0, 0] * (error + noise)
    assert np.var(left) == pytest.approx(variance, abs=2e-3)


def test_the_update_of_an_error_leaves_the_correction_and_no_state():
    case = Case(5, 4, 3)
    x, P, nis, work = case.update()
    other, error_P = workspace(4, 3), case.P.copy()
    assert nis == update_error(error_P, case.innovation, case.H, case.R, case.R_fixed, case.C, False, case.weights, other)
    np.testing.assert_array_equal(case.x + other.shift, x)
    np.testing.assert_array_equal(error_P, P)
    np.testing.assert_array_equal(workspace(4, 3).gain_factor, 1.0)


@given(SEEDS, DIMENSIONS, st.booleans())
def test_a_weight_divides_the_noise_of_a_diagonal_r(seed, dimensions, correlated):
    case = Case(seed, *dimensions, correlated=correlated)
    case.R = np.diag(np.diag(case.R) + 1.0)
    case.weights = case.rng.uniform(0.01, 1.0, dimensions[1])
    x, P, nis, _ = case.update()
    expected_x, expected_P, expected_nis, _, _ = case.textbook(case.R / case.weights)
    assert_close(x, expected_x)
    assert_close(P, expected_P)
    assert_close(nis, expected_nis)


@given(SEEDS, DIMENSIONS)
def test_weights_act_between_the_roots_of_a_full_r_and_not_on_the_fixed_part(seed, dimensions):
    case = Case(seed, *dimensions)
    case.R_fixed = case.R + np.eye(dimensions[1])
    case.weights = case.rng.uniform(0.01, 1.0, dimensions[1])
    root = np.linalg.cholesky(case.R)
    R_bar = root @ np.diag(1 / case.weights) @ root.T + case.R_fixed
    x, P, nis, work = case.update()
    expected_x, expected_P, expected_nis, _, _ = case.textbook(R_bar)
    assert_close(work.R, R_bar)
    assert_close(x, expected_x)
    assert_close(P, expected_P)
    assert_close(nis, expected_nis)


@given(SEEDS, DIMENSIONS, st.booleans(), st.booleans(), st.data())
def test_a_weight_of_zero_deletes_its_channel_exactly(seed, dimensions, correlated, with_fixed, data):
    n, m = dimensions
    case = Case(seed, n, m, correlated=correlated)
    if with_fixed:
        case.R_fixed = case.R + np.eye(m)
    weights = case.rng.uniform(0.1, 1.0, m)
    kept = np.array(data.draw(st.lists(st.booleans(), min_size=m, max_size=m)))
    case.weights = np.where(kept, weights, 0.0)
    x, P, nis, work = case.update()
    removed = ~kept
    assert not work.K[:, removed].any() and not work.white[removed].any() and np.isinf(np.diag(work.L)[removed]).all()
    case.innovation[removed] = np.nan  # whatever it was
    np.testing.assert_array_equal(case.update()[0], x)
    case.H, case.C = case.H[kept], np.ascontiguousarray(case.C[:, kept])
    case.innovation, case.weights = case.innovation[kept], weights[kept]
    case.R, case.R_fixed = (np.ascontiguousarray(M[np.ix_(kept, kept)]) for M in (case.R, case.R_fixed))
    expected_x, expected_P, expected_nis, part = case.update()
    np.testing.assert_allclose(x, expected_x, rtol=1e-14, atol=1e-14)
    np.testing.assert_allclose(P, expected_P, rtol=1e-14, atol=1e-14)
    assert nis == pytest.approx(expected_nis, rel=1e-14)
    np.testing.assert_allclose(work.K[:, kept], part.K, rtol=1e-14, atol=1e-14)
    np.testing.assert_allclose(work.L[np.ix_(kept, kept)], part.L, rtol=1e-14, atol=1e-14)


def test_without_any_channel_nothing_changes():
    case = Case(3, 4, 3, correlated=True)
    case.weights = np.zeros(3)
    x, P, nis, _ = case.update()
    np.testing.assert_array_equal(x, case.x)
    np.testing.assert_array_equal(P, case.P)
    assert nis == 0.0


SPOILERS = {
    "S is not positive definite": {"R_fixed": -10.0 * np.eye(3)},
    "R is not positive definite": {"R": np.array([[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]])},
    "the innovation is not a number": {"innovation": np.array([1.0, np.nan, 1.0])},
    "the innovation is infinite": {"innovation": np.array([1.0, np.inf, 1.0])},
    "a weight is not a number": {"weights": np.array([1.0, np.nan, 1.0])},
    "a weight is negative": {"weights": np.array([1.0, -0.5, 1.0])},
    "a weight is infinite": {"weights": np.array([1.0, np.inf, 1.0])},
    "the prior is not finite": {"P": np.full((4, 4), np.nan)},
}


@pytest.mark.parametrize("reason", SPOILERS)
@pytest.mark.parametrize("removed", [False, True])
def test_an_update_that_cannot_be_done_is_nan_and_leaves_state_and_covariance(reason, removed):
    case = Case(1, 4, 3)
    for name, value in SPOILERS[reason].items():
        setattr(case, name, value)
    if removed:
        case.weights = case.weights * [1.0, 1.0, 0.0]
    x, P, nis, _ = case.update()
    assert np.isnan(nis)
    np.testing.assert_array_equal(x, case.x)
    np.testing.assert_array_equal(P, case.P)


def test_weighted_noise_with_unit_weights_is_r():
    R = Case(2, 1, 4).R
    out = np.empty((4, 4))
    assert weighted_noise(R, np.zeros((4, 4)), np.ones(4), out)
    np.testing.assert_allclose(out, R, rtol=1e-14)


def test_the_predicted_part_of_the_innovation_covariance_leaves_r_out():
    case = Case(4, 3, 2, correlated=True)
    PH, S = np.empty((3, 2)), np.empty((2, 2))
    innovation_covariance(case.P, case.H, np.zeros((2, 2)), case.C, True, np.ones(2), PH, S)
    assert_close(S, case.textbook()[4] - case.R)
    assert_close(PH, case.P @ case.H.T + case.C)
