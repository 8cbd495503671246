"""The hard gate: an innovation that its own covariance makes too unlikely is left out.

The oldest robust filter, and the control of every other one: what a smooth weight gains over it is the gain of
smoothness, what both gain over the plain filter is the gain of leaving outliers out.

Reference: Bar-Shalom, Li & Kirubarajan 2001, Estimation with Applications to Tracking and Navigation.
"""

import numpy as np

from robins.foundation.smallmat import kernel
from robins.kalman.weights import Weighting, weight, weighting


def gate(threshold: float) -> Weighting:
    """A gate of `threshold` innovation standard deviations, for each channel by itself.

    Infinity never closes it: the plain filter.

    Raises
    ------
    ValueError
        `threshold` is zero, negative or NaN.
    """
    if not threshold > 0.0:
        raise ValueError(f"threshold: {threshold:g} is not positive")
    return weighting("gate", (threshold,))


@weight("gate")
@kernel
def close_gate(innovation, predicted, R, parameters, memory, epoch, weights):
    """Weight 0 where ``|y_i| / sqrt(S_ii)`` exceeds the threshold ``parameters[0]``, else 1; ``S = predicted + R``."""
    for i in range(innovation.size):
        standardised = abs(innovation[i]) / np.sqrt(predicted[i, i] + R[i, i])
        weights[i] = 0.0 if standardised > parameters[0] else 1.0
