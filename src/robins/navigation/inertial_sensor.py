"""What an inertial sensor measures, seen from the states of `robins.navigation.strapdown`.

QUASI_STATIC   z = [-C^T g + b_a; C^T omega_in + b_g]: the vehicle is taken to stand still
AUGMENTED      z = [-E C^T g + x_f + b_a; C^T omega_in + x_omega + b_g], E = exp([x_omega dt/2 x]): the average over the step that
               ends here, whose middle is half a rotation back
DIFFERENCE     z = u - b: a second, unbiased sensor against the one that drives the mechanisation; `controls` hold in columns 6 to
               11 the driving sensor's reading of the interval that ends here

omega_in holds the transport rate; its derivative with respect to velocity (1.6e-7 1/m) is left out of H, which so has the printed
sparsity.
"""

from typing import NamedTuple

import numpy as np

from robins.foundation.rotation import dcm, dcm_exponential, right_jacobian
from robins.foundation.smallmat import kernel, multiply
from robins.kalman.extension import implements
from robins.kalman.model import linearise_observation, observe
from robins.navigation.strapdown import (
    ACCELEROMETER_BIAS,
    AUGMENTED_ERRORS,
    BA,
    ERRORS,
    FORCE,
    GYRO_BIAS,
    Q0,
    RATE,
    THETA,
    XF,
    XW,
    Earth,
    V,
)

QUASI_STATIC, AUGMENTED, DIFFERENCE = range(3)
CHANNELS = 6


class InertialSensor(NamedTuple):
    """Form, step and noise of the measurement; R, R_fixed, C_update, C_predict as in `robins.kalman.model.Sensor`.

    Attributes
    ----------
    form : int
        `QUASI_STATIC`, `AUGMENTED` or `DIFFERENCE`.
    dt : float
        Interval that a sample averages over (s).
    earth : Earth
    q, C, E, J, reaction, rate, work : ndarray
        Scratch.
    """

    form: int
    dt: float
    earth: Earth
    R: np.ndarray
    R_fixed: np.ndarray
    C_update: np.ndarray
    C_predict: np.ndarray
    q: np.ndarray
    C: np.ndarray
    E: np.ndarray
    J: np.ndarray
    reaction: np.ndarray
    rate: np.ndarray
    work: np.ndarray


def inertial_sensor(form: int, dt: float, earth: Earth, noise) -> InertialSensor:
    """An `InertialSensor` with independent `noise` variances ``(6,)``, accelerometers first."""
    n = AUGMENTED_ERRORS if form == AUGMENTED else ERRORS
    zero = np.zeros((CHANNELS, CHANNELS)), np.zeros((n, CHANNELS)), np.zeros((n, CHANNELS))
    scratch = np.zeros(4), *(np.zeros((3, 3)) for _ in range(3)), np.zeros(3), np.zeros(3), np.zeros((3, 3))
    return InertialSensor(form, float(dt), earth, np.diag(np.asarray(noise, float)), *zero, *scratch)


@kernel
def load_reactions(sensor, x):
    """``C^T g`` and ``C^T omega_in``, into the scratch."""
    for i in range(4):
        sensor.q[i] = x[Q0 + i]
    dcm(sensor.q, sensor.C)
    for i in range(3):
        sensor.reaction[i] = sensor.rate[i] = 0.0
        for j in range(3):
            rate = sensor.earth.rate[j]
            for k in range(3):
                rate += sensor.earth.transport[j, k] * x[V + k]
            sensor.reaction[i] += sensor.C[j, i] * sensor.earth.gravity[j]
            sensor.rate[i] += sensor.C[j, i] * rate


@implements(observe, InertialSensor)
@kernel
def observe_inertial(sensor, x, u, z):
    """The predicted reading."""
    if sensor.form == DIFFERENCE:
        for i in range(CHANNELS):
            z[i] = u[CHANNELS + i] - x[ACCELEROMETER_BIAS + i]
        return
    load_reactions(sensor, x)
    if sensor.form == AUGMENTED:
        for i in range(3):
            sensor.q[i] = x[RATE + i]
        dcm_exponential(sensor.q, 0.5 * sensor.dt, sensor.E)
    for i in range(3):
        z[3 + i] = sensor.rate[i] + x[GYRO_BIAS + i]  # (16), (17) imani2026
        z[i] = x[ACCELEROMETER_BIAS + i]
        if sensor.form == AUGMENTED:
            z[3 + i] += x[RATE + i]  # (9) imani2026
            z[i] += x[FORCE + i]  # (8) imani2026
            for j in range(3):
                z[i] -= sensor.E[i, j] * sensor.reaction[j]
        else:
            z[i] -= sensor.reaction[i]


@kernel
def cross(a, scale, out):
    """``out = scale [a x]``."""
    out[0, 0] = out[1, 1] = out[2, 2] = 0.0
    out[0, 1], out[1, 0] = -scale * a[2], scale * a[2]
    out[0, 2], out[2, 0] = scale * a[1], -scale * a[1]
    out[1, 2], out[2, 1] = -scale * a[0], scale * a[0]


@implements(linearise_observation, InertialSensor)
@kernel
def linearise_inertial(sensor, x, u, H):
    """H of the error state."""
    for i in range(H.shape[0]):
        for j in range(H.shape[1]):
            H[i, j] = 0.0
    sign = -1.0 if sensor.form == DIFFERENCE else 1.0
    for i in range(CHANNELS):
        H[i, BA + i] = sign  # (26) imani2026
    if sensor.form == DIFFERENCE:
        return
    load_reactions(sensor, x)
    cross(sensor.reaction, -1.0, sensor.work)
    if sensor.form == AUGMENTED:
        for i in range(3):
            sensor.q[i] = x[RATE + i]
        dcm_exponential(sensor.q, 0.5 * sensor.dt, sensor.E)
        multiply(sensor.E, sensor.work, sensor.C)  # -E [C^T g x]
        right_jacobian(sensor.q, 0.5 * sensor.dt, sensor.J)
        for i in range(3):
            H[i, XF + i] = H[3 + i, XW + i] = 1.0
            for j in range(3):
                H[i, THETA + j] = sensor.C[i, j]
                for k in range(3):
                    H[i, XW + j] -= 0.5 * sensor.dt * sensor.C[i, k] * sensor.J[k, j]
    else:
        for i in range(3):
            for j in range(3):
                H[i, THETA + j] = sensor.work[i, j]  # (26) imani2026
    cross(sensor.rate, 1.0, sensor.work)
    for i in range(3):
        for j in range(3):
            H[3 + i, THETA + j] = sensor.work[i, j]  # (26) imani2026
