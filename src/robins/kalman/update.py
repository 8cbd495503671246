"""The one measurement update. Every robust filter of this package is this routine with other weights.

``R_bar = R^1/2 diag(1/w) R^T/2 + R_fixed``, then gain by Cholesky and covariance in Joseph form, with an
optional cross-covariance C between the predicted state's error and the measurement noise:

    S = H P H^T + R_bar + H C + C^T H^T
    K = (P H^T + C) S^-1
    x <- x + K (z - h(x))
    P <- (I - K H) P (I - K H)^T + K R_bar K^T - (I - K H) C K^T - K C^T (I - K H)^T

A weight of zero removes its channel exactly: its row of H, of R and of the innovation and its column of C are
left out of every sum.

References: Bucy & Joseph 1968 (covariance form); Simon 2006, Optimal State Estimation, section 7.1 (correlated noise).
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from robins.foundation.smallmat import cholesky, congruence, multiply, solve_rows, whiten


class Workspace(NamedTuple):
    """Arrays that a filter of n states and m measurements works in; one for each run.

    After `update`: `K` gain, `S` innovation covariance, `L` its lower Cholesky factor, `white` the
    innovation whitened by it. A channel of weight zero has an infinite diagonal element in `S` and `L` and zeros
    beside it, so that whitening by `L` removes it from whatever comes next; its gain is zero.
    After `predict`: `F` transition Jacobian, `FP` = F P, the covariance between the predicted and the earlier state.

    `H` and `innovation` are the caller's to fill; the other arrays are scratch.
    """

    F: np.ndarray
    Q: np.ndarray
    FP: np.ndarray
    A: np.ndarray
    T: np.ndarray
    H: np.ndarray
    K: np.ndarray
    KR: np.ndarray
    S: np.ndarray
    L: np.ndarray
    R: np.ndarray
    innovation: np.ndarray
    white: np.ndarray
    shift: np.ndarray
    points: np.ndarray


@njit(cache=True)
def workspace(n, m):
    """A `Workspace` for `n` states and `m` measurements."""
    square, tall, small = (n, n), (n, m), (m, m)
    return Workspace(
        np.zeros(square), np.zeros(square), np.zeros(square), np.zeros(square), np.zeros(square),
        np.zeros((m, n)), np.zeros(tall), np.zeros(tall),
        np.zeros(small), np.zeros(small), np.zeros(small),
        np.zeros(m), np.zeros(m), np.zeros(n), np.zeros((2 * n + 1, n)),
    )  # fmt: skip


@njit(cache=True)
def weighted_noise(R, R_fixed, weights, out):
    """``out = R^1/2 diag(1/w) R^T/2 + R_fixed`` with the lower Cholesky factor as root; all ``(m, m)``.

    A channel of weight zero is left out: its row and column are those of the unit matrix. Returns False when the rest
    of `R` is neither diagonal nor positive definite.
    """
    m = R.shape[0]
    diagonal = True
    for i in range(m):
        for j in range(m):
            kept = weights[i] > 0.0 and weights[j] > 0.0
            out[i, j] = R_fixed[i, j] if kept else 0.0
            if kept and i != j and R[i, j] != 0.0:
                diagonal = False
    if diagonal:
        for i in range(m):
            out[i, i] += R[i, i] / weights[i] if weights[i] > 0.0 else 1.0
        return True
    kept_R, root = R.copy(), np.zeros((m, m))
    for i in range(m):
        if weights[i] == 0.0:
            for j in range(m):
                kept_R[i, j] = kept_R[j, i] = 0.0
            kept_R[i, i] = 1.0
    if not cholesky(kept_R, root):
        return False
    for i in range(m):
        for j in range(m):
            for k in range(min(i, j) + 1):
                out[i, j] += root[i, k] * root[j, k] / (weights[k] if weights[k] > 0.0 else 1.0)
    return True


@njit(cache=True)
def innovation_covariance(P, H, R, C, correlated, weights, PH, S):
    """``PH = P H^T + C`` and ``S = H P H^T + R + H C + C^T H^T`` (C only where `correlated`).

    A channel of weight zero has zeros in `PH` and, besides its element of `R`, in `S`.
    """
    n, m = PH.shape
    for i in range(n):
        for j in range(m):
            PH[i, j] = 0.0
    for j in range(m):
        if weights[j] > 0.0:
            for k in range(n):
                factor = H[j, k]
                if factor != 0.0:
                    for i in range(n):
                        PH[i, j] += P[k, i] * factor
    for a in range(m):
        for b in range(a, m):
            total = R[a, b]
            if weights[a] > 0.0:
                for k in range(n):
                    factor = H[a, k]
                    if factor != 0.0:
                        total += factor * PH[k, b]
            S[a, b] = total
    if correlated:
        for a in range(m):
            for b in range(a, m):
                if weights[a] > 0.0 and weights[b] > 0.0:
                    for k in range(n):
                        S[a, b] += H[a, k] * C[k, b] + C[k, a] * H[b, k]
        for j in range(m):
            if weights[j] > 0.0:
                for i in range(n):
                    PH[i, j] += C[i, j]
    for a in range(m):
        for b in range(a):
            S[a, b] = S[b, a]


@njit(cache=True)
def joseph(P, K, H, R, C, correlated, work):
    """Joseph form of the posterior covariance, in place; valid for any gain. See the module's docstring."""
    n, m = K.shape
    A, AP, KR = work.A, work.T, work.KR
    for i in range(n):
        for j in range(n):
            A[i, j] = 0.0
        A[i, i] = 1.0
        for k in range(m):
            gain = K[i, k]
            for j in range(n):
                A[i, j] -= gain * H[k, j]
    multiply(A, P, AP)
    congruence(AP, A, P)
    multiply(K, R, KR)
    for i in range(n):
        for j in range(i, n):
            for k in range(m):
                P[i, j] += KR[i, k] * K[j, k]
            P[j, i] = P[i, j]
    if correlated:
        AC = np.zeros((n, m))
        multiply(A, C, AC)
        for i in range(n):
            for j in range(i, n):
                for k in range(m):
                    P[i, j] -= AC[i, k] * K[j, k] + K[i, k] * AC[j, k]
                P[j, i] = P[i, j]


@njit(cache=True)
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
    K, L, white = work.K, work.L, work.white
    m = innovation.size
    for j in range(m):
        if not 0.0 <= weights[j] < np.inf:
            return np.nan
        white[j] = innovation[j] if weights[j] > 0.0 else 0.0
    if not weighted_noise(R, R_fixed, weights, work.R):
        return np.nan
    innovation_covariance(P, H, work.R, C, correlated, weights, K, work.S)
    if not cholesky(work.S, L):
        return np.nan
    whiten(L, white, white)
    nis = 0.0
    for j in range(m):
        nis += white[j] * white[j]
    if not np.isfinite(nis):
        return np.nan
    solve_rows(L, K)
    for i in range(x.size):
        for j in range(m):
            if weights[j] > 0.0:
                x[i] += K[i, j] * innovation[j]
    joseph(P, K, H, work.R, C, correlated, work)
    for j in range(m):
        if weights[j] == 0.0:
            work.S[j, j] = L[j, j] = np.inf
    return nis
