"""M-estimators: Huber's weight and that of the multi-kernel maximum correntropy criterion.

Both look at each channel by itself, through its innovation in standard deviations ``e_i = y_i / sqrt(S_ii)`` with
``S = predicted + R``, so no change of units changes a weight. The number of channels is open: with ``predicted = 0``
and ``R = I`` the innovation is taken as standardised already, which is what a fixed-point iteration asks for.

References: Huber 1964, Ann. Math. Stat. 35(1), doi 10.1214/aoms/1177703732; Chen, Liu, Zhao & Principe 2017, Automatica
76, doi 10.1016/j.automatica.2016.10.004 (one kernel); imani2026 section 4.3 (a mixture of kernels).
"""

import numpy as np

from robins.foundation.smallmat import kernel
from robins.kalman.weights import Weighting, weight, weighting

VANISHING = 1e-100
"""A weight below this is zero: no digit of the estimate would show it, but ``R / w`` can overflow."""


def huber(threshold: float) -> Weighting:
    """Huber's weights: an innovation counts fully up to `threshold` standard deviations, as if it were there beyond.

    Infinity gives the plain filter.

    Raises
    ------
    ValueError
        `threshold` is zero, negative or NaN.
    """
    if not threshold > 0.0:
        raise ValueError(f"threshold: {threshold:g} is not positive")
    return weighting("huber", (threshold,))


@weight("huber")
@kernel
def huber_weights(innovation, predicted, R, parameters, memory, epoch, weights):
    """Weights ``min(1, c / |e_i|)`` with the threshold ``c = parameters[0]``."""
    for i in range(innovation.size):
        standardised = abs(innovation[i]) / np.sqrt(predicted[i, i] + R[i, i])
        weights[i] = 1.0 if standardised <= parameters[0] else parameters[0] / standardised


def correntropy(widths, mixing) -> Weighting:
    """Weights of the mixture correntropy, normalised by their value at zero; one width is the single-kernel criterion.

    An infinite width has no part in the weights beside finite ones, because its share ``eta / sigma^2`` is zero. All
    widths infinite give the plain filter.

    Parameters
    ----------
    widths : sequence of float, length L
        Kernel widths sigma_j in standard deviations of the innovation.
    mixing : sequence of float, length L
        Mixing weights eta_j; they sum to one.

    Raises
    ------
    ValueError
        A width is zero, negative or NaN; the lengths differ; a mixing weight is negative or NaN, or their sum is not one.
    """
    widths, mixing = np.atleast_1d(np.asarray(widths, float)), np.atleast_1d(np.asarray(mixing, float))
    if not np.all(widths > 0.0):
        raise ValueError(f"widths: {widths.tolist()} are not all positive")
    if widths.shape != mixing.shape:
        raise ValueError(f"mixing: {mixing.size} weights for {widths.size} widths")
    if not (np.all(mixing >= 0.0) and abs(mixing.sum() - 1.0) < 1e-9):
        raise ValueError(f"mixing: {mixing.tolist()} are not weights that sum to one")
    widths, mixing = widths[mixing > 0.0], mixing[mixing > 0.0]
    narrowest = widths.min()
    # eta / sigma^2 in units of the narrowest kernel: no width, however small or large, overflows
    shares = mixing * (narrowest / widths) ** 2 if np.isfinite(narrowest) else mixing  # (39) imani2026: its derivative
    return weighting("correntropy", np.concatenate([shares, widths]))


@weight("correntropy")
@kernel
def correntropy_weights(innovation, predicted, R, parameters, memory, epoch, weights):
    """Weights ``w(e_i) / w(0)`` with ``w(e) = sum_j eta_j / sigma_j^2 exp(-e^2 / (2 sigma_j^2))``, L kernels.

    `parameters` holds ``eta_j / sigma_j^2`` up to a common factor, then ``sigma_j``. Source: imani2026 equation (40), which
    neither standardises nor normalises.
    """
    kernels = parameters.size // 2
    for i in range(innovation.size):
        standardised = innovation[i] / np.sqrt(predicted[i, i] + R[i, i])
        here, at_zero = 0.0, 0.0
        for j in range(kernels):
            distance = standardised / parameters[kernels + j]
            here += parameters[j] * np.exp(-0.5 * distance * distance)  # (40) imani2026
            at_zero += parameters[j]
        weights[i] = 0.0 if here < VANISHING * at_zero else here / at_zero
