"""What section II-B prints of the unscented filter and should not: the weight (18), and an update with propagated sigma points (25).

The propagated points do not contain the process noise of their step. As (25)-(31) reuse them, the update takes ``P^- - Q`` for the
predicted covariance in gain and innovation covariance, and P^- for what it corrects. On a linear model it is no Kalman filter.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from robins.foundation.smallmat import cholesky, multiply, solve_rows
from robins.kalman.extension import implements
from robins.kalman.predict import Ukf
from robins.kalman.reweighted import find_weights, process
from robins.kalman.update import correction, innovation_covariance, mark_removed, whitened_square
from robins.kalman.weights import Weighting


def printed_centre(points: Ukf, alpha: float, beta: float) -> float:
    """(18) letter by letter: ``lambda / (n + lambda)`` *times* ``1 - alpha^2 + beta``, where a sum belongs."""
    return points.mean_centre * (1.0 - alpha**2 + beta)  # (18) ghouneem2024


class Reused(NamedTuple):
    """An update with the sigma points of the prediction, for weights of zero and one (a gate) and a linear sensor."""

    weighting: Weighting
    memory: np.ndarray


def reused(weighting: Weighting) -> Reused:
    """The update of (25)-(31) without drawing sigma points again."""
    return Reused(weighting, weighting.memory)


@implements(process, Reused)
@njit(cache=True)
def process_reused(method, P, sensor, correlated, memory, epoch, weights, predicted, work):
    """`robins.kalman.reweighted.process`: the covariance of the propagated points is ``P - work.Q``."""
    n, m = work.K.shape
    without = P - work.Q  # (25) ghouneem2024
    weights[:] = 1.0
    work.gain_factor[:] = 1.0
    innovation_covariance(without, work.H, sensor.R_fixed, sensor.C_update, correlated, weights, work.K, predicted)
    find_weights(method.weighting, work.innovation, predicted, sensor.R, memory, epoch, weights)
    innovation_covariance(without, work.H, sensor.R, sensor.C_update, correlated, weights, work.K, work.S)  # (27), (28) ghouneem2024
    if not cholesky(work.S, work.L):
        return np.nan
    for j in range(m):
        work.white[j] = work.innovation[j] if weights[j] > 0.0 else 0.0
    nis = whitened_square(work.L, work.white)
    if not np.isfinite(nis):
        return np.nan
    solve_rows(work.L, work.K)  # (29) ghouneem2024
    correction(work.K, work.innovation, weights, work.shift)  # (30) ghouneem2024
    spread = np.empty((n, m))
    multiply(work.K, work.S, spread)
    for i in range(n):
        for j in range(i + 1):
            for k in range(m):
                P[i, j] -= spread[i, k] * work.K[j, k]  # (31) ghouneem2024
            P[j, i] = P[i, j]
    mark_removed(weights, work.S, work.L)
    return nis
