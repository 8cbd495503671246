"""The filter of this package on a drive: the run that is timed, and one that keeps whole covariances for comparison."""

import numpy as np
from numba import njit

from benchmarks.models import CHANNELS, STATES, Drive
from robins.kalman.filter import Record, run_filter
from robins.kalman.model import linearise_observation, observe
from robins.kalman.predict import Ekf, predict
from robins.kalman.tuning import matching
from robins.kalman.update import update, workspace
from robins.kalman.weights import Weighting, weighting

WINDOW = 20


def weightings() -> dict[str, Weighting]:
    """The weights that are timed: none, and covariance matching over `WINDOW` innovations."""
    return {"unit weights": weighting("unit"), "covariance matching": matching(WINDOW, CHANNELS)}


def run_ours(drive: Drive, weights: Weighting) -> Record:
    """Filter the whole drive with `robins.kalman.filter.run_filter`."""
    valid = np.ones(len(drive.controls), bool)
    return run_filter(Ekf(), drive.model, drive.sensor, weights, drive.x0[None], drive.P0, drive.controls, drive.measurements[None],
                      valid, STATES, False)  # fmt: skip


def run_whole(drive: Drive) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """States ``(K, 9)``, covariances ``(K, 9, 9)`` and NIS ``(K,)`` after each update with unit weights."""
    epochs = len(drive.controls)
    states, covariances, nis = np.empty((epochs, STATES)), np.empty((epochs, STATES, STATES)), np.empty(epochs)
    compose(
        Ekf(), drive.model, drive.sensor, drive.x0.copy(), drive.P0.copy(), drive.controls, drive.measurements, states, covariances, nis
    )
    return states, covariances, nis


@njit
def compose(predictor, model, sensor, x, P, controls, measurements, states, covariances, nis):
    """The same two calls for each epoch as in `run_filter`, without its record."""
    m = measurements.shape[1]
    work, weights, predicted = workspace(x.size, m), np.ones(m), np.empty(m)
    for k in range(measurements.shape[0]):
        linearise_observation(sensor, x, controls[k], work.H)
        observe(sensor, x, controls[k], predicted)
        for j in range(m):
            work.innovation[j] = measurements[k, j] - predicted[j]
        nis[k] = update(x, P, work.innovation, work.H, sensor.R, sensor.R_fixed, sensor.C_update, False, weights, work)
        for i in range(x.size):
            states[k, i] = x[i]
            for j in range(x.size):
                covariances[k, i, j] = P[i, j]
        predict(predictor, model, x, P, controls[k], work)
