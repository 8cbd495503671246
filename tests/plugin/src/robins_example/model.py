"""A cart on a straight rail, and ranges to it from beacons beside the rail. SI units.

State: position and velocity along the rail. Input: commanded acceleration.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from robins.kalman.extension import implements
from robins.kalman.model import linearise, linearise_observation, observe, propagate


class Cart(NamedTuple):
    """``v' = u - drag v |v| + w``: sampling time `dt` (s), `drag` (1/m), standard deviation of w (m/s^2), held over a step."""

    dt: float
    drag: float
    acceleration_sd: float


@implements(propagate, Cart)
@njit(cache=True)
def propagate_cart(model, x, u):
    velocity = x[1]
    x[0] += model.dt * velocity
    x[1] += model.dt * (u[0] - model.drag * velocity * abs(velocity))  # (2) example2026


@implements(linearise, Cart)
@njit(cache=True)
def linearise_cart(model, x, u, F, Q):
    F[0, 0], F[0, 1] = 1.0, model.dt
    F[1, 0], F[1, 1] = 0.0, 1.0 - 2.0 * model.dt * model.drag * abs(x[1])
    Q[:] = 0.0
    Q[1, 1] = (model.dt * model.acceleration_sd) ** 2


class Ranges(NamedTuple):
    """Distances to `beacons` ``(m, 2)``: place along the rail, distance from it (m). Noise as in `robins.kalman.model.Sensor`."""

    beacons: np.ndarray
    R: np.ndarray
    R_fixed: np.ndarray
    C_update: np.ndarray
    C_predict: np.ndarray


@implements(observe, Ranges)
@njit(cache=True)
def observe_ranges(sensor, x, u, z):
    for i in range(z.size):
        z[i] = np.hypot(sensor.beacons[i, 0] - x[0], sensor.beacons[i, 1])


@implements(linearise_observation, Ranges)
@njit(cache=True)
def linearise_ranges(sensor, x, u, H):
    for i in range(H.shape[0]):
        along = x[0] - sensor.beacons[i, 0]
        H[i, 0] = along / np.hypot(along, sensor.beacons[i, 1])
        H[i, 1] = 0.0


def range_sensor(beacons: np.ndarray, sd: float) -> Ranges:
    """Ranges with independent noise of standard deviation `sd` (m), all of which the weights act on."""
    m = len(beacons)
    return Ranges(beacons, np.eye(m) * sd**2, np.zeros((m, m)), np.zeros((2, m)), np.zeros((2, m)))
