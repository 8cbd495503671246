"""Updates as the paper prints them, where no weights can express that.

RAW        (40)-(43): weights of the raw innovation, neither standardised nor normalised, on the gain, and ``P = (I - K W H) P``,
           made symmetric. ``W`` stands on the left of K in print, where it does not fit (6 x 6 against n x 6)
PLAIN_R    (36)-(38): the factors of (35) are found, and R is used without them: the bar on R is missing in (36)

Their covariance needs not stay positive: the run then fails, and says so.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from robins.foundation.smallmat import cholesky, solve_rows
from robins.kalman.extension import implements
from robins.kalman.reweighted import process
from robins.kalman.update import correction, innovation_covariance, update_error, whitened_square
from robins.kalman.weights import Weighting, weigh, weighting

RAW, PLAIN_R = range(2)


class Printed(NamedTuple):
    """An update as printed.

    Attributes
    ----------
    form : int
        `RAW` or `PLAIN_R`.
    weighting : Weighting
        PLAIN_R: what the weights would have been.
    widths : ndarray, shape (6, L)
        RAW: kernel widths in the unit of each channel.
    mixing : ndarray, shape (L,)
    memory : ndarray, shape (r, c)
    """

    form: int
    weighting: Weighting
    widths: np.ndarray
    mixing: np.ndarray
    memory: np.ndarray


def raw_correntropy(widths, mixing) -> Printed:
    """(40)-(43) with kernel `widths` ``(6, L)`` in SI units and mixing weights ``(L,)``."""
    return Printed(RAW, weighting("unit"), np.array(widths, float), np.array(mixing, float), np.zeros((1, 1)))


def plain_noise(method: Weighting) -> Printed:
    """(36)-(38) with R where R-bar belongs."""
    return Printed(PLAIN_R, method, np.zeros((1, 1)), np.zeros(1), method.memory)


@njit(cache=True)
def raw_weights(innovation, widths, mixing, weights):
    """``w_i = sum_j eta_j / sigma_ij^2 exp(-y_i^2 / (2 sigma_ij^2))``, in 1 / unit^2."""
    for i in range(innovation.size):
        weights[i] = 0.0
        for j in range(mixing.size):
            inverse = 1.0 / widths[i, j]
            weights[i] += mixing[j] * inverse * inverse * np.exp(-0.5 * (innovation[i] * inverse) ** 2)  # (40) imani2026


@njit(cache=True)
def reduce_printed(P, K, H):
    """``P <- (I - K H) P``, its symmetric part; K is the weighted gain."""
    n, m = K.shape
    HP = H @ P
    for i in range(n):
        for k in range(n):
            for j in range(m):
                P[i, k] -= K[i, j] * HP[j, k]  # (42) imani2026
    for i in range(n):
        for k in range(i):
            P[i, k] = P[k, i] = 0.5 * (P[i, k] + P[k, i])


@implements(process, Printed)
@njit(cache=True)
def process_printed(method, P, sensor, correlated, memory, epoch, weights, predicted, work):
    """`robins.kalman.reweighted.process` of both forms."""
    unit = np.ones(weights.size)
    work.gain_factor[:] = 1.0
    if method.form == PLAIN_R:
        weights[:] = 1.0
        innovation_covariance(P, work.H, sensor.R_fixed, sensor.C_update, correlated, unit, work.K, predicted)
        weigh(method.weighting, method.weighting.parameters, work.innovation, predicted, sensor.R, memory, epoch, weights)
        return update_error(P, work.innovation, work.H, sensor.R, sensor.R_fixed, sensor.C_update, correlated, unit, work)
    innovation_covariance(P, work.H, sensor.R, sensor.C_update, correlated, unit, work.K, work.S)
    if not cholesky(work.S, work.L):
        return np.nan
    for j in range(weights.size):
        work.white[j] = work.innovation[j]
    nis = whitened_square(work.L, work.white)
    if not np.isfinite(nis):
        return np.nan
    solve_rows(work.L, work.K)  # (41) imani2026
    raw_weights(work.innovation, method.widths, method.mixing, weights)
    for i in range(work.K.shape[0]):
        for j in range(weights.size):
            work.K[i, j] *= weights[j]
    correction(work.K, work.innovation, unit, work.shift)  # (43) imani2026
    reduce_printed(P, work.K, work.H)
    return nis
