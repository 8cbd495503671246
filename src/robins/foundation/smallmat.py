"""Linear algebra for the small matrices of a Kalman filter, without allocation.

Plain loops beat a BLAS call below about fifteen states. All functions write into arrays that the
caller owns; ``out`` must not share memory with an input unless the docstring allows it. Zero factors
are skipped where a docstring says so: transition matrices are mostly zeros, and the test for zero finds
that structure without a table of it.
"""

import numpy as np
from numba import njit

kernel = njit(cache=True, error_model="numpy", _nrt=False, forceinline=True)
"""Decorator for a function that only fills arrays which it is given.

Such a function needs no reference counts, and counting them (atomically) took a quarter of a filter's step; nor does
it allocate, take slices or raise, and a division by zero gives infinity or NaN. What it calls must be of the same kind.
"""


@kernel
def assign(A, out):
    """``out = A`` for two matrices of one shape.

    A loop, because ``out[:] = A`` makes every caller compile the text of a shape error, which takes seconds.
    """
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            out[i, j] = A[i, j]


@kernel
def multiply(A, B, out):
    """``out = A B`` for shapes ``(n, k)``, ``(k, m)``, ``(n, m)``; skips zeros of `A`."""
    n, inner = A.shape
    m = B.shape[1]
    for i in range(n):
        for j in range(m):
            out[i, j] = 0.0
    for k in range(inner):  # outermost: consecutive rows of `out` then do not wait for each other
        for i in range(n):
            factor = A[i, k]
            if factor != 0.0:
                for j in range(m):
                    out[i, j] += factor * B[k, j]


@kernel
def multiply_sparse(A, B, out):
    """``out = A B`` as `multiply`, but skips zeros of `B`: for a full `A` and a `B` that is mostly zeros."""
    n, inner = A.shape
    m = B.shape[1]
    for i in range(n):
        for j in range(m):
            out[i, j] = 0.0
    for k in range(inner):
        for j in range(m):
            factor = B[k, j]
            if factor != 0.0:
                for i in range(n):
                    out[i, j] += A[i, k] * factor


@kernel
def times_vector(A, x, out):
    """``out = A x`` for shapes ``(n, k)``, ``(k,)``, ``(n,)``."""
    for i in range(A.shape[0]):
        total = 0.0
        for k in range(A.shape[1]):
            total += A[i, k] * x[k]
        out[i] = total


@kernel
def congruence(T, A, out):
    """``out = T A^T`` where the result is known to be symmetric (``T = A P``): lower half, then mirrored; skips zeros of `A`."""
    n, inner = A.shape
    for j in range(n):
        for i in range(j + 1):
            out[j, i] = 0.0
        for k in range(inner):
            factor = A[j, k]
            if factor != 0.0:
                for i in range(j + 1):
                    out[j, i] += T[i, k] * factor
        for i in range(j):
            out[i, j] = out[j, i]


@kernel
def cholesky(S, L):
    """Lower Cholesky factor of `S` into `L` (upper half set to zero); both ``(m, m)``, and `L` may be `S`.

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


@kernel
def whiten(L, b, out):
    """``out = L^-1 b`` for a lower triangular ``(m, m)`` factor; `out` may be `b`."""
    for i in range(L.shape[0]):
        total = b[i]
        for k in range(i):
            total -= L[i, k] * out[k]
        out[i] = total / L[i, i]


@kernel
def solve_rows(L, B):
    """Overwrite every row ``b`` of `B`, shape ``(n, m)``, by ``(L L^T)^-1 b``: ``B <- B S^-1`` for ``S = L L^T``."""
    n, m = B.shape
    for i in range(m):
        for k in range(i):
            factor = L[i, k]
            for r in range(n):  # innermost: no row waits for another
                B[r, i] -= factor * B[r, k]
        inverse = 1.0 / L[i, i]
        for r in range(n):
            B[r, i] *= inverse
    for i in range(m - 1, -1, -1):
        for k in range(i + 1, m):
            factor = L[k, i]
            for r in range(n):
                B[r, i] -= factor * B[r, k]
        inverse = 1.0 / L[i, i]
        for r in range(n):
            B[r, i] *= inverse
