"""Noise tuning from the filter's own innovations.

Covariance matching (Mehra 1970; hajiyev2023 section 4): the measurement noise is scaled until the
innovation covariance that the filter predicts equals the one seen in a sliding window. In the language of
this package the weight of channel i is 1/s_i with the scale factor s_i >= 1.
"""

import numpy as np
from numba import njit

from robins.kalman.weights import Weighting, weight, weighting

PER_CHANNEL, GATED, SCALAR_TRACE, SCALAR_MEAN = range(4)
"""Rules of `covariance_matching`: one factor a channel; the same where the excess is significant; one for all."""


def matching(window: int, channels: int, rule: int = PER_CHANNEL, threshold: float = 0.0, minimum: int | None = None) -> Weighting:
    """Covariance matching over a window of innovations.

    Parameters
    ----------
    window : int
        Number M of innovations, the current one included.
    channels : int
        Number m of measurements.
    rule : int
        `PER_CHANNEL`, `GATED`, `SCALAR_TRACE` (``tr D / tr R``) or `SCALAR_MEAN` (mean of ``D_ii / R_ii``).
    threshold : float
        `GATED` only: a channel is scaled where seen over predicted variance exceeds this.
    minimum : int, optional
        Innovations needed before anything is scaled; the whole window unless given.
    """
    constants = (window, rule, threshold, window if minimum is None else minimum)
    return weighting("covariance-matching", constants, np.zeros((window, channels)))


@weight("covariance-matching")
@njit(cache=True)
def covariance_matching(innovation, predicted, R, parameters, memory, epoch, weights):
    """Weights 1/s_i with ``s_i = max(1, D_ii / R_ii)``, ``D = S_seen - predicted``.

    ``S_seen`` is the mean of the outer products in the window, which is kept in `memory` as a ring. A channel
    without noise (R_ii = 0) keeps its weight and takes no part in `SCALAR_MEAN`.
    Source: hajiyev2023 equations (19)-(23) for a diagonal R.
    """
    window, rule = int(parameters[0]), int(parameters[1])
    for i in range(innovation.size):
        memory[epoch % window, i] = innovation[i]  # (19) hajiyev2023: the window includes the current innovation
    seen_epochs = min(epoch + 1, window)
    if seen_epochs < parameters[3]:
        return
    m = innovation.size
    excess = np.empty(m)
    trace_excess, trace_noise, mean_ratio = 0.0, 0.0, 0.0
    noisy = 0
    for i in range(m):
        seen = 0.0
        for j in range(seen_epochs):
            seen += memory[j, i] * memory[j, i]
        seen /= seen_epochs  # (19) hajiyev2023
        excess[i] = seen - predicted[i, i]  # (20), (21) hajiyev2023
        trace_excess += excess[i]
        trace_noise += R[i, i]
        if R[i, i] > 0.0:
            noisy += 1
            mean_ratio += excess[i] / R[i, i]
        if rule == GATED and seen <= parameters[2] * (predicted[i, i] + R[i, i]):
            excess[i] = 0.0
    for i in range(m):
        if R[i, i] <= 0.0:
            continue  # nothing to scale
        if rule == SCALAR_TRACE:
            factor = trace_excess / trace_noise
        elif rule == SCALAR_MEAN:
            factor = mean_ratio / noisy
        else:
            factor = excess[i] / R[i, i]
        weights[i] = 1.0 / max(1.0, factor)  # (22), (23) hajiyev2023
