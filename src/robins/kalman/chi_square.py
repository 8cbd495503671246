"""The chi-square increment: a channel whose innovation is too large for its variance has its noise inflated.

The statistic ``chi^2 = y^T S^-1 y`` of an update is split into one increment a channel, each of which follows chi^2(1)
when the filter is right. What an increment is can be chosen:

    SEQUENTIAL   squares of the whitened innovation ``L^-1 y`` with ``S = L L^T``: by how much channel i raises the least-squares
                 objective when the channels are processed one after the other. They are independent and sum to chi^2, but
                 depend on the channels' order where these are correlated.
    MARGINAL     ``y_i^2 / S_ii``; the same for a diagonal S, and free of the order.
    TEMPORAL     the change of chi^2 since the update before, for every channel alike and zero where it falls. It does not
                 follow chi^2(1).

The ratio of an increment to a quantile of chi^2(1) gives the factor of the channel's noise, ``alpha``; the weight is 1/alpha.

References: B. Li et al. 2020, Remote Sensing 12(4):732, doi 10.3390/rs12040732 (the method); imani2026 equations (27)-(35).
"""

import numpy as np
from numba import njit
from scipy.special import chdtri

from robins.foundation.smallmat import cholesky, kernel, whiten
from robins.kalman.weights import Weighting, weight, weighting

SEQUENTIAL, MARGINAL, TEMPORAL = range(3)
"""Increments of `chi_square`; see the module's docstring."""

LINEAR, ROOT, REJECT = range(3)
"""Shapes of the factor between and above the two bounds: ratio and ratio; its root and ratio; ratio and infinity."""


def chi_square(
    channels: int, increment: int, shape: int, probability: float, lower: float, upper: float, correct: bool = False
) -> Weighting:
    """Weights from chi-square increments.

    Parameters
    ----------
    channels : int
        Number m of measurements.
    increment : int
        `SEQUENTIAL`, `MARGINAL` or `TEMPORAL`.
    shape : int
        `LINEAR`, `ROOT` or `REJECT`.
    probability : float
        beta; the ratio is that of the increment to the quantile ``chi^2_beta(1)``.
    lower, upper : float
        Bounds c_0 and c_1 of the ratio. Up to `lower` the factor is one; an infinite `lower` is the plain filter. With a
        `lower` under one, ratios between it and one give factors under one, hence weights above one, as equation (35) reads.
    correct : bool
        Inflate the noise by as much as makes the innovation variance, not the noise itself, larger by the factor:
        ``1 + (factor - 1) S_ii / R_ii``. Never less than one. The statistic of a channel that is re-weighted alone is then at
        its threshold; where channels are correlated, a `SEQUENTIAL` one is below, because S_ii exceeds ``L_ii^2``.

    Raises
    ------
    ValueError
        `increment` or `shape` is not one of those; `probability` is not between 0 and 1; a bound is zero, negative or NaN;
        `lower` exceeds `upper`.
    """
    if increment not in (SEQUENTIAL, MARGINAL, TEMPORAL):
        raise ValueError(f"increment: {increment!r} is none of SEQUENTIAL, MARGINAL, TEMPORAL")
    if shape not in (LINEAR, ROOT, REJECT):
        raise ValueError(f"shape: {shape!r} is none of LINEAR, ROOT, REJECT")
    if not 0.0 < probability < 1.0:
        raise ValueError(f"probability: {probability:g} is not between 0 and 1")
    for name, bound in (("lower", lower), ("upper", upper)):
        if not bound > 0.0:
            raise ValueError(f"{name}: {bound:g} is not positive")
    if lower > upper:
        raise ValueError(f"lower: {lower:g} exceeds upper, {upper:g}")
    quantile = chdtri(1.0, 1.0 - probability)  # (32), (33), (34) imani2026: one degree of freedom for each channel
    constants = (increment, shape, quantile, lower, upper, correct)
    return weighting("chi-square", constants, np.zeros((channels, channels + 1)))


@weight("chi-square")
@njit(cache=True, error_model="numpy")
def chi_square_weights(innovation, predicted, R, parameters, memory, epoch, weights):
    """Weights 1/alpha; all one where ``S = predicted + R`` is not positive definite, for then no update is possible either.

    `memory` ``(m, m + 1)`` is room for the Cholesky factor of S; the first element of its last column is the statistic
    of the update before. Source: imani2026 equations (28)-(35).

    Raises
    ------
    ValueError
        The innovation has not the number of channels that `memory` was made for.
    """
    m = innovation.size
    if memory.shape[0] != m or memory.shape[1] != m + 1:
        raise ValueError("channels: the filter's number of measurements is not that of chi_square()")
    increment, shape, quantile = parameters[0], parameters[1], parameters[2]
    if increment == MARGINAL:
        marginal_increments(innovation, predicted, R, weights)
    elif not sequential_increments(innovation, predicted, R, memory, weights):
        return
    if increment == TEMPORAL:
        temporal_increments(memory, epoch, weights)
    for i in range(m):
        factor = factor_of(weights[i] / quantile, shape, parameters[3], parameters[4])
        if parameters[5]:
            factor = corrected(factor, predicted[i, i] + R[i, i], R[i, i])
        weights[i] = 1.0 / factor  # (35a) imani2026


@kernel
def marginal_increments(innovation, predicted, R, increments):
    """``y_i^2 / S_ii`` with ``S = predicted + R``."""
    for i in range(innovation.size):
        increments[i] = innovation[i] ** 2 / (predicted[i, i] + R[i, i])  # (34) imani2026


@kernel
def sequential_increments(innovation, predicted, R, memory, increments):
    """Squares of ``L^-1 y``, ``predicted + R = L L^T``; False, with `increments` as they were, when there is no such L."""
    m = innovation.size
    for i in range(m):
        for j in range(m):
            memory[i, j] = predicted[i, j] + R[i, j]  # (28) imani2026
    definite = cholesky(memory, memory)
    if definite:
        whiten(memory, innovation, increments)
        for i in range(m):
            increments[i] *= increments[i]  # (31), (34) imani2026
    return definite


@kernel
def temporal_increments(memory, epoch, increments):
    """Replace sequential increments by the change of their sum since the update before; by zero at the first update."""
    m = increments.size
    chi_square = 0.0
    for i in range(m):
        chi_square += increments[i]  # (29) imani2026
    change = max(0.0, chi_square - memory[0, m]) if epoch > 0 else 0.0  # (30) imani2026
    memory[0, m] = chi_square
    for i in range(m):
        increments[i] = change


@kernel
def factor_of(ratio, shape, lower, upper):
    """Robust factor alpha of an increment's `ratio` to the quantile; infinite where the channel is rejected.

    Each bound belongs to the range below it; the paper leaves that open, and its third line repeats the second.
    """
    if ratio <= lower:
        return 1.0  # (35) imani2026
    if ratio > upper:
        return np.inf if shape == REJECT else ratio  # (35) imani2026
    return np.sqrt(ratio) if shape == ROOT else ratio  # (35) imani2026


@kernel
def corrected(factor, variance, noise):
    """The alpha that makes ``P + alpha R`` the `factor` of ``S = P + R``; one where that shrinks the noise or there is none."""
    if factor <= 1.0 or noise <= 0.0:
        return 1.0
    return 1.0 + (factor - 1.0) * variance / noise
