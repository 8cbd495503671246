"""Channels, errors and their measures (section 6.2 of the paper), NEES and NIS.

Acceleration and rate are the states of F1; F0 and F2 have none and correct a sample by the estimated bias, as the paper does.
Errors are estimate minus truth over the epochs 1..N; those of angles are wrapped.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from scipy.spatial.transform import Rotation

from robins.foundation.rotation import dcm, wrapped
from robins.kalman.filter import Record
from robins.navigation.inertial_sensor import AUGMENTED
from robins.navigation.strapdown import ACCELEROMETER_BIAS, BA, FORCE, GYRO_BIAS, Q0, RATE, THETA, R, V
from robins.papers.imani2026.drive import CHANNELS
from robins.papers.imani2026.formulations import FORMS, Formulation, controls, readings, true_bias
from robins.papers.imani2026.sensors import Measurements

BOUND = 1000.0
"""A run whose velocity error passes this (m/s) has failed: a car."""
ANGLES = slice(9, 12)
AVERAGED = slice(3, 9)
"""Channels that an interval average exists for: acceleration and rate."""


class Measures(NamedTuple):
    """Measures of one kind of error, each of shape (runs, channels).

    Attributes
    ----------
    rmse, mean, sd : ndarray
        Equations (44)-(46) with the roots that belong to them: ``rmse^2 = mean^2 + sd^2``.
    drift : ndarray
        Error at the last epoch, signed.
    drift_integral : ndarray
        Sum of the errors times dt, the other reading of "accumulated error".
    """

    rmse: np.ndarray
    mean: np.ndarray
    sd: np.ndarray
    drift: np.ndarray
    drift_integral: np.ndarray


@njit(cache=True)
def cross_term(rate, v, i):
    """Element i of ``rate x v``."""
    j, k = (i + 1) % 3, (i + 2) % 3
    return rate[j] * v[k] - rate[k] * v[j]


@njit(cache=True)
def fill_channels(form, earth, states, samples, out):
    """`CHANNELS` of every epoch from states ``(N+1, n)`` and samples ``(N+1, 6)``."""
    C, coriolis, rate_in, q, v = np.empty((3, 3)), np.empty(3), np.empty(3), np.empty(4), np.empty(3)
    for k in range(states.shape[0]):
        for i in range(4):
            q[i] = states[k, Q0 + i]
        dcm(q, C)
        for i in range(3):
            v[i] = states[k, V + i]
        for i in range(3):
            transport = 0.0
            for j in range(3):
                transport += earth.transport[i, j] * v[j]
            coriolis[i], rate_in[i] = 2.0 * earth.rate[i] + transport, earth.rate[i] + transport
        for i in range(3):
            acceleration, rate = -cross_term(coriolis, v, i), 0.0
            for j in range(3):
                if form == AUGMENTED:
                    acceleration += C[i, j] * states[k, FORCE + j]
                    rate += C[i, j] * states[k, RATE + j]
                else:
                    acceleration += C[i, j] * (samples[k, j] - states[k, ACCELEROMETER_BIAS + j])
                    rate += C[i, j] * (samples[k, 3 + j] - states[k, GYRO_BIAS + j])
            if form != AUGMENTED:
                acceleration += earth.gravity[i]
                rate -= rate_in[i]
            out[k, i], out[k, 3 + i], out[k, 6 + i] = v[i], acceleration, rate
        out[k, 9] = math.atan2(C[2, 1], C[2, 2])
        out[k, 10] = -math.asin(min(1.0, max(-1.0, C[2, 0])))
        out[k, 11] = math.atan2(C[1, 0], C[0, 0])


def estimates(form: Formulation, record: Record, measured: Measurements) -> np.ndarray:
    """`CHANNELS` of every run and epoch, shape (runs, N+1, 12); epoch 0 has no sample, and epoch 1's acceleration and rate."""
    states = record.posterior
    inputs = controls(form.name, measured)
    samples = inputs[:, :, 6:] if form.name == "F2" else readings(form.name, measured)
    out = np.empty((*states.shape[:2], len(CHANNELS)))
    for run in range(len(states)):
        fill_channels(FORMS[form.name], form.model.earth, states[run], samples[run], out[run])
    out[:, 0, AVERAGED] = out[:, 1, AVERAGED]
    return out


def errors(estimate: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Estimate minus truth at the epochs 1..N, shape (runs, N, 12); `truth` ``(N+1, 12)`` or ``(runs, N+1, 12)``."""
    difference = estimate[:, 1:] - truth[..., 1:, :]
    difference[..., ANGLES] = wrapped(difference[..., ANGLES])
    return difference


def measure_errors(error: np.ndarray, dt: float) -> Measures:
    """`Measures` of errors ``(runs, N, channels)``."""
    with np.errstate(over="ignore", invalid="ignore"):  # a run that diverged may hold anything
        mean = np.mean(error, axis=1)  # (45) imani2026
        sd = np.sqrt(np.mean(np.square(error - mean[:, None]), axis=1))  # (46) imani2026
        rmse = np.sqrt(np.mean(np.square(error), axis=1))  # (44) imani2026
        return Measures(rmse, mean, sd, error[:, -1], np.sum(error, axis=1) * dt)


def failures(record: Record, error: np.ndarray) -> np.ndarray:
    """Why each run failed, "" where it did not, shape (runs,) of str."""
    with np.errstate(invalid="ignore"):
        beyond = ~(np.max(np.abs(error[..., :3]), axis=(1, 2)) <= BOUND)
    return np.array(
        [
            f"no Cholesky factor or not finite at epoch {epoch}" if epoch >= 0
            else f"velocity error beyond {BOUND:g} m/s" if far else ""
            for epoch, far in zip(record.failed, beyond, strict=True)
        ]
    )  # fmt: skip


def squared_length(error: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """``e^T P^-1 e`` for errors ``(..., n)`` and covariances ``(..., n, n)``; NaN where either is not finite."""
    sound = np.all(np.isfinite(error), axis=-1) & np.all(np.isfinite(covariance), axis=(-1, -2))
    out = np.full(error.shape[:-1], np.nan)
    if sound.any():
        out[sound] = np.einsum("ki,ki->k", error[sound], np.linalg.solve(covariance[sound], error[sound][..., None])[..., 0])
    return out


def attitude_errors(quaternion: np.ndarray, true_quaternion: np.ndarray) -> np.ndarray:
    """Rotation vectors d in b with ``C = C_hat exp([d x])``, shape (runs, M, 3); NaN where an estimate is not finite."""
    out = np.full((*quaternion.shape[:-1], 3), np.nan)
    sound = np.all(np.isfinite(quaternion), axis=-1)
    true = np.broadcast_to(true_quaternion, quaternion.shape)[sound]
    if sound.any():
        estimated = Rotation.from_quat(quaternion[sound], scalar_first=True)
        out[sound] = (estimated.inv() * Rotation.from_quat(true, scalar_first=True)).as_rotvec()
    return out


def nees(form: Formulation, record: Record, measured: Measurements, true_quaternion: np.ndarray, marks: np.ndarray) -> dict:
    """Normalised estimation error squared of attitude (3) and biases (6) at the marked epochs, each (runs, M)."""
    states = record.posterior[:, marks]
    attitude = attitude_errors(states[..., Q0 : Q0 + 4], true_quaternion[marks])
    bias = true_bias(form.name, measured)[:, None] - states[..., ACCELEROMETER_BIAS : ACCELEROMETER_BIAS + 6]
    P = record.covariance
    turned, biased = slice(THETA, THETA + 3), slice(BA, BA + 6)
    return {
        "nees_attitude": squared_length(attitude, P[..., turned, turned]),
        "nees_bias": squared_length(bias, P[..., biased, biased]),
    }


def position_errors(record: Record, position: np.ndarray) -> dict[str, np.ndarray]:
    """Root mean square and last position error of each run, (runs, 3)."""
    error = record.posterior[:, 1:, R : R + 3] - position[1:]
    return {"position_rms": np.sqrt(np.mean(np.square(error), axis=1)), "position_final": error[:, -1]}
