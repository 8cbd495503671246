"""Scenario and variants of the headline condition (sections 5 and 6 of the paper), and the loop that every study uses.

All filters of a run read the same samples. Only scores, quantiles and run 0 leave a job.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
import pandas as pd

from robins.kalman.filter import Record, run_filter
from robins.kalman.predict import Ekf
from robins.papers.imani2026 import drive as driving
from robins.papers.imani2026 import reference
from robins.papers.imani2026.drive import CHANNELS, DURATION, Drive
from robins.papers.imani2026.formulations import (
    FORMULATIONS,
    Formulation,
    controls,
    formulation,
    initial_states,
    readings,
)
from robins.papers.imani2026.methods import Method, Setting, nominal, tuned
from robins.papers.imani2026.scoring import (
    AVERAGED,
    Measures,
    errors,
    estimates,
    failures,
    measure_errors,
    nees,
    position_errors,
)
from robins.papers.imani2026.sensors import Measurements, Sensors, measure
from robins.papers.protocol import Output, Results, Settings

BATCH = 40_000
"""Run-epochs that are filtered at a time; their records stay below a hundred megabytes."""
MARK_SPACING = 30
"""Seconds between the epochs whose whole covariance is kept for NEES."""
QUANTILES = (0.05, 0.5, 0.95)


class Case(NamedTuple):
    """What is measured: the seed of the streams, the sensors' rate, the sensors, and whether the car comes back in reverse gear."""

    seed: int
    rate_hz: int
    sensors: Sensors
    reversing: bool = False

    @property
    def scenario(self) -> str:
        """Scenario part of the streams' names: another rate has another number of samples."""
        return f"drive-{self.rate_hz}hz"

    @property
    def driven(self) -> Drive:
        """The truth."""
        return driven(self.rate_hz, self.reversing)


driven = cache(driving.drive)
"""`robins.papers.imani2026.drive.drive`, once for each rate."""


def headline(settings: Settings) -> Case:
    """The headline condition: zero-mean normal-inverse-Gaussian gyro noise, no outliers."""
    return Case(settings.seed, settings.options["rate_hz"], Sensors())


FIRST_TUNING_RUN = 1000


def tuning_runs(settings: Settings) -> range:
    """The runs that settings are tuned on; no other result uses them."""
    return range(FIRST_TUNING_RUN, FIRST_TUNING_RUN + settings.sizes["tuning_runs"])


def batches(case: Case, runs: Sequence[int]) -> Iterator[tuple[Sequence[int], Measurements]]:
    """The samples of the runs, a batch of them at a time."""
    step = max(1, BATCH // (case.rate_hz * DURATION))
    for first in range(0, len(runs), step):
        batch = runs[first : first + step]
        yield batch, measure(case.seed, case.scenario, batch, case.driven, case.sensors)


def run(form: Formulation, method: Method, case: Case, measured: Measurements, marks: Iterable[int] = ()) -> Record:
    """Filter a batch."""
    z = readings(form.name, measured)
    valid = np.full(z.shape[1], method.updates)
    valid[0] = False
    x0 = initial_states(form.name, case.driven, measured)
    return run_filter(
        Ekf(), form.model, form.sensor, method.weighting, x0, form.P0, controls(form.name, measured), z, valid, x0.shape[1], False, marks
    )


def build(name: str, method: Method, case: Case, **more) -> Formulation:
    """The formulation `name` as the method wants it."""
    return formulation(name, case.rate_hz, case.sensors, method.noise_scale, method.process_scale, **more)


def frozen(results: Results, family: str, condition: str = "headline") -> Setting:
    """The setting that a family's tuning job chose under a condition."""
    table = results.table(f"tuning-{family}")
    chosen = table[(table["condition"] == condition) & table["chosen"]].iloc[0]
    return Setting(float(chosen["noise_scale"]), float(chosen["value"]))


def method_of(composition: Mapping, settings: Settings, results: Results | None, case: Case, condition: str = "headline") -> Method:
    """The method of a row of the registry; `results` hold the tuning jobs of a tuned one."""
    if "tuned" not in composition:
        return nominal(composition, settings.options, case.sensors, case.rate_hz)
    family = composition["tuned"]
    method = tuned(family, settings.options, frozen(results, family, condition))
    if composition.get("start") == "warm":
        iteration = method.weighting.iteration._replace(warm=True)
        method = method._replace(weighting=method.weighting._replace(iteration=iteration))
    return method


def scores(case: Case, runs: Sequence[int], methods: Mapping[str, Method], name: str = "F1", **more) -> pd.DataFrame:
    """Errors against the truth of several filters on the same samples: a row for each filter, run and channel.

    `more` goes to `robins.papers.imani2026.formulations.formulation`.

    Columns filter, run, channel, rmse, mean, drift (SI; NaN where the run failed), failed, reason.
    """
    truth, dt = driving.truth(case.driven), 1.0 / case.rate_hz
    forms = {key: build(name, method, case, **more) for key, method in methods.items()}
    frames = []
    for batch, measured in batches(case, runs):
        for key, method in methods.items():
            record = run(forms[key], method, case, measured)
            error = errors(estimates(forms[key], record, measured), truth)
            frames.append(frame(measure_errors(error, dt), failures(record, error), batch, CHANNELS).assign(filter=key))
    table = pd.concat(frames, ignore_index=True)
    return table[["filter", "run", "channel", "rmse", "mean", "drift", "failed", "reason"]]


def frame(measures: Measures, reasons: np.ndarray, runs: Sequence[int], channels: Sequence[str]) -> pd.DataFrame:
    """One row for each run and channel; a failed run has no numbers."""
    failed = reasons != ""
    columns = {key: np.where(failed[:, None], np.nan, values).ravel() for key, values in measures._asdict().items()}
    return pd.DataFrame({
        "run": np.repeat(np.fromiter(runs, int), len(channels)),
        "channel": np.tile(channels, len(runs)),
        **columns,
        "failed": np.repeat(failed, len(channels)),
        "reason": np.repeat(reasons, len(channels)),
    })  # fmt: skip


def scenario(settings: Settings) -> Output:
    """Truth, reference and sensor noise of run 0, and the sensors' parameters (Table 4)."""
    case = headline(settings)
    truth = case.driven
    seen = reference.observe(case.seed, case.scenario, 0, truth)
    measured = measure(case.seed, case.scenario, range(1), truth, case.sensors)
    at_points = [int(round(time * case.rate_hz)) for time in driving.WAY_POINT_TIMES]
    arrays = {
        "time": truth.time,
        "truth": driving.truth(truth),
        "truth_interval": driving.truth_interval(truth),
        "position": truth.position,
        "speed": np.linalg.norm(truth.velocity_n, axis=1),
        "reference": seen.channels,
        "reference_position": seen.position,
        "way_points": truth.position[at_points],
        "way_point_times": np.array(driving.WAY_POINT_TIMES, float),
    }
    for name, columns in (("accelerometer", slice(0, 3)), ("gyroscope", slice(3, 6))):
        arrays |= {f"residual.{name}": measured.noise[0][:, columns], f"rate_hz.{name}": np.array(float(case.rate_hz))}
    return Output(parameters(case), arrays)


def parameters(case: Case) -> pd.DataFrame:
    """Table 4: every parameter of the simulated sensors, SI, with its source."""
    s = case.sensors
    rows = [
        ("sampling rate", "1/dt", case.rate_hz, "Hz", "paper: 1 to 10 Hz"),
        ("accelerometer noise, sd of a sample", "sigma_a", s.accelerometer_noise, "m/s^2", "ours"),
        ("gyroscope noise, sd of a sample", "sigma_g", s.gyroscope_noise, "rad/s", "ours"),
        ("gyroscope noise, skewness", "gamma_1", s.gyroscope_law.skewness, "1", "paper"),
        ("gyroscope noise, excess kurtosis", "gamma_2", s.gyroscope_law.excess_kurtosis, "1", "paper"),
        ("accelerometer noise, skewness", "gamma_1", s.accelerometer_law.skewness, "1", "ours"),
        ("accelerometer noise, excess kurtosis", "gamma_2", s.accelerometer_law.excess_kurtosis, "1", "ours"),
        ("accelerometer bias, sd over runs", "sigma_ba", s.accelerometer_bias, "m/s^2", "ours"),
        ("gyroscope bias, sd over runs", "sigma_bg", s.gyroscope_bias, "rad/s", "ours"),
        ("initial tilt error, sd", "sigma_tilt", s.tilt_error, "rad", "ours"),
        ("initial yaw error, sd", "sigma_yaw", s.yaw_error, "rad", "ours"),
        ("classical accelerometer noise, sd (F2)", "sigma_a", s.classical_accelerometer_noise, "m/s^2", "ours"),
        ("classical gyroscope noise, sd (F2)", "sigma_g", s.classical_gyroscope_noise, "rad/s", "ours"),
        ("classical accelerometer bias, sd (F2)", "sigma_ba", s.classical_accelerometer_bias, "m/s^2", "ours"),
        ("classical gyroscope bias, sd (F2)", "sigma_bg", s.classical_gyroscope_bias, "rad/s", "ours"),
        ("latitude", "phi", driving.LATITUDE, "rad", "ours: Tabriz"),
        ("gravity", "g", driving.GRAVITY, "m/s^2", "ours"),
    ]
    return pd.DataFrame(rows, columns=["parameter", "symbol", "value", "unit", "source"]).astype({"value": float})


def variant(settings: Settings, results: Results | None = None, *, composition: Mapping) -> Output:
    """One filter over the reporting runs, in all three formulations; the table and the arrays are described in `gather`."""
    case = headline(settings)
    method = method_of(composition, settings, results, case)
    frames, arrays = [], {}
    for name in FORMULATIONS:
        form = build(name, method, case)
        table, found = gather(form, method, case, range(settings.sizes["runs"]))
        table.insert(0, "formulation", name)
        frames.append(table)
        arrays |= {f"{name}.{key}": values for key, values in found.items()}
    return Output(pd.concat(frames, ignore_index=True), arrays)


def gather(form: Formulation, method: Method, case: Case, runs: Sequence[int]) -> tuple[pd.DataFrame, dict[str, np.ndarray]]:
    """Scores and arrays of one formulation.

    Returns
    -------
    DataFrame
        A row for each run, `against` (``truth``, ``interval`` for acceleration and rate, ``reference``) and channel, with the
        fields of `robins.papers.imani2026.scoring.Measures`, failed and reason.
    dict of str to ndarray
        ``estimate0`` (N+1, 12) of run 0; ``error_quantiles`` (3, E, 12) over the surviving runs at the plotting epochs (one a
        second; NaN where none survives); ``nis`` (runs,), ``nis_mean`` (E,); ``nees_attitude``, ``nees_bias`` (runs, M) at the
        epochs ``marks`` (M,); ``position_rms``, ``position_final`` (runs, 3); ``share_reduced`` (runs, 6), the share of updates
        with a weight below one; ``failed`` (runs,).
    """
    truth, averaged = driving.truth(case.driven), driving.truth_interval(case.driven)
    marks = np.arange(MARK_SPACING, DURATION + 1, MARK_SPACING) * case.rate_hz
    plotted = np.arange(0, DURATION + 1) * case.rate_hz
    frames, parts, estimate0 = [], [], None
    for batch, measured in batches(case, runs):
        record = run(form, method, case, measured, marks)
        estimate = estimates(form, record, measured)
        if estimate0 is None:
            estimate0 = estimate[0].copy()
        error = errors(estimate, truth)
        reasons = failures(record, error)
        seen = np.stack([reference.observe(case.seed, case.scenario, number, case.driven).channels for number in batch])
        dt = 1.0 / case.rate_hz
        compared = {
            "truth": (measure_errors(error, dt), CHANNELS),
            "interval": (measure_errors(errors(estimate, averaged)[..., AVERAGED], dt), CHANNELS[AVERAGED]),
            "reference": (measure_errors(errors(estimate, seen), dt), CHANNELS),
        }
        frames += [frame(found, reasons, batch, names).assign(against=key) for key, (found, names) in compared.items()]
        parts.append(details(form, record, measured, case, marks, plotted, error, reasons))
    arrays = {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}
    survived = ~arrays["failed"]
    arrays["error_quantiles"] = quantiles(arrays.pop("plotted_error")[survived])
    arrays["nis_mean"] = epoch_means(arrays.pop("plotted_nis")[survived])
    table = pd.concat(frames, ignore_index=True)
    columns = ["run", "against", "channel", *Measures._fields, "failed", "reason"]
    return table[columns], arrays | {"estimate0": estimate0, "marks": marks}


def details(form, record, measured, case, marks, plotted, error, reasons) -> dict[str, np.ndarray]:
    """The arrays of one batch, runs first; see `gather`."""
    truth = case.driven
    updates = np.sum(~np.isnan(record.nis), axis=1)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        found = {
            "plotted_error": np.concatenate([np.full((len(error), 1, error.shape[2]), np.nan), error], axis=1)[:, plotted],
            "plotted_nis": record.nis[:, plotted],
            "nis": np.nansum(record.nis, axis=1) / updates,
            "share_reduced": np.sum(record.weights < 1.0, axis=1) / updates[:, None],
            **position_errors(record, truth.position),
        }
    return found | nees(form, record, measured, truth.quaternion, marks) | {"failed": reasons != ""}


def quantiles(error: np.ndarray) -> np.ndarray:
    """`QUANTILES` over the runs ``(runs, E, 12)``; NaN at epoch 0, which has no error, and where no run survives."""
    out = np.full((len(QUANTILES), *error.shape[1:]), np.nan)
    if len(error):
        out[:, 1:] = np.quantile(error[:, 1:], QUANTILES, axis=0)
    return out


def epoch_means(values: np.ndarray) -> np.ndarray:
    """Mean over the runs ``(runs, E)`` where there are values, else NaN."""
    count = np.sum(~np.isnan(values), axis=0)
    return np.where(count > 0, np.nansum(values, axis=0) / np.maximum(count, 1), np.nan)
