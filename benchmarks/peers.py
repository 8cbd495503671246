"""The same filter in filterpy: its `ExtendedKalmanFilter` with our model written in NumPy."""

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from benchmarks.models import AZIMUTH, BIAS, CHANNELS, SCALE, STATES, VE, VN, VU, Drive, E, N, U, Vehicle


def propagate(model: Vehicle, x: np.ndarray, u: np.ndarray) -> np.ndarray:
    """The state one step later; see `benchmarks.models`."""
    speed = (1.0 + x[SCALE]) * u[0]
    level = speed * np.cos(u[2])
    moved = x.copy()
    moved[[N, E, U]] += model.dt * x[[VN, VE, VU]]
    moved[VE], moved[VN], moved[VU] = level * np.sin(x[AZIMUTH]), level * np.cos(x[AZIMUTH]), speed * np.sin(u[2])
    moved[AZIMUTH] += model.dt * (u[1] - x[BIAS])
    moved[BIAS] *= model.bias_decay
    moved[SCALE] *= model.scale_decay
    return moved


def jacobian(model: Vehicle, x: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Derivative ``(9, 9)`` of `propagate` by x."""
    F = np.zeros((STATES, STATES))
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
    return F


class VehicleFilter(ExtendedKalmanFilter):
    """filterpy's filter with the nonlinear prediction of the state that its documentation asks a subclass for."""

    def __init__(self, drive: Drive):
        super().__init__(dim_x=STATES, dim_z=CHANNELS)
        self.model, self.sensor = drive.model, drive.sensor
        self.x, self.P, self.R = drive.x0.copy(), drive.P0.copy(), drive.sensor.R.copy()

    def predict_x(self, u=0):
        self.F, self.Q = jacobian(self.model, self.x, u), np.diag(self.model.noise)
        self.x = propagate(self.model, self.x, u)


def run_filterpy(drive: Drive) -> tuple[np.ndarray, np.ndarray]:
    """States ``(K, 9)`` and covariances ``(K, 9, 9)`` after each update."""
    ekf, H = VehicleFilter(drive), drive.sensor.H
    epochs = len(drive.controls)
    states, covariances = np.empty((epochs, STATES)), np.empty((epochs, STATES, STATES))
    for k in range(epochs):
        ekf.update(drive.measurements[k], lambda x: H, lambda x: H @ x)
        states[k], covariances[k] = ekf.x, ekf.P
        if k + 1 < epochs:
            ekf.predict(drive.controls[k])
    return states, covariances
