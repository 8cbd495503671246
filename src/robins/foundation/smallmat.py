"""Linear algebra for the small matrices of a Kalman filter, without allocation.

All functions write into arrays that the caller owns; ``out`` must not share memory with an input unless the
docstring allows it. Zero factors are skipped where a docstring says so: transition matrices are mostly zeros, and
the test for zero finds that structure without a table of it.

``python -m benchmarks`` times ``F P F^T + Q`` against BLAS. Loops that take three factors at a time, since states come as vectors of
space, and skip three zeros are about as fast with 9 states; from 15 on they are slower, there by half. They are used at every size
all the same, because their rounding does not depend on a library's choice for a processor.
"""

import numpy as np
from numba import njit

kernel = njit(cache=True, error_model="numpy", _nrt=False, forceinline=True, no_cfunc_wrapper=True)
"""Decorator for a function that only fills arrays which it is given.

Such a function needs no reference counts, and counting them (atomically) took a quarter of a filter's step; nor does
it allocate, take slices or raise, and a division by zero gives infinity or NaN. What it calls must be of the same kind,
or be compiled with ``_nrt=True``.
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
    """``out = A B`` for shapes ``(n, k)``, ``(k, m)``, ``(n, m)``; skips three factors of `A` in a row where all are zero."""
    n, inner = A.shape
    m = B.shape[1]
    for i in range(n):
        for j in range(m):
            out[i, j] = 0.0
    triples = inner // 3
    for triple in range(triples):  # outermost: consecutive rows of `out` then do not wait for each other
        k = 3 * triple
        for i in range(n):
            a, b, c = A[i, k], A[i, k + 1], A[i, k + 2]
            if a != 0.0 or b != 0.0 or c != 0.0:
                for j in range(m):
                    out[i, j] += a * B[k, j] + b * B[k + 1, j] + c * B[k + 2, j]
    for k in range(3 * triples, inner):
        for i in range(n):
            factor = A[i, k]
            if factor != 0.0:
                for j in range(m):
                    out[i, j] += factor * B[k, j]


@kernel
def add_product(base, scale, A, B, out):
    """``out = base + scale A B`` for full matrices of shapes ``(n, m)``, ``(n, k)``, ``(k, m)``, ``(n, m)``; `out` may be `base`.

    Six rows of `B` at a time: at these sizes a loop costs more to enter (10 ns) than to run, and one with six products takes
    half the time of six, at 9, 15 and 21 columns alike.
    """
    n, inner = A.shape
    m = B.shape[1]
    grouped = 6 if inner >= 6 else 0
    for i in range(n):
        if grouped > 0:
            a, b, c = scale * A[i, 0], scale * A[i, 1], scale * A[i, 2]
            d, e, f = scale * A[i, 3], scale * A[i, 4], scale * A[i, 5]
            for j in range(m):
                out[i, j] = base[i, j] + (a * B[0, j] + b * B[1, j] + c * B[2, j] + d * B[3, j] + e * B[4, j] + f * B[5, j])
        else:
            for j in range(m):
                out[i, j] = base[i, j]
        for k in range(grouped, inner):
            factor = scale * A[i, k]
            for j in range(m):
                out[i, j] += factor * B[k, j]


@kernel
def times_vector(A, x, out):
    """``out = A x`` for shapes ``(n, k)``, ``(k,)``, ``(n,)``."""
    for i in range(A.shape[0]):
        total = 0.0
        for k in range(A.shape[1]):
            total += A[i, k] * x[k]
        out[i] = total


@kernel
def congruence(T, A, Q, out):
    """``out = T A^T + Q`` where the result is known to be symmetric (``T = A P``): lower half, then mirrored; skips as `multiply`."""
    n, inner = A.shape
    for i in range(n):
        for j in range(n):
            out[i, j] = Q[i, j]
    triples = inner // 3
    for triple in range(triples):
        k = 3 * triple
        for i in range(n):
            a, b, c = A[i, k], A[i, k + 1], A[i, k + 2]
            if a != 0.0 or b != 0.0 or c != 0.0:
                for j in range(i + 1):
                    out[i, j] += a * T[j, k] + b * T[j, k + 1] + c * T[j, k + 2]
    for k in range(3 * triples, inner):
        for i in range(n):
            factor = A[i, k]
            if factor != 0.0:
                for j in range(i + 1):
                    out[i, j] += T[j, k] * factor
    for i in range(n):
        for j in range(i):
            out[j, i] = out[i, j]


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
    """Overwrite every row ``b`` of `B`, shape ``(n, m)``, by ``(L L^T)^-1 b``: ``B <- B S^-1`` for ``S = L L^T``.

    Three columns of `B` at a time, for the reason given in `add_product`; it is fastest where `B` is stored by columns.
    """
    m = B.shape[1]
    triples = 3 * (m // 3)
    for i in range(0, triples, 3):
        solve_three(L[i, i], L[i + 1, i], L[i + 1, i + 1], L[i + 2, i], L[i + 2, i + 1], L[i + 2, i + 2], B, i, i + 1, i + 2)
        for j in range(i + 3, m):
            subtract_three(L[j, i], L[j, i + 1], L[j, i + 2], B, i, j)
    for i in range(triples, m):
        scale_column(1.0 / L[i, i], B, i)
        for j in range(i + 1, m):
            subtract_column(L[j, i], B, i, j)
    for i in range(m - 1, triples - 1, -1):
        scale_column(1.0 / L[i, i], B, i)
        for j in range(i):
            subtract_column(L[i, j], B, i, j)
    for i in range(triples - 3, -1, -3):
        solve_three(L[i + 2, i + 2], L[i + 2, i + 1], L[i + 1, i + 1], L[i + 2, i], L[i + 1, i], L[i, i], B, i + 2, i + 1, i)
        for j in range(i):
            subtract_three(L[i, j], L[i + 1, j], L[i + 2, j], B, i, j)


@kernel
def solve_three(aa, ba, bb, ca, cb, cc, B, a, b, c):
    """Solve for the columns a, b and c of `B` by ``[[aa, 0, 0], [ba, bb, 0], [ca, cb, cc]]``, in place."""
    first, second, third = 1.0 / aa, 1.0 / bb, 1.0 / cc
    for r in range(B.shape[0]):
        x = B[r, a] * first
        y = (B[r, b] - ba * x) * second
        B[r, c] = (B[r, c] - ca * x - cb * y) * third
        B[r, a], B[r, b] = x, y


@kernel
def subtract_three(a, b, c, B, i, j):
    """Subtract multiples of the columns i, i + 1 and i + 2 of `B` from its column j."""
    for r in range(B.shape[0]):
        B[r, j] -= a * B[r, i] + b * B[r, i + 1] + c * B[r, i + 2]


@kernel
def scale_column(factor, B, i):
    """Multiply the column i of `B`."""
    for r in range(B.shape[0]):
        B[r, i] *= factor


@kernel
def subtract_column(factor, B, i, j):
    """Subtract a multiple of the column i of `B` from its column j."""
    for r in range(B.shape[0]):
        B[r, j] -= factor * B[r, i]
