"""The Cauchy weight: the further out an innovation lies, the less its channel counts; none is ever cut off.

Reference: P. W. Holland, R. E. Welsch, Commun. Stat. Theory Methods 6 (1977) 813.
"""

from numba import njit

from robins.kalman.weights import weight

EFFICIENT = 2.385
"""Threshold at which the weight keeps 95 % efficiency on Gaussian noise (Holland & Welsch)."""


@weight("example-cauchy")
@njit(cache=True)
def cauchy(innovation, predicted, R, parameters, memory, epoch, weights):
    """``w = 1 / (1 + (d / c)^2)`` with the standardised innovation d of each channel and the threshold c = parameters[0]."""
    for i in range(innovation.size):
        d_squared = innovation[i] ** 2 / (predicted[i, i] + R[i, i])
        weights[i] = 1.0 / (1.0 + d_squared / parameters[0] ** 2)  # (1) example2026
