"""The vehicle of nine states that the peers of the benchmark filter: an odometer, a vertical gyro and satellite fixes.

State ``[N E U vE vN vU azimuth bias scale]``: position north, east, up (m), velocity east, north, up (m/s),
azimuth clockwise from north (rad), gyro bias (rad/s), scale error of the odometer (1). Inputs
``[speed, turn rate, pitch]`` (m/s, rad/s, rad): odometer speed V, gyro reading omega, road's slope p.

    position += dt velocity                         azimuth += dt (omega - bias)
    velocity  = (1 + scale) V [sin A cos p, cos A cos p, sin p]
    bias     *= exp(-dt / tau_bias)                 scale   *= exp(-dt / tau_scale)

with A the azimuth and the scale before the step. Measured: position and velocity. This is a reduced
inertial sensor system as in Noureldin, Karamat & Georgy 2013, Fundamentals of Inertial Navigation, chapter 9,
on a flat earth.
"""

from typing import NamedTuple

import numpy as np

from robins.foundation.randomness import stream
from robins.foundation.smallmat import kernel
from robins.kalman.extension import implements
from robins.kalman.model import linear_sensor, linearise, process_noise, propagate
from robins.kalman.predict import Ekf, Ukf, unscented

STATES, CHANNELS, INPUTS = 9, 6, 3
ALPHA, BETA, KAPPA = 0.5, 2.0, 0.0
"""Of the sigma points. A peer sums 2n+1 weighted points, whose digits cancel as alpha becomes smaller; no time depends on it."""
N, E, U, VE, VN, VU, AZIMUTH, BIAS, SCALE = range(STATES)


class Vehicle(NamedTuple):
    """Step `dt` (s), decay of bias and scale over a step, and the process noise variances `noise` ``(9,)`` of a step."""

    dt: float
    bias_decay: float
    scale_decay: float
    noise: np.ndarray


@implements(propagate, Vehicle)
@kernel
def propagate_vehicle(model, x, u):
    x[N] += model.dt * x[VN]
    x[E] += model.dt * x[VE]
    x[U] += model.dt * x[VU]
    speed = (1.0 + x[SCALE]) * u[0]
    level = speed * np.cos(u[2])
    x[VE] = level * np.sin(x[AZIMUTH])
    x[VN] = level * np.cos(x[AZIMUTH])
    x[VU] = speed * np.sin(u[2])
    x[AZIMUTH] += model.dt * (u[1] - x[BIAS])
    x[BIAS] *= model.bias_decay
    x[SCALE] *= model.scale_decay


@implements(process_noise, Vehicle)
@kernel
def process_noise_vehicle(model, x, u, Q):
    for i in range(STATES):
        for j in range(STATES):
            Q[i, j] = 0.0
        Q[i, i] = model.noise[i]


@implements(linearise, Vehicle)
@kernel
def linearise_vehicle(model, x, u, F, Q):
    process_noise_vehicle(model, x, u, Q)
    for i in range(STATES):
        for j in range(STATES):
            F[i, j] = 0.0
    F[N, N] = F[E, E] = F[U, U] = F[AZIMUTH, AZIMUTH] = 1.0
    F[N, VN] = F[E, VE] = F[U, VU] = model.dt
    sine, cosine = np.sin(x[AZIMUTH]), np.cos(x[AZIMUTH])
    per_scale = u[0] * np.cos(u[2])
    level = (1.0 + x[SCALE]) * per_scale
    F[VE, AZIMUTH], F[VE, SCALE] = level * cosine, per_scale * sine
    F[VN, AZIMUTH], F[VN, SCALE] = -level * sine, per_scale * cosine
    F[VU, SCALE] = u[0] * np.sin(u[2])
    F[AZIMUTH, BIAS] = -model.dt
    F[BIAS, BIAS], F[SCALE, SCALE] = model.bias_decay, model.scale_decay


class Drive(NamedTuple):
    """A simulated drive of K epochs and the filter's settings for it, with s numbers in the state and n in its error.

    Attributes
    ----------
    model, sensor : NamedTuple
    x0, P0 : ndarray, shapes (s,) and (n, n)
    controls, measurements, truth : ndarray, shapes (K, l), (K, m) and (K, s)
    predictor : Ekf or Ukf
    """

    model: NamedTuple
    sensor: NamedTuple
    x0: np.ndarray
    P0: np.ndarray
    controls: np.ndarray
    measurements: np.ndarray
    truth: np.ndarray
    predictor: Ekf | Ukf = Ekf()


def drive(epochs: int, seed: int = 1, dt: float = 0.1) -> Drive:
    """Simulate a winding drive up and down hills, `dt` seconds an epoch."""
    time = dt * np.arange(epochs)
    controls = np.column_stack([12 + 5 * np.sin(0.05 * time), 0.2 * np.sin(0.11 * time), 0.04 * np.sin(0.03 * time)])
    noise = np.array([1e-4, 1e-4, 1e-4, 1e-2, 1e-2, 1e-3, 1e-7, 1e-11, 1e-9])
    model = Vehicle(dt, np.exp(-dt / 3600.0), np.exp(-dt / 600.0), noise)
    deviation = np.array([5.0, 5.0, 5.0, 0.5, 0.5, 0.5, 0.05, 1e-3, 0.02])
    measured = np.array([2.0, 2.0, 4.0, 0.1, 0.1, 0.2])
    process_noise = stream(seed, "benchmarks/process").standard_normal((epochs, STATES)) * np.sqrt(noise)
    sensor_noise = stream(seed, "benchmarks/sensor").standard_normal((epochs, CHANNELS)) * measured
    truth = np.empty((epochs, STATES))
    x = np.array([0.0, 0.0, 0.0, 0.0, 12.0, 0.0, 0.3, 2e-3, 0.03])
    for k in range(epochs):
        truth[k] = x
        propagate_vehicle.py_func(model, x, controls[k])
        x += process_noise[k]
    sensor = linear_sensor(np.eye(CHANNELS, STATES), np.diag(measured**2), inputs=INPUTS)
    x0 = truth[0] + deviation * stream(seed, "benchmarks/start").standard_normal(STATES)
    return Drive(model, sensor, x0, np.diag(deviation**2), controls, truth[:, :CHANNELS] + sensor_noise, truth)


def unscented_drive(epochs: int) -> Drive:
    """The same `drive`, for an unscented filter."""
    return drive(epochs)._replace(predictor=unscented(STATES, ALPHA, BETA, KAPPA))
