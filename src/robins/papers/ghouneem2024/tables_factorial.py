"""Tables of the reporting runs: the factorial, every channel, controls, ratios, and what the gain is made of."""

from collections.abc import Collection

import numpy as np
import pandas as pd

from robins.papers.columns import LINEAR, counts, ends, finite, keys, make, numbers, texts
from robins.papers.ghouneem2024.claims_settings import frozen_setting, in_sample_setting, printed_ratio
from robins.papers.ghouneem2024.comparisons import Where, anova_shares, attribution, ratio_of, rows, variant
from robins.papers.ghouneem2024.judging import NAMES
from robins.papers.ghouneem2024.runs import CHANNELS
from robins.papers.ghouneem2024.table_parts import (
    COMPARED,
    COMPARED_TALLY,
    FILTER_WORDS,
    MEAN,
    PLAIN,
    RATIO,
    RUNS,
    SHORT,
    compared,
    framed,
    gate_cells,
    interval_names,
    largest_difference,
    mean_cells,
    quantile_cells,
    ratio_cells,
    tally,
    unit_of,
)
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.variants import BASELINES, CELL_WORDS, CONTROL, FACTORIAL, NEW, VARIANTS, variant_name
from robins.papers.protocol import Results, Table

CONTROLS = (CONTROL, *(name for name in VARIANTS if name not in FACTORIAL))
"""What the paper's method is held against beside its own EKF."""
MEASURES = (*CHANNELS, "horizontal")
SHARE_DIGITS = 4
"""Decimals of a share: what is small against all others regenerates no closer."""
FILTER_STEPS = (*((CONTROL, name) for name in BASELINES), ("ukf", CONTROL))
"""The change of the filter in two steps: to the UKF's model, and to the unscented transform."""


def frozen_choices(name: str) -> tuple[str, ...]:
    """Whose settings a variant is run with: those of either trajectory, or nobody's."""
    return TRAJECTORIES if VARIANTS[name].composition.get("cell", "none") != "none" else ("none",)


def everywhere(names: Collection[str]) -> list[tuple[dict, Where]]:
    """Labels and rows of variants on both trajectories with all settings that they have."""
    return [
        ({"trajectory": place, "variant": name, "frozen": frozen}, variant(name, place, frozen))
        for place in TRAJECTORIES for name in names for frozen in frozen_choices(name)
    ]  # fmt: skip


def factorial(results: Results) -> pd.DataFrame:
    """Horizontal error, NIS and rejections in all cells of the factorial."""
    made = []
    for labels, at in everywhere(FACTORIAL):
        made.append(
            labels | mean_cells(results, "mean", at, "horizontal") | quantile_cells(results, at, "horizontal")
            | {"nis": finite(rows(results, at)["nis"].mean())} | gate_cells(results, at) | tally(results, at)
        )  # fmt: skip
    return framed(made)


def channels(results: Results) -> pd.DataFrame:
    """Every channel of every variant."""
    made = []
    for labels, at in everywhere(VARIANTS):
        for channel in CHANNELS:
            made.append(
                labels | {"channel": NAMES[channel], "unit": unit_of(channel)} | mean_cells(results, "mean", at, channel)
                | quantile_cells(results, at, channel) | tally(results, at)
            )  # fmt: skip
    return framed(made)


def ratios(results: Results) -> pd.DataFrame:
    """The paper's method over each EKF in every channel, out of sample and in sample."""
    made = []
    for place in TRAJECTORIES:
        for setting in (*(frozen_setting(place, frozen) for frozen in TRAJECTORIES), in_sample_setting(place)):
            for name in (*BASELINES, CONTROL):
                for measure in MEASURES:
                    made.append(
                        {"trajectory": place, "settings": setting.words, "over": name, "channel": NAMES[measure]}
                        | {"published": printed_ratio(results, place, measure)}
                        | compared(results, setting.new, setting.baseline(name), measure)
                    )
    return framed(made)


def controls(results: Results) -> pd.DataFrame:
    """Filters that the paper has not, and its method over each of them."""
    made = []
    for place in TRAJECTORIES:
        for name in CONTROLS:
            at = variant(name, place)
            for measure in SHORT:
                row = {"trajectory": place, "control": name, "measure": NAMES[measure], "unit": unit_of(measure)}
                row |= mean_cells(results, "mean", at, measure) | quantile_cells(results, at, measure)
                for frozen in TRAJECTORIES:
                    row |= ratio_cells(ratio_of(results, variant(NEW, place, frozen), at, measure), f"new_{frozen}")
                lost = {f"new_{frozen}_failed": tally(results, variant(NEW, place, frozen))["failed"] for frozen in TRAJECTORIES}
                made.append(row | gate_cells(results, at) | tally(results, at) | lost)
    return framed(made)


def attributions(results: Results) -> pd.DataFrame:
    """Shapley values of the three parts and their sum."""
    made = []
    for place, frozen, baseline, measure in designs(("horizontal", "height")):
        found = attribution(results, baseline, place, frozen, measure)
        for part, change in (found.parts | {"all": found.total}).items():
            made.append(
                {"trajectory": place, "frozen": frozen, "from": baseline, "measure": NAMES[measure], "part": part}
                | {"factor": finite(np.exp(change.estimate))} | ends("factor", np.exp(change.low), np.exp(change.high))
                | {"n": change.n, "failed": found.failed}
            )  # fmt: skip
    return framed(made)


def designs(measures: tuple[str, ...]) -> list[tuple[str, str, str, str]]:
    """Trajectory, settings, baseline and measure of every attribution."""
    return [
        (place, frozen, baseline, measure)
        for place in TRAJECTORIES for frozen in TRAJECTORIES for baseline in BASELINES for measure in measures
    ]  # fmt: skip


def shares(results: Results) -> pd.DataFrame:
    """Shares of the sum of squares in the factorial."""
    made = []
    for place, frozen, baseline, measure in designs(("horizontal",)):
        found, whole = anova_shares(results, baseline, place, frozen, measure), attribution(results, baseline, place, frozen, measure)
        labels = {"trajectory": place, "frozen": frozen, "from": baseline}
        for source, share in (found or {"none": np.nan}).items():
            made.append(labels | {"source": source, "share": finite(np.round(share, SHARE_DIGITS))})
            made[-1] |= {"n": whole.total.n, "failed": whole.failed}
    return framed(made)


def filter_split(results: Results) -> pd.DataFrame:
    """The change of the filter in two steps, in every cell."""
    made = []
    for place in TRAJECTORIES:
        for cell in CELL_WORDS:
            for to, since in FILTER_STEPS:
                above, below = (variant(variant_name(name, cell), place) for name in (to, since))
                row = {"trajectory": place, "cell": cell, "filter": to, "over": since} | compared(results, above, below)
                row["largest_horizontal"] = largest_difference(results, above, below, ("horizontal",))
                row["largest_channel"] = largest_difference(results, above, below, CHANNELS)
                made.append(row)
    return framed(made)


WHERE = ("trajectory", "variant", "frozen")
TALLY = counts("n", "failed")

FACTORIAL_TABLES: tuple[Table, ...] = (
    make(
        "extra-factorial", "Filter, self-tuning, gate: horizontal error in all cells", factorial,
        (keys(*WHERE), numbers(*interval_names("mean"), "median", "q90", unit="m"), numbers("nis", "rejected", "longest_rejection"), TALLY),
        FACTORIAL,
        f"frozen: whose tuning runs gave the settings. {MEAN}. median, q90: over all runs, a failed run being infinite. nis: of the "
        "accepted fixes, mean over runs; an honest filter has 6. rejected: share of the fixes; longest_rejection: consecutive fixes, in "
        f"the worst run. {FILTER_WORDS} {RUNS}",
    ),
    make(
        "extra-channels", "Every channel of every filter", channels,
        (keys(*WHERE, "channel"), texts("unit"), numbers(*interval_names("mean"), "median", "q90"), TALLY), VARIANTS,
        f"RMSE over the whole drive at 20 Hz, azimuth wrapped. {MEAN}. median, q90: over all runs, a failed run being infinite. {RUNS}",
    ),
    make(
        "extra-ratios", "The paper's method over each EKF", ratios,
        (
            keys("trajectory", "settings", "over", "channel"), numbers("published", relative=LINEAR), numbers(*COMPARED),
            counts(*COMPARED_TALLY),
        ),
        (NEW, *BASELINES, CONTROL, "in-sample"),
        "settings: of ukf-st-gate, frozen on either trajectory's tuning runs, or chosen with the evaluated run's own truth. over: "
        f"{PLAIN} published: New over EKF, horizontal from latitude and longitude. {RATIO} better: share of the runs that the method wins. "
        f"{FILTER_WORDS} {RUNS}",
    ),
    make(
        "extra-controls", "Filters that the paper has not", controls,
        (
            keys("trajectory", "control", "measure"), texts("unit"), numbers(*interval_names("mean"), "median", "q90"),
            numbers(*interval_names(*(f"new_{frozen}" for frozen in TRAJECTORIES)), "rejected", "longest_rejection"),
            counts("n", "failed", *(f"new_{frozen}_failed" for frozen in TRAJECTORIES)),
        ),
        (NEW, *CONTROLS),
        "Physical Q set once, a priori; NIS gate at the 99.9 % quantile, with recovery after more than ten rejections in a row, R as "
        f"reported or four times that. {MEAN}. new_t1, new_t2: error of ukf-st-gate, T1- and T2-frozen, over that of the control. {RATIO} "
        f"{RUNS}",
    ),
    make(
        "extra-attribution", "What the gain is made of", attributions,
        (
            keys("trajectory", "frozen", "from", "measure", "part"), numbers(*interval_names("factor")), TALLY,
        ),
        FACTORIAL,
        "Shapley values of the log error from an EKF (data sheet's variances, no gate) to ukf-st-gate, as factors: below one where a part "
        "makes the error smaller; those of the parts multiply to that of all. 95 % interval over the runs (as in extra-factorial). A run "
        f"that failed in any cell is left out of all. The filter's share is split in extra-filter-split. {RUNS}",
    ),
    make(
        "extra-anova", "Sum of squares in the factorial", shares,
        (keys("trajectory", "frozen", "from", "source"), numbers("share"), TALLY), FACTORIAL,
        "ANOVA of the log horizontal error over filter (the EKF named, UKF), self-tuning, gate and their interactions, with the runs as "
        f"blocks: shares of the total. A run that failed in any cell is left out; failed where fewer than two are left. {RUNS}",
    ),
    make(
        "extra-filter-split", "The filter: change of model and unscented transform", filter_split,
        (
            keys("trajectory", "cell", "filter", "over"), numbers(*COMPARED), texts("largest_horizontal", "largest_channel", kind="prose"),
            counts(*COMPARED_TALLY),
        ),
        FACTORIAL,
        "ekf-f over ekf-pi or ekf-pm: change of model; ukf over ekf-f: unscented transform. Horizontal error, T1-frozen; each filter has "
        "the settings that its own tuning chose, so cells other than none may differ by these. largest: relative difference in a run, "
        f"horizontal or of any channel (%). {RATIO} better: share of the runs that filter wins. {RUNS}",
    ),
)  # fmt: skip
"""Tables of the reporting runs, in the order of the report."""
