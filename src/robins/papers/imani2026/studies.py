"""What the brief asks beyond the headline condition: outliers, kernel scale, sensor grades, rates (brief, sections 2.2, 2.3, 2.6).

All in F1 with the settings that were tuned under the headline condition and frozen, unless a row says that it was tuned again
under outliers; the kernel scale in F0 too, where the paper's problem is degenerate.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pandas as pd

from robins.kalman.gates import gate
from robins.kalman.m_estimators import correntropy
from robins.kalman.weights import weighting
from robins.papers.imani2026.ensemble import Case, frozen, headline, scores
from robins.papers.imani2026.methods import (
    LI,
    NORMAL_GATE,
    SWEPT,
    Method,
    increment,
    multi_kernel,
    tuned,
)
from robins.papers.imani2026.sensors import GRADES, LAWS, RATE_HZ, Outliers, Sensors
from robins.papers.imani2026.tune import RETUNED_RATE
from robins.papers.protocol import Output, Results, Settings

OUTLIER_RATES = (0.0, 0.01, 0.02, 0.05, 0.10)
KERNEL_SCALES = (0.01, 0.03, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0, np.inf)
SINGLE_WIDTHS = (0.05, 0.1, 0.3, 0.5, 1.0, 1.5, 3.0, 6.0, np.inf)
GATES = (0.03, 0.05, 0.1, 0.3, NORMAL_GATE)
NOISE_DECADES = (2, 3, 4, 5, 6, 7, 8)
SCORE_COLUMNS = ("filter", "run", "channel", "rmse", "mean", "drift", "failed", "reason")
TUNING_JOBS = tuple(f"tuning-{family}" for family in SWEPT)


def variant_name(family: str) -> str:
    """The variant that holds a family's tuned filter."""
    return "ekf-tuned" if family == "ekf" else family


def swept(settings: Settings, results: Results, condition: str = "headline") -> dict[str, Method]:
    """The filters of all sweeps at the settings tuned under `condition`, by variant."""
    return {variant_name(family): tuned(family, settings.options, frozen(results, family, condition)) for family in SWEPT}


def runs_at(settings: Settings, rate_hz: int) -> range:
    """The runs of a sweep: fewer above the headline's rate, where each costs more."""
    return range(settings.sizes["fast_runs" if rate_hz > RATE_HZ else "sweep_runs"])


def labelled(table: pd.DataFrame, **labels) -> pd.DataFrame:
    """`table` with constant columns in front."""
    return table.assign(**labels)[[*labels, *SCORE_COLUMNS]]


def outlier_cases() -> list[dict]:
    """Every combination of law, side and rate; without outliers there is no side to choose, and the impulsive law has none added."""
    cases = [{"law": law, "sided": "two-sided", "rate": 0.0} for law in ("nig-zero-mean", "nig-zero-mode", "mixture")]
    for law in ("nig-zero-mean", "nig-zero-mode"):
        cases += [{"law": law, "sided": sided, "rate": rate} for sided in ("two-sided", "one-sided") for rate in OUTLIER_RATES[1:]]
    return cases


def outliers(settings: Settings, results: Results) -> Output:
    """Errors by noise law, side and rate of the outliers: columns law, sided, rate, tuned and those of `scores`."""
    base, frames = headline(settings), []
    methods = {condition: swept(settings, results, condition) for condition in ("headline", "outliers")}
    for labels in outlier_cases():
        sensors = Sensors(gyroscope_law=LAWS[labels["law"]], outliers=Outliers(labels["rate"], labels["sided"] == "one-sided"))
        case = base._replace(sensors=sensors)
        retuned = labels == {"law": "nig-zero-mean", "sided": "two-sided", "rate": RETUNED_RATE}
        for condition in ("headline", "outliers") if retuned else ("headline",):
            table = scores(case, runs_at(settings, case.rate_hz), methods[condition])
            frames.append(labelled(table, **labels, tuned=condition))
    return Output(pd.concat(frames, ignore_index=True))


def scale_methods(options: Mapping, noise: Mapping[str, float], chi_square: Method) -> dict[tuple[str, float], Method]:
    """The whole range from no update to the EKF, by (method, scale).

    Parameters
    ----------
    options : mapping
        The paper's section of the configuration.
    noise : mapping of str to float
        Multiplier of R of the methods ``mk-norm``, ``mk-norm-gain``, ``single-kernel`` and ``gate``.
    chi_square : Method
        The CI-RKF that they are compared with.
    """
    methods = {("mk-norm", c): Method(multi_kernel(options, c), noise["mk-norm"]) for c in KERNEL_SCALES}
    methods |= {("mk-norm-gain", c): Method(multi_kernel(options, c, on_gain=True), noise["mk-norm-gain"]) for c in KERNEL_SCALES}
    methods |= {("single-kernel", width): Method(correntropy([width], [1.0]), noise["single-kernel"]) for width in SINGLE_WIDTHS}
    methods |= {("gate", threshold): Method(gate(threshold), noise["gate"]) for threshold in GATES}
    methods |= {("ekf-r", 10.0**k): Method(weighting("unit"), noise_scale=10.0**k) for k in NOISE_DECADES}
    methods[("no-update", 0.0)] = Method(weighting("unit"), updates=False)
    methods[("ci-seq", 1.0)] = chi_square
    return methods


SCALED = ("mk-norm", "mk-norm-gain", "single-kernel", "gate")
MAPPED = ("mk-norm", "mk-norm-gain", "ci-seq")


def scale(settings: Settings, results: Results) -> Output:
    """Errors over the kernel scale, with its controls: columns formulation, rate, method, scale and those of `scores`.

    F0 over the reporting runs without outliers, with R and the CI-RKF as they are conventionally; F1 over those of a sweep with R and
    the CI-RKF as tuned, for the kernels and the CI-RKF at every rate of outliers.
    """
    base, options = headline(settings), settings.options
    nominal = scale_methods(options, dict.fromkeys(SCALED, 1.0), Method(increment(options)))
    frames = [scaled(base, range(settings.sizes["runs"]), nominal, formulation="F0", rate=0.0)]
    noise = {family: frozen(results, family).noise_scale for family in SCALED}
    methods = scale_methods(options, noise, tuned("ci-seq", options, frozen(results, "ci-seq")))
    mapped = {key: method for key, method in methods.items() if key[0] in MAPPED}
    for rate in OUTLIER_RATES:
        case = base._replace(sensors=Sensors(outliers=Outliers(rate)))
        runs = runs_at(settings, case.rate_hz)
        frames.append(scaled(case, runs, methods if rate == 0.0 else mapped, formulation="F1", rate=rate))
    return Output(pd.concat(frames, ignore_index=True))


def scaled(case: Case, runs: range, methods: Mapping[tuple[str, float], Method], formulation: str, rate: float) -> pd.DataFrame:
    """`scores` of methods that are named by (method, scale)."""
    names = {str(i): key for i, key in enumerate(methods)}
    table = scores(case, runs, dict(zip(names, methods.values(), strict=True)), formulation)
    method, value = zip(*(names[i] for i in table["filter"]), strict=True)
    table = table.assign(formulation=formulation, rate=rate, method=method, scale=value)
    return table[["formulation", "rate", "method", "scale", "run", "channel", "rmse", "mean", "drift", "failed", "reason"]]


def grades(settings: Settings, results: Results) -> Output:
    """Errors by sensor grade: columns grade and those of `scores`."""
    base, methods = headline(settings), swept(settings, results)
    tables = [
        labelled(scores(base._replace(sensors=sensors), runs_at(settings, base.rate_hz), methods), grade=grade)
        for grade, sensors in GRADES.items()
    ]
    return Output(pd.concat(tables, ignore_index=True))


def rates(settings: Settings, results: Results) -> Output:
    """Errors by sampling rate, with the noise of a sample or its density kept: columns rate_hz, noise and those of `scores`."""
    base, methods, frames = headline(settings), swept(settings, results), []
    for rate_hz in settings.options["rates_hz"]:
        for noise in ("equal-sample", "equal-psd"):
            case = base._replace(rate_hz=rate_hz, sensors=replace(base.sensors, equal_psd=noise == "equal-psd"))
            frames.append(labelled(scores(case, runs_at(settings, rate_hz), methods), rate_hz=rate_hz, noise=noise))
    return Output(pd.concat(frames, ignore_index=True))


FULL_BETAS, FULL_LOWER, FULL_UPPER = (0.90, 0.95, 0.99), (0.5, 1.0, 1.5, 2.5), (2.0, 3.0, 6.0, np.inf)
FIXED_POINT_WIDTHS = (1.5, 3.0, 6.0)
KERNEL_NUMBERS = (1, 2, 3, 4, 5)
WIDTHS_OF_NUMBER = {1: (3.0,), 2: (1.5, 8.0), 3: (1.5, 3.0, 8.0), 4: (1.0, 2.0, 4.0, 8.0), 5: (1.0, 1.5, 3.0, 5.0, 8.0)}
"""Widths of kernels of equal weight, in innovation standard deviations (ours)."""


def grid_methods(settings: Settings) -> dict[tuple[str, str], Method]:
    """Thresholds and numbers of kernels by (method, setting). The ensemble `full` has every combination of beta, c0 and c1 and
    every shape; the others one at a time around the configured setting.
    """
    options = settings.options
    beta, low, high = (options[f"chi_square_{name}"] for name in ("probability", "lower", "upper"))
    triples = [(b, low, high) for b in FULL_BETAS] + [(beta, c, max(c, high)) for c in FULL_LOWER] + [(beta, low, c) for c in FULL_UPPER]
    if settings.ensemble == "full":
        triples += [(b, c0, c1) for b in FULL_BETAS for c0 in FULL_LOWER for c1 in FULL_UPPER if c0 <= c1]
    methods = {}
    for b, c0, c1 in dict.fromkeys(triples):
        for shape in ("linear", "root", "reject"):
            method = increment(options, shape=shape, probability=b, lower=c0, upper=c1)
            methods["chi-square", f"{shape}, beta {b:g}, c0 {c0:g}, c1 {c1:g}"] = Method(method)
    for number in KERNEL_NUMBERS:
        method = correntropy(WIDTHS_OF_NUMBER[number], np.full(number, 1.0 / number))
        methods["mk-norm-gain", f"{number} kernels"] = Method(method._replace(on_gain=True))
    if settings.ensemble == "full":
        methods |= fixed_point_methods()
    return methods


def fixed_point_methods() -> dict[tuple[str, str], Method]:
    """Li et al.'s iteration over the widths of measurement and prior, from the prior and from the least-squares solution."""
    methods = {}
    for width in FIXED_POINT_WIDTHS:
        for prior in (*FIXED_POINT_WIDTHS, np.inf):
            for warm in (False, True):
                iteration = LI._replace(warm=warm, prior=correntropy([prior], [1.0]).parameters)
                method = correntropy([width], [1.0])._replace(iteration=iteration)
                methods["mk-li", f"width {width:g}, prior {prior:g}, {'warm' if warm else 'cold'}"] = Method(method)
    return methods


def grids(settings: Settings) -> Output:
    """Thresholds and kernel numbers in F1: columns method, setting and those of `scores` but filter."""
    methods = grid_methods(settings)
    names = {str(i): key for i, key in enumerate(methods)}
    runs = range(settings.sizes["fast_runs"])
    table = scores(headline(settings), runs, dict(zip(names, methods.values(), strict=True)))
    method, setting = zip(*(names[i] for i in table["filter"]), strict=True)
    table = table.assign(method=method, setting=setting)
    return Output(table[["method", "setting", "run", "channel", "rmse", "mean", "drift", "failed", "reason"]])
