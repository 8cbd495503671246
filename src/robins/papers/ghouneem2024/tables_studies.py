"""Tables of the side studies: calibration, severity, initial azimuth, P0, sigma points, readings of (1), consistency, wrapping, theory."""

import numpy as np
import pandas as pd

from robins.papers.columns import LINEAR, counts, finite, keys, make, numbers, texts
from robins.papers.ghouneem2024.claims_settings import printed
from robins.papers.ghouneem2024.comparisons import mean_of, rows, variant, where
from robins.papers.ghouneem2024.filters import FILTERS, design, predictor
from robins.papers.ghouneem2024.table_parts import (
    COMPARED,
    COMPARED_TALLY,
    FILTER_WORDS,
    MEAN,
    PLAIN,
    RATIO,
    RUNS,
    SIDE_RUNS,
    average_cells,
    compared,
    framed,
    interval_names,
    labels_of,
    largest_difference,
    mean_cells,
    quantile_cells,
    settling_cells,
    tally,
)
from robins.papers.ghouneem2024.tables_factorial import everywhere
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.variants import BASELINES, NEW, VARIANTS
from robins.papers.protocol import Results, Table

UNIFORM = 180.0 / np.sqrt(3.0)
"""RMSE of an azimuth error that is uniform over the circle, deg."""
SHOWN_ABLATED = ("horizontal", "height", "azimuth", "v_up")
AZIMUTHS = (*FILTERS, NEW, "riss-only", "gps-only")
FILTERED = tuple(name for name in VARIANTS if name != "gps-only")
HONEST = {"nis": 6, "nees_position": 3, "nees_azimuth": 1}
"""Degrees of freedom of each normalised square: the mean of an honest filter."""


def published_horizontal(results: Results, place: str) -> float:
    """The paper's horizontal error of the EKF, m."""
    return float(np.hypot(*(printed(results, place, channel, "EKF") for channel in ("north", "east"))))


def calibration(results: Results) -> pd.DataFrame:
    """The frozen environment on the calibration runs, beside its target."""
    made = []
    for labels in labels_of(results.table("calibration"), ("trajectory", "filter")):
        at = where("calibration", **labels)
        aim = published_horizontal(results, labels["trajectory"])
        median = mean_of(results, at, "horizontal").median
        row = labels | {"target": aim} | quantile_cells(results, at, "horizontal") | {"median_over_target": finite(median / aim)}
        made.append(row | mean_cells(results, "mean", at, "horizontal") | tally(results, at))
    return framed(made)


def severity(results: Results) -> pd.DataFrame:
    """Horizontal error by severity, and the ratio to both readings of the EKF."""
    made = []
    for labels in labels_of(results.table("severity"), ("trajectory", "severity", "filter")):
        at = where("severity", **labels)
        row = labels | mean_cells(results, "mean", at, "horizontal")
        for name in BASELINES:
            row |= prefixed(compared(results, at, where("severity", **(labels | {"filter": name}))), f"over_{name.replace('-', '_')}")
        made.append(row | tally(results, at))
    return framed(made)


def prefixed(row: dict, name: str) -> dict:
    """The ratio of `compared` under another name, and the failed runs of its denominator."""
    ratio = {key.replace("ratio", name): row[key] for key in interval_names("ratio")}
    return ratio | {f"{name}_failed": row["over_failed"]}


OVER = tuple(f"over_{name.replace('-', '_')}" for name in BASELINES)


def initialisation(results: Results) -> pd.DataFrame:
    """Seconds until the azimuth has settled, by initial error."""
    made = []
    for labels in labels_of(results.table("initialisation"), ("trajectory", "azimuth_error", "prior", "filter", "alpha")):
        at = where("initialisation", **labels)
        made.append(
            labels | {"azimuth_error": float(np.degrees(labels["azimuth_error"]))} | settling_cells(results, at) | tally(results, at)
        )
    return framed(made)


def prior(results: Results) -> pd.DataFrame:
    """Error and convergence over a multiplier of P0."""
    made = []
    for labels in labels_of(results.table("prior"), ("trajectory", "prior_scale", "filter")):
        at, full = (where("prior", **found) for found in (labels, labels | {"prior_scale": 1.0}))
        row = labels | mean_cells(results, "mean", at, "horizontal") | compared(results, at, full)
        made.append(row | settling_cells(results, at))
    return framed(made)


def unscented(results: Results) -> pd.DataFrame:
    """Sigma points: spread, weight of the centre, drawn again or not."""
    options, made = results.settings.options, []
    for labels in labels_of(results.table("unscented"), ("trajectory", "alpha", "weights", "redrawn")):
        at = where("unscented", **labels)
        usual = where("unscented", **(labels | {"alpha": options["alpha"], "weights": "corrected", "redrawn": True}))
        points = predictor(design("ukf", options, alpha=labels["alpha"], printed_weights=labels["weights"] == "printed"))
        row = labels | {"redrawn": "redrawn" if labels["redrawn"] else "propagated", "centre": points.covariance_centre}
        row |= mean_cells(results, "mean", at, "horizontal") | compared(results, at, usual)
        made.append(row | {"largest": largest_difference(results, at, usual, ("horizontal",))})
    return framed(made)


def ablations(results: Results) -> pd.DataFrame:
    """Readings of the mechanisation, one at a time."""
    made = []
    for labels in labels_of(results.table("ablations"), ("trajectory", "ablation", "filter")):
        at, row = where("ablations", **labels), dict(labels)
        for measure in SHOWN_ABLATED:
            row |= mean_cells(results, measure, at, measure)
        kind = {"ukf": "New-Algorithm", "riss-only": ""}.get(labels["filter"], "EKF")
        row["published_v_up"] = printed(results, labels["trajectory"], "v_up", kind) if kind else ""
        made.append(row | tally(results, at))
    return framed(made)


def consistency(results: Results) -> pd.DataFrame:
    """Normalised squares of innovations and errors, beside those of an honest filter."""
    made = []
    for labels, at in everywhere(FILTERED):
        found, row = rows(results, at), dict(labels)
        for quantity, degrees in HONEST.items():
            absent = quantity == "nis" and labels["variant"] == "riss-only"  # no update, no innovation
            cells = average_cells(quantity, found[quantity])
            row |= dict.fromkeys(cells, "") if absent else cells
            row[f"honest_{quantity}"] = degrees
        made.append(row | tally(results, at))
    return framed(made)


def azimuths(results: Results) -> pd.DataFrame:
    """The azimuth's error with and without wrapping, beside what the published level may mean."""
    made = []
    for place in TRAJECTORIES:
        for name in AZIMUTHS:
            at, row = variant(name, place), {"trajectory": place, "filter": name}
            for column, measure in (("wrapped", "azimuth"), ("unwrapped", "azimuth_unwrapped")):
                row |= mean_cells(results, column, at, measure)
                row |= {f"{column}_{key}": value for key, value in quantile_cells(results, at, measure).items()}
            row |= dict.fromkeys(("published", "share_of_uniform", "share_of_turns"), "")
            if name in (*BASELINES, NEW):
                level = printed(results, place, "azimuth", "New-Algorithm" if name == NEW else "EKF")
                row |= {"published": level, "share_of_uniform": level / UNIFORM, "share_of_turns": (level / 360.0) ** 2}
            made.append(row | tally(results, at))
    return framed(made)


def theory(results: Results) -> pd.DataFrame:
    """Analytic values and moments: expected and found."""
    return results.table("theory")[["topic", "quantity", "unit", "expected", "value"]]


TALLY = counts("n", "failed")
COMPARED_COLUMNS = (numbers(*interval_names("mean"), unit="m"), numbers(*COMPARED))
SETTLED = numbers("settled", unit="s"), numbers(*interval_names("share"))
SETTLED_WORDS = (
    "settled: median time from the first motion until the azimuth error stays below 5 deg, failed where it never does in half of the runs; "
    "share: of the runs that settle at all, with Wilson's 95 % interval."
)  # fmt: skip
AZIMUTH_NUMBERS = tuple(
    name for column in ("wrapped", "unwrapped") for name in (*interval_names(column), f"{column}_median", f"{column}_q90")
)
FIRST_CALIBRATION = "Runs 0 to n - 1 of the configuration's seed on each trajectory."

STUDY_TABLES: tuple[Table, ...] = (
    make(
        "extra-calibration", "The environment beside its target", calibration,
        (
            keys("trajectory", "filter"), numbers("target", unit="m", relative=LINEAR), numbers("median", "q90", unit="m"),
            numbers("median_over_target"), numbers(*interval_names("mean"), unit="m"), TALLY,
        ),
        ("calibration",),
        "Horizontal error. target: the paper's EKF, from latitude and longitude. The environment was chosen by the median of ekf-pi on an "
        f"earlier generator and frozen (D1, D2); it is not tuned again. {PLAIN} {MEAN}. {FIRST_CALIBRATION}", "calibration_runs",
    ),
    make(
        "extra-severity", "Severity of the environment", severity,
        (
            keys("trajectory", "severity", "filter"), numbers(*interval_names("mean"), unit="m"), numbers(*interval_names(*OVER)), TALLY,
            counts(*(f"{name}_failed" for name in OVER)),
        ),
        ("severity",),
        "severity: multiplies the mean numbers of outages, bursts and misleading fixes. Horizontal error, and its ratio to both readings "
        f"of the EKF. {MEAN}. {RATIO} ukf-st-gate: T1-frozen. {FILTER_WORDS} {SIDE_RUNS}", "side_runs",
    ),
    make(
        "extra-initialisation", "Convergence from a wrong azimuth", initialisation,
        (keys("trajectory", "azimuth_error", "prior", "filter", "alpha"), *SETTLED, TALLY), ("initialisation",),
        f"azimuth_error: at the start, deg; prior: the 5 deg of the data sheet, or matched to a larger error. Clean fixes. {PLAIN} "
        f"{SETTLED_WORDS} {SIDE_RUNS}", "side_runs",
    ),
    make(
        "extra-prior", "Zero or small P0", prior,
        (keys("trajectory", "prior_scale", "filter"), *COMPARED_COLUMNS, *SETTLED, counts(*COMPARED_TALLY)), ("prior",),
        f"prior_scale: multiplies P0 of the data sheet. Clean fixes, first azimuth wrong by 30 deg. Horizontal error; ratio: to the "
        f"whole P0. {MEAN}. {RATIO} A zero P0 has no "
        f"Cholesky root, so a UKF fails at once. {SETTLED_WORDS} {SIDE_RUNS}", "side_runs",
    ),
    make(
        "extra-unscented", "Sigma points: spread, weights, redrawing", unscented,
        (
            keys("trajectory", "alpha", "weights", "redrawn"), numbers("centre", relative=LINEAR), *COMPARED_COLUMNS,
            texts("largest", kind="prose"), counts(*COMPARED_TALLY),
        ),
        ("unscented",),
        "UKF. centre: W0c; printed: the product of (18), corrected: the sum. redrawn: points drawn again for the update; propagated: those "
        f"of the prediction, as (25) has it. Horizontal error; ratio: to the configured alpha, corrected and redrawn; largest: relative "
        f"difference in a run (%). {PLAIN} {MEAN}. {RATIO} {SIDE_RUNS}", "side_runs",
    ),
    make(
        "extra-ablations", "Readings of the mechanisation, one at a time", ablations,
        (
            keys("trajectory", "ablation", "filter"), numbers(*interval_names("horizontal", "height"), unit="m"),
            numbers(*interval_names("azimuth"), unit="deg"), numbers(*interval_names("v_up"), unit="m/s"),
            numbers("published_v_up", kind="optional", unit="m/s", relative=LINEAR), TALLY,
        ),
        ("ablations",),
        "as run: pitch and roll of (1) with the sign mended (E4), dynamics kept (E5), odometer interpolated. tilt corrected: dynamics "
        "removed; tilt literal: the printed sign; azimuth literal: the printed sign of the gyro (E3); turn terms: those that (3) drops. "
        f"published_v_up: EKF or New, for ukf. {PLAIN} {MEAN}. {SIDE_RUNS}", "side_runs",
    ),
    make(
        "extra-consistency", "Are the filters' covariances honest?", consistency,
        (
            keys("trajectory", "variant", "frozen"), numbers(*interval_names("nis"), kind="optional"), counts("honest_nis"),
            numbers(*interval_names("nees_position")), counts("honest_nees_position"), numbers(*interval_names("nees_azimuth")),
            counts("honest_nees_azimuth"), TALLY,
        ),
        FILTERED,
        "nis: normalised innovation squared of the accepted fixes; nees: normalised estimation error squared, position and azimuth, once a "
        f"minute. Mean over a drive, then over the surviving runs with its 95 % interval (Student's t). honest: an honest filter's. {RUNS}",
    ),
    make(
        "extra-azimuth", "Azimuth with and without wrapping", azimuths,
        (
            keys("trajectory", "filter"), numbers(*AZIMUTH_NUMBERS, unit="deg"),
            numbers("published", kind="optional", unit="deg", relative=LINEAR),
            numbers("share_of_uniform", "share_of_turns", kind="optional", relative=LINEAR), TALLY,
        ),
        AZIMUTHS,
        "wrapped: error in [-180, 180) deg; unwrapped: both azimuths reduced to [0, 360) and the difference left as it is. "
        f"share_of_uniform: the published RMSE over the {UNIFORM:.2f} deg of a uniform error (Prop1); share_of_turns: fraction of "
        f"samples wrong by one turn that has the published RMSE (Prop2). {MEAN}. median, q90: over all runs. {FILTER_WORDS} {RUNS}",
    ),
    make(
        "extra-theory", "Analytic values and moments: expected and found", theory,
        (keys("topic", "quantity"), texts("unit"), numbers("expected", "value", relative=LINEAR)), ("theory",),
        "analytic: expected as the brief states it, value as computed here. moments: of the square and cube of a scalar of mean 1 and "
        "standard deviation 0.3; expected is exact. Nothing is random.", "",
    ),
)  # fmt: skip
"""Tables of the studies, in the order of the report."""
