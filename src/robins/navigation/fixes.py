"""Satellite fixes: position and velocity, with the variances that the receiver reports at each epoch.

A sensor for any model whose first six states are the position and the velocity that are measured, in the order in which the fixes
have them. The standard deviations of a fix stand in the input's columns after those of the model.
"""

from typing import NamedTuple

import numpy as np

from robins.foundation.smallmat import kernel
from robins.kalman.extension import implements
from robins.kalman.model import linearise_observation, measurement_noise, observe

CHANNELS = 6


class FixSensor(NamedTuple):
    """The noise of `robins.kalman.model.Sensor`, `first`, the input's column of the first standard deviation, and what multiplies R."""

    first: int
    noise_scale: float
    R: np.ndarray
    R_fixed: np.ndarray
    C_update: np.ndarray
    C_predict: np.ndarray


def fix_sensor(first: int, states: int, noise_scale: float = 1.0) -> FixSensor:
    """A `FixSensor` for a model of `states` states and `first` inputs.

    Raises
    ------
    ValueError
        `noise_scale` is not positive and finite.
    """
    if not (np.isfinite(noise_scale) and noise_scale > 0.0):
        raise ValueError(f"noise_scale: found {noise_scale}, expected a positive number")
    nothing = np.zeros((states, CHANNELS))
    return FixSensor(first, noise_scale, np.eye(CHANNELS), np.zeros((CHANNELS, CHANNELS)), nothing, nothing.copy())


@implements(observe, FixSensor)
@kernel
def observe_fix(sensor, x, u, z):
    """The first six states."""
    for i in range(z.size):
        z[i] = x[i]


@implements(linearise_observation, FixSensor)
@kernel
def linearise_fix(sensor, x, u, H):
    """``H = [I 0]``."""
    for i in range(H.shape[0]):
        for j in range(H.shape[1]):
            H[i, j] = 1.0 if i == j else 0.0


@implements(measurement_noise, FixSensor)
@kernel
def fix_noise(sensor, u, R):
    """The reported variances of this epoch, times `noise_scale`."""
    for i in range(R.shape[0]):
        for j in range(R.shape[1]):
            R[i, j] = 0.0
        R[i, i] = sensor.noise_scale * u[sensor.first + i] ** 2
