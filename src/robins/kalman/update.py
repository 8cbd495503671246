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

from robins.foundation.smallmat import add_product, cholesky, kernel, multiply, solve_rows, whiten
from robins.kalman.noise import weighted_noise


class Workspace(NamedTuple):
    """Arrays that a filter of n states and m measurements works in; one for each run.

    After `update`: `K` gain, `S` innovation covariance, `L` its lower Cholesky factor, `white` the
    innovation whitened by it. A channel of weight zero has an infinite diagonal element in `S` and `L` and zeros
    beside it, so that whitening by `L` removes it from whatever comes next; its gain is zero.
    `gain_factor` is g, ones on delivery; `shift` the correction of the (error) state.
    After `predict`: `F` transition Jacobian, `FP` = F P, the covariance between the predicted and the earlier state.

    `H` and `innovation` are the caller's to fill; the other arrays are scratch. `KT` is the transpose of `K` in the same
    memory: loops over the states run over neighbours.
    """

    F: np.ndarray
    Q: np.ndarray
    FP: np.ndarray
    A: np.ndarray
    T: np.ndarray
    H: np.ndarray
    HP: np.ndarray
    W: np.ndarray
    K: np.ndarray
    KT: np.ndarray
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
    square, wide, small = (n, n), (m, n), (m, m)
    KT = np.zeros(wide)
    return Workspace(
        np.zeros(square), np.zeros(square), np.zeros(square), np.zeros(square), np.zeros(square),
        np.zeros(wide), np.zeros(wide), np.zeros(wide), KT.T, KT,
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
def kept_rows(HP, weights, out):
    """``out = H P``, with zeros for a channel of weight zero."""
    for j in range(HP.shape[0]):
        for i in range(HP.shape[1]):
            out[j, i] = HP[j, i] if weights[j] > 0.0 else 0.0


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
def joseph_remainder(T, KT, H, R, out):
    """``out = R K^T - H T^T``, ``(m, n)``; skips zeros of `R` and `H`."""
    m, n = KT.shape
    for a in range(m):
        for i in range(n):
            out[a, i] = 0.0
        for b in range(m):
            factor = R[a, b]
            if factor != 0.0:
                for i in range(n):
                    out[a, i] += factor * KT[b, i]
        for k in range(n):
            factor = H[a, k]
            if factor != 0.0:
                for i in range(n):
                    out[a, i] -= T[i, k] * factor


@kernel
def subtract_correlation(KT, H, C, AC, P):
    """``P -= A C K^T + K C^T A^T`` for ``A = I - K H``; leaves ``(A C)^T`` in `AC` ``(m, n)``."""
    m, n = KT.shape
    for j in range(m):
        for i in range(n):
            AC[j, i] = C[i, j]
        for a in range(m):
            projected = 0.0
            for k in range(n):
                projected += H[a, k] * C[k, j]
            for i in range(n):
                AC[j, i] -= KT[a, i] * projected
    for i in range(n):
        for j in range(i, n):
            for k in range(m):
                P[i, j] -= AC[k, i] * KT[k, j] + KT[k, i] * AC[k, j]
            P[j, i] = P[i, j]


@kernel
def joseph(P, KT, HP, H, R, C, correlated, T, W):
    """Joseph form of the posterior covariance, in place, where `HP` is ``H P``; valid for any gain. See the module's docstring.

    ``A P A^T + K R K^T = T + (K R - T H^T) K^T`` with ``A = I - K H`` and ``T = A P``: the same products in an order that
    costs n^2 m instead of n^3. `T` ``(n, n)`` and `W` ``(m, n)`` are scratch.
    """
    add_product(P, -1.0, KT.T, HP, T)
    joseph_remainder(T, KT, H, R, W)
    add_product(T, 1.0, W.T, KT, P)
    for i in range(P.shape[0]):
        for j in range(i):
            P[j, i] = P[i, j]
    if correlated:
        subtract_correlation(KT, H, C, W, P)


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
    for j in range(m):
        if factor[j] != 1.0:
            for i in range(n):
                K[i, j] *= factor[j]


@kernel
def correction(K, innovation, weights, shift):
    """``shift = K Delta`` without the channels of weight zero, whatever their innovation."""
    for i in range(shift.size):
        shift[i] = 0.0
    for j in range(weights.size):
        if weights[j] > 0.0:
            for i in range(shift.size):
                shift[i] += K[i, j] * innovation[j]


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
    kept_rows(work.HP, weights, work.KT)
    project_correlated(H, R_bar, C, correlated, weights, K, S)
    if not cholesky(S, L):
        return np.nan
    nis = whitened_square(L, white)
    if not np.isfinite(nis):
        return np.nan
    weighted_gain(L, work.gain_factor, K)  # (23), (36) imani2026 # (9) ghouneem2024
    correction(K, innovation, weights, work.shift)  # (24), (38) imani2026 # (10) ghouneem2024
    joseph(P, work.KT, work.HP, H, R_bar, C, correlated, work.A, work.W)  # (25), (37) imani2026 # (11) ghouneem2024
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
