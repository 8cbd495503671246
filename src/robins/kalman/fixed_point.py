"""Iterated weights on the measurement noise and on the prior: the update as a fixed point.

With the lower Cholesky factors ``P = B_p B_p^T`` and ``R = B_r B_r^T`` the correction ``B_p s`` of the predicted state solves

    e_r = B_r^-1 (Delta - H B_p s),  e_p = -s,  w_r = w(e_r),  w_p = w(e_p)
    R~ = B_r diag(1/w_r) B_r^T,  P~ = B_p diag(1/w_p) B_p^T,  K~ = P~ H^T (H P~ H^T + R~)^-1,  s = B_p^-1 K~ Delta

from the prior (``s = 0``) or from the least-squares solution. The posterior covariance is the Joseph form with K~ and the
nominal P and R, as the sources have it: weights that cut a gain do not enlarge the covariance they were taken from.

Everything is done in whitened coordinates, with ``U = H B_p``: an iteration costs n m^2.

References
----------
.. [1] Chen, Liu, Zhao, Principe 2017, Maximum correntropy Kalman filter, Automatica 76 (one kernel width).
.. [2] Li, Shi, Zou, Shi 2021, Multi-kernel maximum correntropy Kalman filter, IEEE Control Systems Letters 6 (one for each channel).
"""

import numpy as np
from numba import njit

from robins.foundation.smallmat import assign, cholesky, multiply, solve_rows, whiten
from robins.kalman.update import correction, joseph, whitened_square
from robins.kalman.weights import weigh


@njit(cache=True, error_model="numpy")
def floored_weights(weighting, parameters, residual, zeros, unit, memory, epoch, weights):
    """The weights of whitened residuals, none below the iteration's floor; one where `parameters` are empty."""
    for i in range(weights.size):
        weights[i] = 1.0
    if parameters.size > 0:
        weigh(weighting, parameters, residual, zeros, unit, memory, epoch, weights)
        for i in range(weights.size):
            weights[i] = max(weights[i], weighting.iteration.floor)


@njit(cache=True, error_model="numpy")
def innovation_factor(U, prior_weights, root, noise_weights, L):
    """Lower Cholesky factor of ``U diag(1/w_p) U^T + B_r diag(1/w_r) B_r^T`` into `L`; False when it has none."""
    m, n = U.shape
    for a in range(m):
        for b in range(a + 1):
            total = 0.0
            for k in range(n):
                total += U[a, k] * U[b, k] / prior_weights[k]
            for k in range(b + 1):
                total += root[a, k] * root[b, k] / noise_weights[k]
            L[a, b] = L[b, a] = total
    return cholesky(L, L)


@njit(cache=True, error_model="numpy")
def whitened_correction(U, prior_weights, L, innovation, solution, s):
    """``s = diag(1/w_p) U^T S^-1 Delta`` for ``S = L L^T``; `solution` ``(1, m)`` is scratch."""
    m, n = U.shape
    for j in range(m):
        solution[0, j] = innovation[j]
    solve_rows(L, solution)
    for k in range(n):
        total = 0.0
        for j in range(m):
            total += U[j, k] * solution[0, j]
        s[k] = total / prior_weights[k]


@njit(cache=True, error_model="numpy")
def has_settled(s, before, tolerance):
    """Whether the correction changed by at most `tolerance` of its length."""
    change, length = 0.0, 0.0
    for k in range(s.size):
        change += (s[k] - before[k]) ** 2
        length += s[k] ** 2
    return change <= tolerance * tolerance * length


@njit(cache=True, error_model="numpy", _nrt=True)
def update_iterated(weighting, P, innovation, H, R, C, memory, epoch, weights, work):
    """Update `P` in place; leaves the correction of the state in ``work.shift``, the gain in ``work.K``, the weights in `weights`.

    Arguments and result as in `robins.kalman.update.update_error`; ``work.S``, ``work.L`` and the NIS are those of the nominal
    noise. A weight of zero, a covariance without Cholesky factor and an innovation that is not finite give NaN.
    """
    m, n = H.shape
    root, noise_root, L = np.empty((n, n)), np.empty((m, m)), np.empty((m, m))
    if not (cholesky(P, root) and cholesky(R, noise_root)):
        return np.nan
    U, s, before, solution = np.empty((m, n)), np.zeros(n), np.empty(n), np.empty((1, m))
    multiply(H, root, U)
    prior_weights, unit, residual, prior_residual = np.ones(n), np.ones(m), np.empty(m), np.empty(n)
    if not innovation_factor(U, prior_weights, noise_root, unit, work.L):
        return np.nan
    for a in range(m):
        for b in range(m):
            work.S[a, b] = 0.0
            for k in range(min(a, b) + 1):
                work.S[a, b] += work.L[a, k] * work.L[b, k]
    for j in range(m):
        work.white[j] = innovation[j]
    nis = whitened_square(work.L, work.white)
    if not np.isfinite(nis):
        return np.nan
    if weighting.iteration.warm:
        whitened_correction(U, prior_weights, work.L, innovation, solution, s)
    assign(work.L, L)
    zeros_m, unit_m, zeros_n, unit_n = np.zeros((m, m)), np.eye(m), np.zeros((n, n)), np.eye(n)
    for _ in range(weighting.iteration.limit):
        for j in range(m):
            total = innovation[j]
            for k in range(n):
                total -= U[j, k] * s[k]
            residual[j] = total
        whiten(noise_root, residual, residual)
        for k in range(n):
            prior_residual[k] = -s[k]
            before[k] = s[k]
        floored_weights(weighting, weighting.parameters, residual, zeros_m, unit_m, memory, epoch, weights)
        floored_weights(weighting, weighting.iteration.prior, prior_residual, zeros_n, unit_n, memory, epoch, prior_weights)
        if not innovation_factor(U, prior_weights, noise_root, weights, L):
            return np.nan
        whitened_correction(U, prior_weights, L, innovation, solution, s)
        if has_settled(s, before, weighting.iteration.tolerance):
            break
    iterated_gain(U, prior_weights, root, L, work.K)
    correction(work.K, innovation, unit, work.shift)
    multiply(H, P, work.HP)
    joseph(P, work.KT, work.HP, H, R, C, False, work.A, work.W)
    return nis


@njit(cache=True, error_model="numpy")
def iterated_gain(U, prior_weights, root, L, K):
    """``K = B_p diag(1/w_p) U^T S^-1``."""
    m, n = U.shape
    for j in range(m):
        for i in range(n):
            total = 0.0
            for k in range(i + 1):
                total += root[i, k] * U[j, k] / prior_weights[k]
            K[i, j] = total
    solve_rows(L, K)
