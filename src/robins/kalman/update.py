"""The one measurement update. Every robust filter of this package is this routine with other weights.

``R_bar = R^1/2 diag(1/w) R^T/2 + R_fixed`` (lower Cholesky factor; see `robins.kalman.noise`), then gain by Cholesky and
covariance in Joseph form, with an optional cross-covariance C between the predicted state's error and the measurement noise:

    S = H P H^T + R_bar + H C + C^T H^T
    K = (P H^T + C) S^-1 diag(g)
    x <- x + K (z - h(x))
    P <- (I - K H) P (I - K H)^T + K R_bar K^T - (I - K H) C K^T - K C^T (I - K H)^T

The gain factors g are one unless a method weights the gain instead of the noise; the Joseph form holds for any gain. A model
whose state is not a vector (an attitude) takes the correction ``K (z - h(x))`` through `robins.kalman.model.retract`:
`update_error` leaves it in ``work.shift``, `update` adds it to the state.

A weight of zero removes its channel exactly: its row of H, of R and of the innovation and its column of C are
left out of every sum.

References: Bucy & Joseph 1968 (covariance form); Simon 2006, Optimal State Estimation, section 7.1 (correlated noise).
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from robins.foundation.smallmat import add_product, assign, cholesky, kernel, multiply, multiply_sparse, solve_rows, transpose, whiten
from robins.kalman.noise import weighted_noise


class Workspace(NamedTuple):
    """Arrays that a filter of n states and m measurements works in; one for each run.

    After `update`: `K` gain, `S` innovation covariance, `L` its lower Cholesky factor, `white` the
    innovation whitened by it. A channel of weight zero has an infinite diagonal element in `S` and `L` and zeros
    beside it, so that whitening by `L` removes it from whatever comes next; its gain is zero.
    `gain_factor` is g, ones on delivery; `shift` the correction of the (error) state.
    After `predict`: `F` transition Jacobian, `FP` = F P, the covariance between the predicted and the earlier state.

    `H` and `innovation` are the caller's to fill; the other arrays are scratch.
    """

    F: np.ndarray
    Q: np.ndarray
    FP: np.ndarray
    A: np.ndarray
    T: np.ndarray
    H: np.ndarray
    HP: np.ndarray
    TH: np.ndarray
    K: np.ndarray
    KR: np.ndarray
    S: np.ndarray
    L: np.ndarray
    R: np.ndarray
    innovation: np.ndarray
    white: np.ndarray
    gain_factor: np.ndarray
    shift: np.ndarray
    points: np.ndarray


@njit(cache=True)
def workspace(n, m):
    """A `Workspace` for `n` states and `m` measurements."""
    square, tall, small = (n, n), (n, m), (m, m)
    return Workspace(
        np.zeros(square), np.zeros(square), np.zeros(square), np.zeros(square), np.zeros(square),
        np.zeros((m, n)), np.zeros((m, n)), np.zeros(tall), np.zeros(tall), np.zeros(tall),
        np.zeros(small), np.zeros(small), np.zeros(small),
        np.zeros(m), np.zeros(m), np.ones(m), np.zeros(n), np.zeros((2 * n + 1, n)),
    )  # fmt: skip


@kernel
def cross_covariance(P, H, weights, PH):
    """``PH = P H^T`` for a symmetric P, with zeros for a channel of weight zero."""
    n, m = PH.shape
    for i in range(n):
        for j in range(m):
            PH[i, j] = 0.0
    for j in range(m):
        for k in range(n):
            factor = H[j, k]
            if factor != 0.0 and weights[j] > 0.0:
                for i in range(n):
                    PH[i, j] += P[k, i] * factor


@kernel
def kept_transpose(HP, weights, PH):
    """``PH = (H P)^T``, with zeros for a channel of weight zero."""
    for j in range(HP.shape[0]):
        for i in range(HP.shape[1]):
            PH[i, j] = HP[j, i] if weights[j] > 0.0 else 0.0


@kernel
def project(PH, H, R, weights, S):
    """``S = H PH + R``: lower half, then mirrored; nothing but R for a channel of weight zero."""
    n, m = PH.shape
    for a in range(m):
        for b in range(a + 1):
            S[a, b] = R[a, b]
        for k in range(n):
            factor = H[a, k]
            if factor != 0.0 and weights[a] > 0.0:
                for b in range(a + 1):
                    S[a, b] += factor * PH[k, b]
    for a in range(m):
        for b in range(a):
            S[b, a] = S[a, b]


@kernel
def add_correlation(H, C, weights, PH, S):
    """``PH += C`` and ``S += H C + C^T H^T`` for the channels whose weight is not zero."""
    n, m = PH.shape
    for a in range(m):
        if weights[a] > 0.0:
            for i in range(n):
                PH[i, a] += C[i, a]
            for b in range(a, m):
                if weights[b] > 0.0:
                    for k in range(n):
                        S[a, b] += H[a, k] * C[k, b] + C[k, a] * H[b, k]
                    S[b, a] = S[a, b]


@kernel
def innovation_covariance(P, H, R, C, correlated, weights, PH, S):
    """``PH = P H^T + C`` and ``S = H P H^T + R + H C + C^T H^T`` (C only where `correlated`).

    A channel of weight zero has zeros in `PH` and, besides its element of `R`, in `S`.
    """
    cross_covariance(P, H, weights, PH)
    project_correlated(H, R, C, correlated, weights, PH, S)


@kernel
def project_correlated(H, R, C, correlated, weights, PH, S):
    """`innovation_covariance` from ``PH = P H^T``."""
    project(PH, H, R, weights, S)
    if correlated:
        add_correlation(H, C, weights, PH, S)


@kernel
def times_transposed(T, H, out):
    """``out = T H^T`` for shapes ``(n, n)``, ``(m, n)``, ``(n, m)``; skips zeros of `H`."""
    n, m = out.shape
    for i in range(n):
        for j in range(m):
            out[i, j] = 0.0
    for j in range(m):
        for k in range(n):
            factor = H[j, k]
            if factor != 0.0:
                for i in range(n):
                    out[i, j] += T[i, k] * factor


@kernel
def reduce_covariance(P, K, HP, out):
    """``out = (I - K H) P`` with ``H P`` ``(m, n)``."""
    assign(P, out)
    add_product(-1.0, K, HP, out)


@kernel
def subtract_correlation(K, H, C, T, P):
    """``P -= A C K^T + K C^T A^T`` for ``A = I - K H``; leaves ``A C`` in `T` ``(n, m)``."""
    n, m = K.shape
    for i in range(n):
        for j in range(m):
            T[i, j] = C[i, j]
            for a in range(m):
                for k in range(n):
                    T[i, j] -= K[i, a] * H[a, k] * C[k, j]
    for i in range(n):
        for j in range(i, n):
            for k in range(m):
                P[i, j] -= T[i, k] * K[j, k] + K[i, k] * T[j, k]
            P[j, i] = P[i, j]


@kernel
def joseph(P, K, H, R, C, correlated, work):
    """Joseph form of the posterior covariance, in place; valid for any gain. See the module's docstring."""
    multiply(H, P, work.HP)
    joseph_projected(P, K, H, R, C, correlated, work)


@kernel
def joseph_projected(P, K, H, R, C, correlated, work):
    """`joseph` where ``work.HP`` holds ``H P``.

    ``A P A^T + K R K^T = T + (K R - T H^T) K^T`` with ``A = I - K H`` and ``T = A P``: the same products in an order that
    costs n^2 m instead of n^3.
    """
    T, TH, KR, KT = work.A, work.TH, work.KR, work.HP
    n, m = K.shape
    reduce_covariance(P, K, work.HP, T)
    times_transposed(T, H, TH)
    multiply_sparse(K, R, KR)
    for i in range(n):
        for j in range(m):
            KR[i, j] -= TH[i, j]
    transpose(K, KT)
    add_product(1.0, KR, KT, T)
    for i in range(n):
        for j in range(i + 1):
            P[i, j] = P[j, i] = T[i, j]
    if correlated:
        subtract_correlation(K, H, C, TH, P)


@kernel
def kept_innovation(innovation, weights, out):
    """The innovation with zeros for the channels of weight zero; False when a weight is negative or not finite."""
    valid = True
    for j in range(weights.size):
        if not 0.0 <= weights[j] < np.inf:
            valid = False
        out[j] = innovation[j] if weights[j] > 0.0 else 0.0
    return valid


@kernel
def whitened_square(L, b):
    """Whiten `b` in place and return the sum of its squares."""
    whiten(L, b, b)
    total = 0.0
    for j in range(b.size):
        total += b[j] * b[j]
    return total


@kernel
def weighted_gain(L, factor, K):
    """``K <- K S^-1 diag(factor)`` for ``S = L L^T``."""
    n, m = K.shape
    solve_rows(L, K)
    for i in range(n):
        for j in range(m):
            K[i, j] *= factor[j]


@kernel
def correction(K, innovation, weights, shift):
    """``shift = K Delta`` without the channels of weight zero, whatever their innovation."""
    for i in range(shift.size):
        total = 0.0
        for j in range(weights.size):
            if weights[j] > 0.0:
                total += K[i, j] * innovation[j]
        shift[i] = total


@kernel
def mark_removed(weights, S, L):
    """Infinite diagonal elements for the channels of weight zero, as `Workspace` promises."""
    for j in range(weights.size):
        if weights[j] == 0.0:
            S[j, j] = L[j, j] = np.inf


@kernel
def update_error(P, innovation, H, R, R_fixed, C, correlated, weights, work):
    """`update` without the state: the correction that it asks for is left in ``work.shift`` ``(n,)``."""
    K, S, L, white, R_bar = work.K, work.S, work.L, work.white, work.R
    if not (kept_innovation(innovation, weights, white) and weighted_noise(R, R_fixed, weights, R_bar)):
        return np.nan
    multiply(H, P, work.HP)
    kept_transpose(work.HP, weights, K)
    project_correlated(H, R_bar, C, correlated, weights, K, S)
    if not cholesky(S, L):
        return np.nan
    nis = whitened_square(L, white)
    if not np.isfinite(nis):
        return np.nan
    weighted_gain(L, work.gain_factor, K)  # (23), (36) imani2026
    correction(K, innovation, weights, work.shift)  # (24), (38) imani2026
    joseph_projected(P, K, H, R_bar, C, correlated, work)  # (25), (37) imani2026
    mark_removed(weights, S, L)
    return nis


@kernel
def update(x, P, innovation, H, R, R_fixed, C, correlated, weights, work):
    """Update the state `x` ``(n,)`` and covariance `P` ``(n, n)`` in place.

    Parameters
    ----------
    innovation : ndarray, shape (m,)
        ``z - h(x)``.
    H, R, R_fixed, C : ndarray
        See `robins.kalman.model.Sensor`; C is read only where `correlated`.
    weights : ndarray, shape (m,)
        In [0, 1]; zero removes a channel.
    work : Workspace

    Returns
    -------
    float
        Normalised innovation squared of the channels that took part (0 when none did); NaN, with `x` and `P` left
        as they were, when the innovation covariance is not positive definite, when an innovation that takes part is
        not finite, or when a weight is negative or not finite.
    """
    nis = update_error(P, innovation, H, R, R_fixed, C, correlated, weights, work)
    if not np.isnan(nis):
        for i in range(x.size):
            x[i] += work.shift[i]
    return nis
