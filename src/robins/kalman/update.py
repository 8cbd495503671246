"""The one measurement update. Every robust filter of this package is this routine with other weights.

``R_bar = R^1/2 diag(1/w) R^T/2 + R_fixed``, then gain by Cholesky and covariance in Joseph form, with an
optional cross-covariance C between the predicted state's error and the measurement noise:

    S = H P H^T + R_bar + H C + C^T H^T
    K = (P H^T + C) S^-1
    x <- x + K (z - h(x))
    P <- (I - K H) P (I - K H)^T + K R_bar K^T - (I - K H) C K^T - K C^T (I - K H)^T

A weight of zero removes its channel exactly: its row of H, of R and of the innovation is left out.

References: Bucy & Joseph 1968 (covariance form); Simon 2006, Optimal State Estimation, section 7.1 (correlated noise).
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from robins.foundation.smallmat import cholesky, congruence, multiply, solve_rows, times_vector, whiten


class Workspace(NamedTuple):
    """Arrays that a filter of n states and m measurements works in; one for each run.

    After `update`: `K` gain, `S` innovation covariance, `L` its lower Cholesky factor, `white` the
    innovation whitened by it. After `predict`: `F` transition Jacobian, `FP` = F P.
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
    """``out = R^1/2 diag(1/w) R^T/2 + R_fixed`` with the lower Cholesky factor as root; all ``(m, m)``, every w > 0.

    Returns False when `R` is neither diagonal nor positive definite.
    """
    m = R.shape[0]
    diagonal = True
    for i in range(m):
        for j in range(m):
            out[i, j] = R_fixed[i, j]
            if i != j and R[i, j] != 0.0:
                diagonal = False
    if diagonal:
        for i in range(m):
            out[i, i] += R[i, i] / weights[i]
        return True
    root = np.zeros((m, m))
    if not cholesky(R, root):
        return False
    for i in range(m):
        for j in range(m):
            for k in range(min(i, j) + 1):
                out[i, j] += root[i, k] * root[j, k] / weights[k]
    return True


@njit(cache=True)
def innovation_covariance(P, H, R, C, correlated, PH, S):
    """``PH = P H^T + C`` and ``S = H P H^T + R + H C + C^T H^T`` (C only where `correlated`)."""
    n, m = PH.shape
    for i in range(n):
        for j in range(m):
            PH[i, j] = 0.0
    for j in range(m):
        for k in range(n):
            factor = H[j, k]
            if factor != 0.0:
                for i in range(n):
                    PH[i, j] += P[k, i] * factor
    for a in range(m):
        for b in range(a, m):
            total = R[a, b]
            for k in range(n):
                factor = H[a, k]
                if factor != 0.0:
                    total += factor * PH[k, b]
            S[a, b] = total
    if correlated:
        for a in range(m):
            for b in range(a, m):
                for k in range(n):
                    S[a, b] += H[a, k] * C[k, b] + C[k, a] * H[b, k]
        for i in range(n):
            for j in range(m):
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
def update_all_channels(x, P, innovation, H, R, C, correlated, work):
    """Update `x` and `P` in place with every channel and return the NIS, or NaN when S is not positive definite."""
    K, L = work.K, work.L
    innovation_covariance(P, H, R, C, correlated, K, work.S)
    if not cholesky(work.S, L):
        return np.nan
    solve_rows(L, K)
    whiten(L, innovation, work.white)
    nis = 0.0
    for j in range(innovation.size):
        nis += work.white[j] * work.white[j]
    times_vector(K, innovation, work.shift)
    for i in range(x.size):
        x[i] += work.shift[i]
    joseph(P, K, H, R, C, correlated, work)
    return nis


@njit(cache=True)
def update_some_channels(x, P, innovation, H, R, R_fixed, C, correlated, weights, work):
    """The update without the channels of weight zero, whose columns of the gain are zero afterwards."""
    n, m = work.K.shape
    kept = np.flatnonzero(weights > 0.0)
    part = workspace(n, kept.size)
    for a, i in enumerate(kept):
        part.innovation[a] = innovation[i]
        part.H[a] = H[i]
    C_kept = np.ascontiguousarray(C[:, kept])
    R_kept = np.empty((kept.size, kept.size))
    fixed_kept = np.empty((kept.size, kept.size))
    for a, i in enumerate(kept):
        for b, j in enumerate(kept):
            R_kept[a, b] = R[i, j]
            fixed_kept[a, b] = R_fixed[i, j]
    if not weighted_noise(R_kept, fixed_kept, weights[kept], part.R):
        return np.nan
    nis = update_all_channels(x, P, part.innovation, part.H, part.R, C_kept, correlated, part)
    work.K[:] = 0.0
    work.S[:] = 0.0
    work.white[:] = 0.0
    for a, i in enumerate(kept):
        work.white[i] = part.white[a]
        for b, j in enumerate(kept):
            work.S[i, j] = part.S[a, b]
        for r in range(n):
            work.K[r, i] = part.K[r, a]
    return nis


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
        Normalised innovation squared of the channels that took part (0 when none did); NaN when the
        innovation covariance is not positive definite, with `x` and `P` left as they were.
    """
    kept = 0
    for weight in weights:
        if weight > 0.0:
            kept += 1
    if kept == 0:
        work.K[:] = 0.0
        work.S[:] = 0.0
        work.white[:] = 0.0
        return 0.0
    if kept < weights.size:
        return update_some_channels(x, P, innovation, H, R, R_fixed, C, correlated, weights, work)
    if not weighted_noise(R, R_fixed, weights, work.R):
        return np.nan
    return update_all_channels(x, P, innovation, H, work.R, C, correlated, work)
