"""What the brief asks beyond the paper: theory checks, one-at-a-time sweeps and the specification curve."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pandas as pd

from robins.evaluate.intervals import Interval, Z
from robins.evaluate.metrics import window_rms
from robins.foundation.randomness import stream
from robins.kalman.differencing import differenced_measurements
from robins.navigation.aircraft import STATES
from robins.papers.hajiyev2023.as_printed import literal
from robins.papers.hajiyev2023.ensemble import STREAM, diverged, summaries
from robins.papers.hajiyev2023.estimators import Filter, augmented, corrected, printed, run
from robins.papers.hajiyev2023.scenario import (
    BRANCHES,
    KEY,
    Ensemble,
    Parameters,
    System,
    baseline,
    controls,
    differenced,
    draw,
    simulate,
    system,
)
from robins.papers.protocol import Output, Settings

ZERO = (0.0,) * 8
ADAPTED, PLAIN = "amdkf-printed/mdkf-printed", "aakf/akf"
AUGMENTED = "akf/mdkf-printed"
SPECIFICATION_PAIRS = {ADAPTED: ADAPTED, PLAIN: PLAIN, AUGMENTED: "akf delayed/mdkf-printed"}
"""Pairs and the results that they compare: the printed filter has no other estimate than a delayed one."""


def differenced_noise(parameters: Parameters, matrices: System, ensemble: Ensemble) -> np.ndarray:
    """xi(k) of equation (8) from simulated data, shape (runs, N, 8)."""
    d = differenced(matrices)
    mu = differenced_measurements(ensemble.z["healthy"], matrices.A_n)[:, :-1]
    return mu - controls(parameters)[:-1] @ d.D.T - ensemble.x[:, :-1] @ d.H_d.T  # (7) hajiyev2023 solved for xi


def lag_one(xi: np.ndarray) -> Interval:
    """Autocorrelation at lag one of each channel, pooled over the runs, with the mean taken as zero.

    A ratio of sums over runs, with the interval of its linearisation: the mean of the runs' own ratios is biased.

    Parameters
    ----------
    xi : ndarray, shape (runs, N, m)

    Returns
    -------
    Interval
        Estimate and ends of shape (m,).
    """
    runs, length = xi.shape[:2]
    power = np.mean(xi**2, axis=1)  # (9) hajiyev2023: the mean is zero
    product = np.sum(xi[:, 1:] * xi[:, :-1], axis=1) / (length - 1)
    value = np.sum(product, axis=0) / np.sum(power, axis=0)
    residual = (product - value * power) / np.mean(power, axis=0)
    half = Z * np.std(residual, axis=0, ddof=1) / np.sqrt(runs)
    return Interval(value, value - half, value + half, runs)


def theory(settings: Settings) -> Output:
    """Is xi white, is statement 1 true, and what does differencing lose? (Brief, section 1.3: E1-E3.)

    Table: branch, quantity, channel, value, theory, low, high, n; the lag-one autocorrelation of xi with its
    interval over runs. Arrays: ``<branch>.<filter>.no-v.<what>`` as in `robins.papers.hajiyev2023.ensemble` for
    mdkf-printed and bh without white noise (sigma_v = 0, no fault), and ``<branch>.information-loss`` ``(N+1, 8)``, the ratio
    of the standard deviations of bh and akf without white noise.
    """
    runs = range(settings.sizes["runs"])
    rows, arrays = [], {}
    for branch in BRANCHES:
        parameters = baseline(branch)
        matrices = system(parameters, settings.options["plant"])
        draws = draw(settings.seed, STREAM, runs, parameters.steps)
        d = differenced(matrices)
        expected = np.diag(-matrices.A_n @ matrices.Q_v) / np.diag(d.R_process + d.R_sensor)
        sampled = lag_one(differenced_noise(parameters, matrices, simulate(parameters, matrices, draws)))
        for i, state in enumerate(STATES):
            numbers = sampled.estimate[i], expected[i], sampled.low[i], sampled.high[i], len(runs)
            rows.append((branch, "lag-one autocorrelation of xi", state, *numbers))
        arrays |= without_white_noise(replace(parameters, sigma_v=ZERO), settings, draws)
    columns = ["branch", "quantity", "channel", "value", "theory", "low", "high", "n"]
    return Output(pd.DataFrame(rows, columns=columns), arrays)


def without_white_noise(parameters: Parameters, settings: Settings, draws) -> dict[str, np.ndarray]:
    """The arrays of `theory` for one branch, with sigma_v = 0 and no fault."""
    matrices = system(parameters, settings.options["plant"])
    ensemble = simulate(parameters, matrices, draws)
    forms = {"mdkf-printed": printed(matrices, parameters), "bh": corrected(matrices, parameters), "akf": augmented(matrices, parameters)}
    records = {name: run(form, parameters, matrices, ensemble, "healthy") for name, form in forms.items()}
    arrays = {}
    for name in ("mdkf-printed", "bh"):
        for what, values in summaries(forms[name], records[name], ensemble.x).items():
            arrays[f"{parameters.branch}.{name}.no-v.{what}"] = values
    loss = np.sqrt(records["bh"].prior_variance[0] / records["akf"].posterior_variance[0])
    return arrays | {f"{parameters.branch}.information-loss": loss}


def sweep_settings(base: Parameters) -> Iterator[tuple[str, str, float, Parameters]]:
    """Every one-at-a-time setting of the brief's section 3.3: sweep, label, value, parameters."""
    for window in (3, 5, 10, 15, 20, 30, 50):
        yield "window", str(window), window, replace(base, window=window)
    pairs = ((1, 1), (2, 1.25), (4, 2.5), (8, 5), (16, 10), (32, 20), (9, 6), (8, 1), (1, 5))
    for q, theta in pairs:
        yield "multiplier", f"{q:g}, {theta:g}", q, replace(base, multiplier_q=q, multiplier_theta=theta)
    for length in (10, 30, 70, 110):
        yield "duration", str(length), length, replace(base, fault_length=length)
    for tau in (2.0, 5.0, 20.0, 100.0, 500.0):
        yield "tau", f"{tau:g}", tau, replace(base, tau=tau)
    for dt in (0.01, 0.02, 0.05, 0.1, 0.2):
        yield "dt", f"{dt:g}", dt, replace(base, dt=dt)
    for name, factors in (("sigma_v", (0.1, 1.0, 3.0)), ("sigma_w", (0.1, 1 / 3, 1.0, 3.0))):
        for factor in factors:
            scaled = tuple(factor * sigma for sigma in getattr(base, name))
            yield name.replace("_", "-"), f"{factor:.3g}", factor, replace(base, **{name: scaled})
    yield "pitch-damping", "-0.4462", -0.4462, replace(base, pitch_damping=-0.4462)


def pair_errors(forms: dict[str, Filter], parameters: Parameters, matrices: System, ensemble: Ensemble) -> dict[str, tuple]:
    """RMSE ``(runs, 8)`` by equation (29) and failure ``(runs,)`` of each filter with the fault on.

    A filter on z has two estimates: the filtered one under its name, and the delayed one under ``<name> delayed``.
    """
    first, last = parameters.fault_start, parameters.fault_start + parameters.fault_length
    results = {}
    for name, form in forms.items():
        record = run(form, parameters, matrices, ensemble, "fault")
        estimates = {name: record.posterior} | ({f"{name} delayed": record.delayed} if form.delayed == "delayed" else {})
        for key, estimate in estimates.items():
            errors = estimate - ensemble.x
            rmse = window_rms(errors, first, last, parameters.fault_length)
            results[key] = (rmse, diverged(record, errors, rmse, parameters.divergence))
    return results


def pair_rows(results: dict, pair: str, runs: range) -> pd.DataFrame:
    """One row a run and state for a pair ``numerator/denominator`` of `pair_errors`."""
    numerator, denominator = (results[name] for name in pair.split("/"))
    return pd.DataFrame({
        "run": np.repeat(np.fromiter(runs, int), 8),
        "pair": pair,
        "state": np.tile(STATES, len(runs)),
        "numerator": numerator[0].ravel(),
        "denominator": denominator[0].ravel(),
        "failed": np.repeat(numerator[1] | denominator[1], 8),
    })  # fmt: skip


def standard_forms(matrices: System, parameters: Parameters) -> dict[str, Filter]:
    """The four filters of the pairs."""
    return {
        "mdkf-printed": printed(matrices, parameters),
        "amdkf-printed": printed(matrices, parameters, "per-channel"),
        "akf": augmented(matrices, parameters),
        "aakf": augmented(matrices, parameters, "per-channel"),
    }


def ablations(parameters: Parameters, matrices: System, ensemble: Ensemble) -> Iterator[tuple[str, dict]]:
    """Brief A10, A11, A12 and C = 0: label and results, under the names of the pair `ADAPTED`."""
    plain = printed(matrices, parameters)
    for label, form in (
        ("partial window", printed(matrices, parameters, "per-channel", minimum=1)),
        ("gated", printed(matrices, parameters, "gated")),
    ):
        yield label, pair_errors({"mdkf-printed": plain, "amdkf-printed": form}, parameters, matrices, ensemble)
    without = {
        "mdkf-printed": printed(matrices, parameters, cross=False),
        "amdkf-printed": printed(matrices, parameters, "per-channel", cross=False),
    }
    yield "C = 0", pair_errors(without, parameters, matrices, ensemble)
    results = pair_errors({"mdkf-printed": plain}, parameters, matrices, ensemble)
    estimate, _ = literal(parameters, matrices, ensemble, "fault", parameters.window, scale_covariance=False)
    errors = estimate - ensemble.x
    first, last = parameters.fault_start, parameters.fault_start + parameters.fault_length
    failed = ~np.all(np.abs(errors[:, 1:-1]) <= parameters.divergence, axis=(1, 2))
    results["amdkf-printed"] = (window_rms(errors, first, last, parameters.fault_length), failed)
    yield "covariance unscaled", results


def sweep(settings: Settings, branch: str) -> Output:
    """All sweeps of a branch with the fault on. Table: branch, sweep, setting, value, run, pair, state, numerator, denominator, failed.

    Numerator and denominator are RMSE by equation (29); the scoring window moves with the fault. Changing dt
    keeps the step numbers and the per-step sigma_w.
    """
    runs = range(settings.sizes["sweep_runs"])
    base = baseline(branch)
    draws = draw(settings.seed, STREAM, runs, base.steps)
    frames = []

    def add(sweep_name, label, value, results, pairs):
        for pair in pairs:
            frame = pair_rows(results, pair, runs)
            for position, (name, entry) in enumerate(
                (("branch", branch), ("sweep", sweep_name), ("setting", label), ("value", float(value)))
            ):
                frame.insert(position, name, entry)
            frames.append(frame)

    for name, label, value, parameters in sweep_settings(base):
        matrices = system(parameters, settings.options["plant"])
        ensemble = simulate(parameters, matrices, draws)
        add(name, label, value, pair_errors(standard_forms(matrices, parameters), parameters, matrices, ensemble), (ADAPTED, PLAIN))
    matrices = system(base, settings.options["plant"])
    ensemble = simulate(base, matrices, draws)
    for position, (label, results) in enumerate(ablations(base, matrices, ensemble)):
        add("ablation", label, position, results, (ADAPTED,))
    return Output(pd.concat(frames, ignore_index=True))


def specification_parameters(settings: Settings, branch: str, index: int) -> Parameters:
    """Random set `index` around a branch (brief, section 3.4); both branches draw the same multipliers."""
    generator = stream(settings.seed, f"{KEY}/specification-parameters/{index}/multipliers")
    base = baseline(branch)
    dt = 0.02 * 10.0 ** generator.uniform(0, 1)
    tau = 5.0 * 200.0 ** generator.uniform(0, 1)
    levels = {}
    for name, decades in (("sigma_w", 1.0), ("sigma_v", 1.0), ("sigma_lambda", 0.5), ("sigma_0", 0.5)):
        levels[name] = tuple(np.array(getattr(base, name)) * 10.0 ** generator.uniform(-decades, decades, 8))
    window = int(generator.choice((5, 10, 20, 30, 50)))
    return replace(base, dt=dt, tau=tau, window=window, **levels)


def specification(settings: Settings, branch: str) -> Output:
    """The specification curve of a branch: geometric mean ratios of many random parameter sets, with the fault on.

    Table: branch, set, dt, tau, window, pair, state, ratio, mean_log, n, failed (n runs survive, `failed` do not).
    `AUGMENTED` compares delayed with delayed.
    """
    count = settings.sizes["specification_runs"]
    frames = []
    for index in range(settings.sizes["specification_sets"]):
        parameters = specification_parameters(settings, branch, index)
        matrices = system(parameters, settings.options["plant"])
        runs = range(index * count, (index + 1) * count)
        ensemble = simulate(parameters, matrices, draw(settings.seed, "specification", runs, parameters.steps))
        results = pair_errors(standard_forms(matrices, parameters), parameters, matrices, ensemble)
        for pair, compared in SPECIFICATION_PAIRS.items():
            numerator, denominator = (results[name] for name in compared.split("/"))
            survived = ~(numerator[1] | denominator[1])
            with np.errstate(divide="ignore", invalid="ignore"):
                logs = np.log(numerator[0] / denominator[0])[survived]
            mean = logs.mean(axis=0) if survived.any() else np.full(8, np.nan)
            frames.append(pd.DataFrame({
                "branch": branch, "set": index, "dt": parameters.dt, "tau": parameters.tau, "window": parameters.window,
                "pair": pair, "state": STATES, "ratio": np.exp(mean), "mean_log": mean,
                "n": int(survived.sum()), "failed": int((~survived).sum()),
            }))  # fmt: skip
    return Output(pd.concat(frames, ignore_index=True))
