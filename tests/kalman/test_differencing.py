"""Measurement differencing: its matrices, and the prediction that is correlated with the measurement just processed."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st

from robins.kalman.differencing import correlate_prediction, difference, differenced_measurements
from robins.kalman.update import update, workspace

SEEDS = st.integers(0, 2**32 - 1)


@pytest.fixture(scope="module")
def system(random_covariance):
    """Matrices of a random system: A, B, Q, H, A_n, Q_lambda, Q_v."""
    rng = np.random.default_rng(4)
    n, m = 3, 2
    return (0.5 * rng.normal(size=(n, n)), rng.normal(size=(n, 1)), random_covariance(rng, n), rng.normal(size=(m, n)),
            np.diag([0.9, 0.5]), 0.3 * random_covariance(rng, m), 0.5 * random_covariance(rng, m))  # fmt: skip


def test_differencing_a_scalar_random_walk_by_hand():
    one = np.eye(1)
    d = difference(one, 3 * one, 4 * one, 2 * one, 0.5 * one, 7 * one, 8 * one)
    assert d.H_d == 2 - 0.5 * 2
    assert d.D == 6
    assert d.R_process == 2 * 4 * 2 + 7
    assert d.R_sensor == 8 + 0.25 * 8
    assert d.C == 4 * 2


def test_the_difference_has_the_covariances_of_simulated_noise(system):
    """Independent: xi from its definition and 400 000 draws; each moment within five standard errors."""
    A, B, Q, H, A_n, Q_lambda, Q_v = system
    rng, count = np.random.default_rng(6), 400_000
    w, U = (rng.multivariate_normal(np.zeros(len(c)), c, count) for c in (Q, Q_lambda))
    v, v_next = (rng.multivariate_normal(np.zeros(2), Q_v, count) for _ in range(2))
    x, lam, u = rng.normal(size=(count, 3)), rng.normal(size=(count, 2)), np.array([0.7])
    z = x @ H.T + v + lam
    z_next = (x @ A.T + B @ u + w) @ H.T + v_next + lam @ A_n.T + U
    d = difference(*system)
    xi = z_next - z @ A_n.T - x @ d.H_d.T - d.D @ u
    R = d.R_process + d.R_sensor
    error = np.sqrt((np.outer(np.diag(R), np.diag(R)) + R**2) / count)
    assert np.all(np.abs(xi.T @ xi / count - R) < 5 * error)
    error = np.sqrt((np.outer(np.diag(Q), np.diag(R)) + d.C**2) / count)
    assert np.all(np.abs(w.T @ xi / count - d.C) < 5 * error)
    assert np.all(np.abs(np.hstack([x, lam]).T @ xi / count) < 5 * np.sqrt(np.diag(R) / count))


def test_differences_are_taken_along_the_epochs_and_the_last_is_zero(system):
    z = np.random.default_rng(0).normal(size=(2, 5, 2))
    mu = differenced_measurements(z, system[4])
    for run in range(2):
        for k in range(4):
            np.testing.assert_allclose(mu[run, k], z[run, k + 1] - system[4] @ z[run, k], rtol=0, atol=1e-15)
    assert not mu[:, 4].any()


def one_step(seed, n=3, m=2, weights=None):
    """Update, linear prediction and correction of a random case; the case's matrices and the result."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(n + m, n + m)) / np.sqrt(n + m)
    noise = root @ root.T + 0.2 * np.eye(n + m)  # of [w(k); v(k)]
    Q, C, R = noise[:n, :n], noise[:n, n:].copy(), noise[n:, n:].copy()
    P0 = np.cov(rng.normal(size=(n, 4 * n))) + 0.2 * np.eye(n)
    F, H, x0, innovation = rng.normal(size=(n, n)), rng.normal(size=(m, n)), rng.normal(size=n), rng.normal(size=m)
    x, P, work, zero = x0.copy(), P0.copy(), workspace(n, m), np.zeros((m, m))
    weights = np.ones(m) if weights is None else weights
    update(x, P, innovation, H, R, zero, np.zeros((n, m)), False, weights, work)
    work.F[:] = F
    x, P = F @ x, F @ P @ F.T + Q
    correlate_prediction(x, P, C, work)
    return F, Q, C, H, R, P0, x0, innovation, x, P


@given(SEEDS, st.integers(1, 6), st.integers(1, 4))
def test_update_and_correlated_prediction_are_the_one_step_predictor(seed, n, m):
    """Independent: Bryson & Henrikson's predictor with gain (F P H^T + C) S^-1."""
    F, Q, C, H, R, P0, x0, innovation, x, P = one_step(seed, n, m)
    S = H @ P0 @ H.T + R
    gain = (F @ P0 @ H.T + C) @ np.linalg.inv(S)
    np.testing.assert_allclose(x, F @ x0 + gain @ innovation, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(P, F @ P0 @ F.T + Q - gain @ S @ gain.T, rtol=1e-10, atol=1e-10)
    np.testing.assert_array_equal(P, P.T)


@given(SEEDS, st.integers(1, 6), st.integers(1, 4))
def test_the_correlated_prediction_is_the_conditional_gaussian(seed, n, m):
    """Independent formulation: the joint covariance of x(k+1) and z(k) is built, then conditioned on z(k)."""
    F, Q, C, H, R, P0, x0, innovation, x, P = one_step(seed, n, m)
    sources = scipy.linalg.block_diag(P0, np.block([[Q, C], [C.T, R]]))  # of e(k), w(k), v(k)
    outcome = np.block([[F, np.eye(n), np.zeros((n, m))], [H, np.zeros((m, n)), np.eye(m)]])
    joint = outcome @ sources @ outcome.T
    solved = scipy.linalg.solve(joint[n:, n:], joint[n:, :n], assume_a="pos").T
    np.testing.assert_allclose(x, F @ x0 + solved @ innovation, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(P, joint[:n, :n] - solved @ joint[n:, :n], rtol=1e-10, atol=1e-10)


@given(SEEDS)
def test_a_channel_of_weight_zero_takes_no_part_in_the_correlated_prediction(seed):
    F, Q, C, H, R, P0, x0, innovation, x, P = one_step(seed, 3, 3, np.array([1.0, 0.0, 1.0]))
    kept = [0, 2]
    C, H, R, innovation = C[:, kept], H[kept], R[np.ix_(kept, kept)], innovation[kept]
    S = H @ P0 @ H.T + R
    gain = (F @ P0 @ H.T + C) @ np.linalg.inv(S)
    np.testing.assert_allclose(x, F @ x0 + gain @ innovation, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(P, F @ P0 @ F.T + Q - gain @ S @ gain.T, rtol=1e-10, atol=1e-10)
