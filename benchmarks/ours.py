"""The filter of this package on a drive: the run that is timed, and one that keeps whole covariances for comparison."""

import numpy as np
from numba import njit

from benchmarks.models import Drive
from robins.kalman.filter import Record, run_filter
from robins.kalman.model import linearise_observation, observe, retract
from robins.kalman.predict import predict
from robins.kalman.tuning import matching
from robins.kalman.update import update_error, workspace
from robins.kalman.weights import Weighting, weighting

WINDOW = 20


def weightings(channels: int = 6) -> dict[str, Weighting]:
    """The weights that are timed: none, and covariance matching over `WINDOW` innovations."""
    return {"unit weights": weighting("unit"), "covariance matching": matching(WINDOW, channels)}


def run_ours(drive: Drive, weights: Weighting) -> Record:
    """Filter the whole drive with `robins.kalman.filter.run_filter`."""
    valid = np.ones(len(drive.controls), bool)
    return run_filter(drive.predictor, drive.model, drive.sensor, weights, drive.x0[None], drive.P0, drive.controls,
                      drive.measurements[None], valid, drive.x0.size, False)  # fmt: skip


def run_whole(drive: Drive) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """States ``(K, s)``, covariances ``(K, n, n)`` and NIS ``(K,)`` after each update with unit weights."""
    epochs = len(drive.controls)
    states, covariances, nis = np.empty((epochs, drive.x0.size)), np.empty((epochs, *drive.P0.shape)), np.empty(epochs)
    compose(
        drive.predictor, drive.model, drive.sensor, drive.x0.copy(), drive.P0.copy(), drive.controls, drive.measurements,
        states, covariances, nis,
    )  # fmt: skip
    return states, covariances, nis


@njit
def compose(predictor, model, sensor, x, P, controls, measurements, states, covariances, nis):
    """The same calls for each epoch as in `run_filter`, without its record."""
    n, m = P.shape[0], measurements.shape[1]
    work, weights, predicted = workspace(n, m), np.ones(m), np.empty(m)
    for k in range(measurements.shape[0]):
        linearise_observation(sensor, x, controls[k], work.H)
        observe(sensor, x, controls[k], predicted)
        for j in range(m):
            work.innovation[j] = measurements[k, j] - predicted[j]
        nis[k] = update_error(P, work.innovation, work.H, sensor.R, sensor.R_fixed, sensor.C_update, False, weights, work)
        retract(model, x, work.shift)
        for i in range(x.size):
            states[k, i] = x[i]
        for i in range(n):
            for j in range(n):
                covariances[k, i, j] = P[i, j]
        predict(predictor, model, x, P, controls[k], work)
