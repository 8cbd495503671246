"""Section 4 of the example: one filter, composed three times. Each variant is a row, none is a copy of a filter."""

import numpy as np
import pandas as pd

from robins.evaluate.metrics import ensemble_rms, window_rms
from robins.kalman.filter import run_filter
from robins.kalman.predict import Ekf
from robins.kalman.weights import weighting
from robins.papers.protocol import Output, Settings
from robins_example.model import Cart, range_sensor
from robins_example.scenario import Parameters, simulate


def estimate(settings: Settings, weight: str = "unit", constants: tuple = (), inflation: float = 1.0) -> Output:
    """One variant on every run: RMSE of the position (m) and failures; the ensemble's error over time.

    Parameters
    ----------
    weight, constants : str, tuple
        A registered weight function and its constants.
    inflation : float
        Factor on the assumed variance of the ranges.
    """
    p = Parameters()
    ensemble = simulate(p, settings.seed, settings.sizes["runs"])
    record = run_filter(
        Ekf(),
        Cart(p.dt, p.drag, p.acceleration_sd),
        range_sensor(np.array(p.beacons), p.range_sd * inflation**0.5),
        weighting(weight, constants),
        ensemble.guess,
        np.diag(np.square(p.first_guess_sd)),
        p.controls,
        ensemble.ranges,
        np.ones(p.steps, dtype=bool),
        1,  # states to record: the position
        False,
    )
    errors = record.posterior - ensemble.truth[:, :, :1]
    failed = (record.failed >= 0) | ~(np.abs(errors).max(axis=(1, 2)) < p.divergence)
    rmse = window_rms(errors, 0, p.steps - 1, p.steps)[:, 0]
    table = pd.DataFrame({"run": np.arange(len(rmse)), "rmse": np.where(failed, np.nan, rmse), "failed": failed})
    return Output(table, {} if failed.all() else {"rms_error": ensemble_rms(errors, ~failed)[:, 0]})
