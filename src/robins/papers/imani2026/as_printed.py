"""Updates as the paper prints them, where no weights can express that.

RAW        (40)-(43): weights of the raw innovation, neither standardised nor normalised, on the gain, and ``P = (I - K W H) P``,
           made symmetric. ``W`` stands on the left of K in print, where it does not fit (6 x 6 against n x 6)
PLAIN_R    (36)-(38): the factors of (35) are found, and R is used without them: the bar on R is missing in (36)

Their covariance needs not stay positive: the run then fails, and says so.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from robins.foundation.rotation import dcm
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


def printed_jacobian(x: np.ndarray, specific_force, rate) -> np.ndarray:
    """Equation (21) letter by letter, shape (16, 16), for the additive errors of r, v, q, b_a and b_g.

    A continuous-time Jacobian, whose diagonal is zero, where (20) needs a transition: used there it forgets velocity and biases.
    Its Coriolis terms have the measured body rate in place of ``2 omega_ie + omega_en``. It is shown, never run.

    Parameters
    ----------
    x : ndarray, shape (16,)
        State of `robins.navigation.strapdown`.
    specific_force, rate : array_like, shape (3,)
        The sample u.
    """
    (w, *axis), v = x[6:10], x[3:6]
    force, omega = np.asarray(specific_force) - x[10:13], np.asarray(rate) - x[13:16]
    C = np.empty((3, 3))
    dcm(np.ascontiguousarray(x[6:10]), C)
    rotated = 2.0 * (axis @ force * np.eye(3) + np.outer(axis, force) - np.outer(force, axis) - w * skew(force))
    product = np.vstack([-np.array(axis), w * np.eye(3) + skew(axis)])  # q [0 omega] = product omega
    A = np.zeros((16, 16))
    A[0:3, 3:6] = np.eye(3)
    A[3:6, 3:6], A[3:6, 13:16] = -2.0 * C @ skew(rate), -2.0 * C @ skew(v)
    A[3:6, 6:10] = np.column_stack([2.0 * (w * force + np.cross(axis, force)), rotated])
    A[3:6, 10:13] = -C
    A[6:10, 6:10] = 0.5 * np.vstack([[0.0, *-omega], np.column_stack([omega, -skew(omega)])])
    A[6:10, 13:16] = -0.5 * product
    return A  # (21) imani2026


def skew(a) -> np.ndarray:
    """``[a x]``, shape (3, 3)."""
    return np.cross(np.eye(3), np.asarray(a, float))
