"""Linear algebra for the small matrices of a Kalman filter, without allocation.

Plain loops beat a BLAS call below about fifteen states. All functions write into arrays that the
caller owns; ``out`` must not share memory with an input unless the docstring allows it. Zero factors
are skipped in `multiply` and `congruence`: transition matrices are mostly zeros, and the test for zero
finds that structure without a table of it.
"""

import numpy as np
from numba import njit


@njit(cache=True)
def assign(A, out):
    """``out = A`` for two matrices of one shape.

    A loop, because ``out[:] = A`` makes every caller compile the text of a shape error, which takes seconds.
    """
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            out[i, j] = A[i, j]


@njit(cache=True)
def multiply(A, B, out):
    """``out = A B`` for shapes ``(n, k)``, ``(k, m)``, ``(n, m)``; skips zeros of `A`."""
    n, inner = A.shape
    m = B.shape[1]
    for i in range(n):
        for j in range(m):
            out[i, j] = 0.0
        for k in range(inner):
            factor = A[i, k]
            if factor != 0.0:
                for j in range(m):
                    out[i, j] += factor * B[k, j]


@njit(cache=True)
def times_vector(A, x, out):
    """``out = A x`` for shapes ``(n, k)``, ``(k,)``, ``(n,)``."""
    for i in range(A.shape[0]):
        total = 0.0
        for k in range(A.shape[1]):
            total += A[i, k] * x[k]
        out[i] = total


@njit(cache=True)
def congruence(T, A, out):
    """``out = T A^T`` where the result is known to be symmetric (``T = A P``): upper half, then mirrored."""
    n, inner = A.shape
    for i in range(n):
        for j in range(i, n):
            total = 0.0
            for k in range(inner):
                factor = A[j, k]
                if factor != 0.0:
                    total += T[i, k] * factor
            out[i, j] = total
            out[j, i] = total


@njit(cache=True)
def cholesky(S, L):
    """Lower Cholesky factor of `S` into `L` (upper half set to zero); both ``(m, m)``.

    Returns False, leaving `L` undefined, when a pivot is not positive or not finite.
    """
    m = S.shape[0]
    for j in range(m):
        pivot = S[j, j]
        for k in range(j):
            pivot -= L[j, k] * L[j, k]
        if not (pivot > 0.0 and pivot < np.inf):
            return False
        root = np.sqrt(pivot)
        L[j, j] = root
        for i in range(j + 1, m):
            total = S[i, j]
            for k in range(j):
                total -= L[i, k] * L[j, k]
            L[i, j] = total / root
            L[j, i] = 0.0
    return True


@njit(cache=True)
def whiten(L, b, out):
    """``out = L^-1 b`` for a lower triangular ``(m, m)`` factor; `out` may be `b`."""
    for i in range(L.shape[0]):
        total = b[i]
        for k in range(i):
            total -= L[i, k] * out[k]
        out[i] = total / L[i, i]


@njit(cache=True)
def solve_rows(L, B):
    """Overwrite every row ``b`` of `B`, shape ``(n, m)``, by ``(L L^T)^-1 b``: ``B <- B S^-1`` for ``S = L L^T``."""
    m = L.shape[0]
    for r in range(B.shape[0]):
        for i in range(m):
            total = B[r, i]
            for k in range(i):
                total -= L[i, k] * B[r, k]
            B[r, i] = total / L[i, i]
        for i in range(m - 1, -1, -1):
            total = B[r, i]
            for k in range(i + 1, m):
                total -= L[k, i] * B[r, k]
            B[r, i] = total / L[i, i]
