"""The same filters in filterpy: its `ExtendedKalmanFilter` and `UnscentedKalmanFilter` with our model written in NumPy."""

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter, MerweScaledSigmaPoints, UnscentedKalmanFilter
from numba import njit

from benchmarks.models import ALPHA, AZIMUTH, BETA, BIAS, CHANNELS, KAPPA, SCALE, STATES, VE, VN, VU, Drive, E, N, U, Vehicle
from robins.kalman.predict import Ukf
from robins.navigation.inertial_sensor import linearise_inertial, observe_inertial
from robins.navigation.strapdown import linearise_strapdown, propagate_strapdown, retract_strapdown


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
        self.model, self.H = drive.model, drive.sensor.H
        self.x, self.P, self.R = drive.x0.copy(), drive.P0.copy(), drive.sensor.R.copy()

    def predict_x(self, u=0):
        self.F, self.Q = jacobian(self.model, self.x, u), np.diag(self.model.noise)
        self.x = propagate(self.model, self.x, u)

    def process(self, z: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Update with the measurement `z`; returns the state."""
        self.update(z, lambda x: self.H, lambda x: self.H @ x)
        return self.x


class VehicleSigmaFilter(UnscentedKalmanFilter):
    """filterpy's unscented filter as its documentation uses it: f, h and `MerweScaledSigmaPoints` given to the constructor.

    Its `predict` draws the points again for the update, which then is the linear one, since h is linear. An update that comes before
    the first prediction finds no points, so they are drawn here.
    """

    def __init__(self, drive: Drive):
        H, points = drive.sensor.H, MerweScaledSigmaPoints(STATES, ALPHA, BETA, KAPPA)
        super().__init__(STATES, CHANNELS, drive.model.dt, lambda x: H @ x, lambda x, dt, u: propagate(drive.model, x, u), points)
        self.x, self.P = drive.x0.copy(), drive.P0.copy()
        self.Q, self.R = np.diag(drive.model.noise), drive.sensor.R.copy()
        self.sigmas_f = points.sigma_points(self.x, self.P)

    def process(self, z: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Update with the measurement `z`; returns the state."""
        self.update(z)
        return self.x


@njit
def move(model, state, u, F, Q):
    """Jacobian and noise of the step, and the step, in one call: each costs filterpy microseconds for the model's arrays alone."""
    linearise_strapdown(model, state, u, F, Q)
    propagate_strapdown(model, state, u)


@njit
def look(sensor, state, u, H, z):
    """H and the predicted reading, in one call."""
    linearise_inertial(sensor, state, u, H)
    observe_inertial(sensor, state, u, z)


class StrapdownFilter(ExtendedKalmanFilter):
    """filterpy's filter of the error; F, Q, H and the state itself come from our compiled kernels.

    filterpy's own x is the error: zero but between an update and the correction of the state that follows.
    """

    def __init__(self, drive: Drive):
        errors = drive.P0.shape[0]
        super().__init__(dim_x=errors, dim_z=CHANNELS)
        self.model, self.sensor, self.state = drive.model, drive.sensor, drive.x0.copy()
        self.x, self.P, self.R = np.zeros(errors), drive.P0.copy(), drive.sensor.R.copy()
        self.F, self.Q = np.empty((errors, errors)), np.empty((errors, errors))
        self.H, self.predicted = np.empty((CHANNELS, errors)), np.empty(CHANNELS)

    def predict_x(self, u=0):
        move(self.model, self.state, u, self.F, self.Q)

    def process(self, z: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Update with the measurement `z`; returns the state."""
        look(self.sensor, self.state, u, self.H, self.predicted)
        self.update(z, lambda x: self.H, lambda x: self.predicted)
        retract_strapdown(self.model, self.state, self.x)
        self.x = np.zeros_like(self.x)
        return self.state


def filterpy_filter(drive: Drive) -> VehicleFilter | VehicleSigmaFilter | StrapdownFilter:
    """The filter of `drive`, at its start."""
    if isinstance(drive.predictor, Ukf):
        return VehicleSigmaFilter(drive)
    return VehicleFilter(drive) if isinstance(drive.model, Vehicle) else StrapdownFilter(drive)


def run_filterpy(drive: Drive) -> tuple[np.ndarray, np.ndarray]:
    """States ``(K, s)`` and covariances ``(K, n, n)`` after each update."""
    peer, epochs = filterpy_filter(drive), len(drive.controls)
    states, covariances = np.empty((epochs, drive.x0.size)), np.empty((epochs, *drive.P0.shape))
    for k in range(epochs):
        states[k], covariances[k] = peer.process(drive.measurements[k], drive.controls[k]), peer.P
        if k + 1 < epochs:
            peer.predict(u=drive.controls[k])
    return states, covariances
