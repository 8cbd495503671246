"""Section 5.2 of the paper: scenarios and variants over an ensemble of runs, reduced to what the tables need.

Every variant sees the same noise. Only scores, quantiles and run 0 leave a job; trajectories do not.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pandas as pd

from robins.evaluate.metrics import ensemble_quantiles, ensemble_rms, window_rms
from robins.kalman.differencing import differenced_measurements
from robins.kalman.filter import Record
from robins.navigation.aircraft import STATES
from robins.papers.hajiyev2023.estimators import Filter, build, run
from robins.papers.hajiyev2023.scenario import (
    BRANCHES,
    CONDITIONS,
    SETTLED,
    STEADY,
    Draws,
    Ensemble,
    Parameters,
    baseline,
    controls,
    differenced,
    draw,
    simulate,
    system,
)
from robins.papers.protocol import Output, Settings

STREAM = "aircraft"
"""Scenario name of the streams; both branches read the same ones."""
LAGS = 20
QUANTILES = (0.025, 0.25, 0.5, 0.75, 0.975)
SCALE_QUANTILES = (0.05, 0.5, 0.95)


def scenario(settings: Settings, branch: str) -> Output:
    """Truth, measurements and matrices of run 0 of a branch, and the residual series for the noise diagnostics."""
    parameters = baseline(branch)
    matrices = system(parameters, settings.options["plant"])
    draws = draw(settings.seed, STREAM, range(1), parameters.steps)
    ensemble = simulate(parameters, matrices, draws)
    mu = differenced_measurements(ensemble.z["healthy"], matrices.A_n)[0, :-1]
    d = differenced(matrices)
    xi = mu - controls(parameters)[:-1] @ d.D.T - ensemble.x[0, :-1] @ d.H_d.T  # (6), (8) hajiyev2023 solved for xi
    arrays = {"truth": ensemble.x[0], "lambda": ensemble.lam[0], "controls": controls(parameters)}
    arrays |= {f"z.{condition}": z[0] for condition, z in ensemble.z.items()}
    arrays |= {f"matrix.{name}": matrix for name, matrix in matrices._asdict().items()}
    arrays |= residuals(parameters, draws, ensemble, xi)
    names = ("sigma_w", "sigma_v", "sigma_lambda", "sigma_0")
    table = pd.DataFrame({"state": STATES, **{name: parameters.si(name) for name in names}})
    return Output(table, arrays)


def residuals(parameters: Parameters, draws: Draws, ensemble: Ensemble, xi: np.ndarray) -> dict[str, np.ndarray]:
    """The series of run 0 that the noise diagnostics look at, with the rate and, where it is known, the law's deviation.

    Two of the eight process noises are zero and have no distribution; they are left out.
    """
    driven = parameters.si("sigma_w") > 0
    series = {
        "process-noise": (draws.w[0] * parameters.si("sigma_w"))[:, driven],
        "measurement-noise": draws.v[0] * parameters.si("sigma_v"),
        "fault-noise": ensemble.z["fault"][0] - ensemble.x[0] - ensemble.lam[0],
        "correlated-error": ensemble.lam[0],
        "differenced-noise": xi,
    }
    arrays = {f"residual.{name}": values for name, values in series.items()}
    arrays |= {f"rate_hz.{name}": np.array(1.0 / parameters.dt) for name in series}
    known = {"process-noise": parameters.si("sigma_w")[driven], "measurement-noise": parameters.si("sigma_v")}
    return arrays | {f"sd.{name}": deviation for name, deviation in known.items()}


def diverged(record: Record, errors: np.ndarray, score: np.ndarray, bound: float) -> np.ndarray:
    """True for the runs that failed: in the algebra, by an error beyond the scenario's bound, or by a score that is not finite.

    Parameters
    ----------
    errors : ndarray, shape (runs, N, 8)
        NaN where there is no estimate.
    score : ndarray, shape (runs, 8)
    """
    beyond = np.nanmax(np.abs(errors), axis=(1, 2), initial=0.0) > bound
    return (record.failed >= 0) | beyond | ~np.all(np.isfinite(score), axis=1)


def epoch_mean(values: np.ndarray) -> np.ndarray:
    """Mean over the epochs that have a value, shape (runs, N) to (runs,); NaN where a run has none."""
    count = np.sum(~np.isnan(values), axis=1)
    return np.where(count > 0, np.nansum(values, axis=1) / np.maximum(count, 1), np.nan)


def scores(form: Filter, record: Record, ensemble: Ensemble, parameters: Parameters, runs: range) -> pd.DataFrame:
    """One row for each run, kind of estimate and state; see `variant`."""
    first, last = parameters.fault_start, parameters.fault_start + parameters.fault_length
    nis_settled, nis_window = epoch_mean(record.nis[:, SETTLED:]), epoch_mean(record.nis[:, first:last])
    scale = np.broadcast_to(np.mean(1.0 / record.weights[:, STEADY], axis=1), (len(runs), 8))
    gain = np.broadcast_to(np.mean(record.gain_norm[:, STEADY], axis=1), (len(runs), 8))
    own_gain = np.broadcast_to(np.mean(np.abs(record.gain_diagonal[:, STEADY]), axis=1), (len(runs), 8))
    frames = []
    for kind, moment in (("filtered", form.filtered), ("delayed", form.delayed)):
        if not moment:
            continue
        errors = getattr(record, moment) - ensemble.x
        rmse = window_rms(errors, first, last, parameters.fault_length)  # (29) hajiyev2023: 71 terms over 70
        failed = diverged(record, errors, rmse, parameters.divergence)
        reasons = np.where(record.failed >= 0, [f"no Cholesky factor or not finite at epoch {k}" for k in record.failed],
                           np.where(failed, f"error beyond {parameters.divergence:g} or not finite", ""))  # fmt: skip
        frames.append(pd.DataFrame({
            "run": np.repeat(np.fromiter(runs, int), 8),
            "estimate": kind,
            "state": np.tile(STATES, len(runs)),
            "rmse": rmse.ravel(),
            "scale": scale.ravel(),
            "gain_norm": gain.ravel(),
            "own_gain": own_gain.ravel(),
            "nis_settled": np.repeat(nis_settled, 8),
            "nis_window": np.repeat(nis_window, 8),
            "failed": np.repeat(failed, 8),
            "reason": np.repeat(reasons, 8),
        }))  # fmt: skip
    return pd.concat(frames, ignore_index=True)


def autocorrelation(innovation: np.ndarray, variance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Autocorrelation of the settled innovations, pooled over runs and standardised by the filter's own variance.

    Parameters
    ----------
    innovation : ndarray, shape (runs, N, m)
    variance : ndarray, shape (runs or 1, N, m)

    Returns
    -------
    ndarray, shape (LAGS+1, m)
        Lags 0..`LAGS`; the mean is taken as zero, as a consistent filter promises.
    ndarray of int, shape (LAGS+1,)
        Number of pooled products at each lag.
    """
    standard = innovation / np.sqrt(variance)
    kept = ~np.isnan(standard[0, :, 0])
    kept[:SETTLED] = False
    series = standard[:, kept]
    length = series.shape[1]
    power = np.mean(series**2, axis=(0, 1))
    lags = [np.mean(series[:, : length - lag] * series[:, lag:], axis=(0, 1)) / power for lag in range(LAGS + 1)]
    return np.array(lags), series.shape[0] * (length - np.arange(LAGS + 1))


def surviving(record: Record, ensemble: Ensemble, failed: np.ndarray) -> tuple[Record, np.ndarray]:
    """The record and the truth without the runs that failed."""
    if not failed.any():
        return record, ensemble.x
    kept = [array if len(array) == 1 < len(failed) else array[~failed] for array in record]
    return Record(*kept), ensemble.x[~failed]


def summaries(form: Filter, record: Record, truth: np.ndarray) -> dict[str, np.ndarray]:
    """The arrays of one branch and condition over the surviving runs, ``estimate0`` being the first of them.

    ``truth0``, ``estimate0``, ``sd0``, ``scale0`` ``(N+1, 8)``: truth, headline estimate (filtered, or delayed for
    the printed forms), the filter's own standard deviation and scale factors of one run; ``scale_quantiles``
    (`SCALE_QUANTILES`), ``error_quantiles`` (`QUANTILES`); ``rms_error`` and ``sd_mean`` over the runs; ``nis_mean``;
    ``innovation_autocorrelation`` ``(LAGS+1, 8)`` with its ``innovation_count`` ``(LAGS+1,)``; ``innovation_variance_ratio`` ``(8,)``,
    the mean of ``Delta_i^2 / S_ii``.
    """
    moment = form.filtered or form.delayed
    estimate = getattr(record, moment)
    variance = getattr(record, f"{moment}_variance")
    errors = estimate - truth
    scale = np.broadcast_to(1.0 / record.weights, estimate.shape)
    ratio = record.innovation[:, SETTLED:] ** 2 / record.innovation_variance[:, SETTLED:]
    correlation, count = autocorrelation(record.innovation, record.innovation_variance)
    return {
        "truth0": truth[0],
        "estimate0": estimate[0],
        "sd0": np.sqrt(variance[0]),
        "scale0": scale[0],
        "scale_quantiles": ensemble_quantiles(scale, SCALE_QUANTILES),
        "nis_mean": np.mean(record.nis, axis=0),
        "rms_error": ensemble_rms(errors),
        "sd_mean": np.sqrt(np.mean(variance, axis=0)),
        "error_quantiles": ensemble_quantiles(errors, QUANTILES),
        "innovation_autocorrelation": correlation,
        "innovation_count": count,
        "innovation_variance_ratio": np.nanmean(ratio, axis=(0, 1)),
    }


def without_fault(parameters: Parameters) -> Parameters:
    """What a filter that is told the fault may be told when there is none."""
    return replace(parameters, multiplier_q=1.0, multiplier_theta=1.0)


def variant(settings: Settings, composition: Mapping) -> Output:
    """One filter (a composition of `robins.papers.hajiyev2023.variants`) over the reporting runs, in both branches, with and
    without the fault.

    The table has a row for each branch, condition, run, estimate (filtered, delayed) and state: RMSE by equation
    (29), mean scale factor, gain norm and size of the gain's own element (K_ii) over k = 100..149, mean NIS settled
    (k >= 30) and in the window (k = 80..149), failure and its reason. The arrays are named ``branch.condition.what``; see `summaries`.
    """
    runs = range(settings.sizes["runs"])
    frames, arrays = [], {}
    for branch in BRANCHES:
        parameters = baseline(branch)
        matrices = system(parameters, settings.options["plant"])
        ensemble = simulate(parameters, matrices, draw(settings.seed, STREAM, runs, parameters.steps))
        for condition in CONDITIONS:
            form = build(composition, matrices, parameters if condition == "fault" else without_fault(parameters))
            record = run(form, parameters, matrices, ensemble, condition)
            frame = scores(form, record, ensemble, parameters, runs)
            frame.insert(0, "branch", branch)
            frame.insert(1, "condition", condition)
            frames.append(frame)
            survivors, truth = surviving(record, ensemble, frame["failed"].to_numpy()[: 8 * len(runs) : 8])
            arrays |= {f"{branch}.{condition}.{key}": value for key, value in summaries(form, survivors, truth).items()}
    return Output(pd.concat(frames, ignore_index=True), arrays)
