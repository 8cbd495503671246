"""Small matrices: every function against numpy and scipy, over many sizes."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st

from robins.foundation import smallmat

SIZES = st.integers(1, 12)
SEEDS = st.integers(0, 2**32 - 1)
ROUNDING = {"rtol": 1e-12, "atol": 1e-12}


def sparse(rng, *shape):
    """Normal numbers, about half of them replaced by zero."""
    return rng.normal(size=shape) * (rng.random(shape) < 0.5)


def positive_definite(rng, m):
    """A well-conditioned covariance of `m` channels."""
    root = rng.normal(size=(m, m))
    return root @ root.T + np.eye(m)


@given(SIZES, SIZES, SIZES, SEEDS)
def test_products_are_those_of_numpy(n, inner, m, seed):
    rng = np.random.default_rng(seed)
    A, B, x = sparse(rng, n, inner), rng.normal(size=(inner, m)), rng.normal(size=inner)
    out, vector = np.full((n, m), np.nan), np.full(n, np.nan)
    smallmat.multiply(A, B, out)
    np.testing.assert_allclose(out, A @ B, **ROUNDING)
    smallmat.times_vector(A, x, vector)
    np.testing.assert_allclose(vector, A @ x, **ROUNDING)
    smallmat.assign(A @ B, out)
    np.testing.assert_array_equal(out, A @ B)
    smallmat.add_product(out, -2.0, A, B, out)
    np.testing.assert_allclose(out, -A @ B, **ROUNDING)
    base, columns = rng.normal(size=(n, m)), np.asfortranarray(A)
    smallmat.add_product(base, 0.5, columns, B, out)
    np.testing.assert_allclose(out, base + 0.5 * A @ B, **ROUNDING)


@given(SIZES, SIZES, SEEDS)
def test_congruence_completes_a_quadratic_form_symmetrically(n, inner, seed):
    rng = np.random.default_rng(seed)
    A, P, out = sparse(rng, n, inner), positive_definite(rng, inner), np.full((n, n), np.nan)
    Q = positive_definite(rng, n)
    Q = 0.5 * (Q + Q.T)
    smallmat.congruence(A @ P, A, Q, out)
    np.testing.assert_allclose(out, A @ P @ A.T + Q, **ROUNDING)
    np.testing.assert_array_equal(out, out.T)


@given(SIZES, SEEDS)
def test_cholesky_is_the_lower_factor_with_zeros_above(m, seed):
    S = positive_definite(np.random.default_rng(seed), m)
    L = np.full((m, m), np.nan)
    assert smallmat.cholesky(S, L)
    np.testing.assert_allclose(L, np.linalg.cholesky(S), **ROUNDING)
    np.testing.assert_array_equal(np.triu(L, 1), 0.0)


@given(SIZES, SEEDS, st.data())
def test_cholesky_says_so_when_a_matrix_is_not_positive_definite(m, seed, data):
    rng = np.random.default_rng(seed)
    basis = np.linalg.qr(rng.normal(size=(m, m)))[0]
    eigenvalues = rng.uniform(0.5, 2.0, m)
    eigenvalues[data.draw(st.integers(0, m - 1))] = -0.5
    assert not smallmat.cholesky(basis * eigenvalues @ basis.T, np.empty((m, m)))


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
@pytest.mark.parametrize("place", [0, 1, 2])
def test_cholesky_refuses_a_pivot_that_is_zero_negative_or_not_finite(value, place):
    S = np.eye(3)
    S[place, place] = value
    assert not smallmat.cholesky(S, np.empty((3, 3)))


@given(SIZES, SIZES, SEEDS)
def test_whitening_and_solving_are_triangular_solutions(n, m, seed):
    rng = np.random.default_rng(seed)
    S, b, B = positive_definite(rng, m), rng.normal(size=m), rng.normal(size=(n, m))
    L, white, expected = np.linalg.cholesky(S), np.full(m, np.nan), np.linalg.solve(S, B.T).T
    smallmat.whiten(L, b, white)
    np.testing.assert_allclose(white, scipy.linalg.solve_triangular(L, b, lower=True), **ROUNDING)
    smallmat.solve_rows(L, B)
    np.testing.assert_allclose(B, expected, rtol=1e-10, atol=1e-11)
    smallmat.whiten(L, b, b)
    np.testing.assert_array_equal(b, white)


def test_a_channel_with_an_infinite_factor_is_removed_by_whitening():
    L = np.array([[2.0, 0.0, 0.0], [0.0, np.inf, 0.0], [1.0, 0.0, 4.0]])
    white = np.empty(3)
    smallmat.whiten(L, np.array([2.0, 7.0, 9.0]), white)
    np.testing.assert_array_equal(white, [1.0, 0.0, 2.0])


def test_zero_factors_are_skipped():
    """Three factors of zero, or one after the last three, remove what they multiply, even what is not a number."""
    A = np.array([[0.0, 0.0, 0.0, 1.0, 0.0, 2.0, 0.0], [0.0, 0.0, 0.0, 3.0, 4.0, 5.0, 0.0]])
    B, out = np.arange(14.0).reshape(7, 2), np.empty((2, 2))
    B[:3], B[6] = np.nan, np.inf
    smallmat.multiply(A, B, out)
    np.testing.assert_array_equal(out, A[:, 3:6] @ B[3:6])
    smallmat.congruence(np.ascontiguousarray(B.T), A, np.zeros((2, 2)), out)
    lower = np.tril(A[:, 3:6] @ B[3:6])
    np.testing.assert_array_equal(out, lower + np.tril(lower, -1).T)
