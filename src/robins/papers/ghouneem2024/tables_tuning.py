"""Tables of tuning: its budget, every setting, the statistics of (12) and (13), their literal levels, and what leakage is worth."""

import numpy as np
import pandas as pd

from robins.papers.columns import counts, finite, keys, make, numbers, texts
from robins.papers.ghouneem2024.comparisons import Where, rows, variant, where
from robins.papers.ghouneem2024.filters import FILTERS
from robins.papers.ghouneem2024.in_sample import COMPARED as IN_SAMPLE
from robins.papers.ghouneem2024.judging import NAMES
from robins.papers.ghouneem2024.self_tuning import REFERENCED, SCALES, printed_variances, radii
from robins.papers.ghouneem2024.table_parts import (
    COMPARED,
    COMPARED_TALLY,
    MEAN,
    RATIO,
    RUNS,
    SIDE_RUNS,
    TUNING_RUNS,
    compared,
    framed,
    interval_names,
    labels_of,
    mean_cells,
    multiple_words,
    quantile_cells,
    shown,
)
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.tune import CELLS, MULTIPLES, Setting, frozen_setting, job_name, learned_from
from robins.papers.ghouneem2024.variants import FACTORIAL, variant_name
from robins.papers.protocol import Results, Table

STATES = ("latitude", "longitude", "altitude", "east velocity", "north velocity", "up velocity", "azimuth")
"""The states that a reference has, in the filters' order."""
STATE_UNITS = ("m", "m", "m", "m/s", "m/s", "m/s", "deg")
DIVERGED = 30.0
CHAOTIC = ("st-printed", "st-ms")
CHAOTIC_SCALE = 1e-2
"""Levels, and scales from which on, a UKF's azimuth variance passes a radian: rounding then decides its errors, and another processor
has others. Whether they diverge is said, no number is."""
LEAKED = ("horizontal", "height")


def edges(setting: Setting, cell: str) -> str:
    """Which knobs of a cell stand at the edge of their grid; without a gate the multiple is none."""
    knobs = {"scale": (setting.scale, SCALES)} | ({} if cell == "st" else {"multiple": (setting.multiple, MULTIPLES)})
    return ", ".join(name for name, (value, grid) in knobs.items() if value in (min(grid), max(grid)))


def scale_words(scale: float) -> str:
    """The scale of self-tuned Q as text: with the data sheet's Q there is none."""
    return f"{scale:g}" if np.isfinite(scale) else "data sheet"


def budgets(results: Results) -> pd.DataFrame:
    """How many settings each cell was given, and what it chose."""
    made = []
    for name in FILTERS:
        table = results.table(job_name(name))
        for place in TRAJECTORIES:
            for cell in CELLS:
                own = table[(table["trajectory"] == place) & (table["cell"] == cell)]
                setting, best = frozen_setting(results, name, place, cell), own[own["chosen"]].iloc[0]
                made.append({
                    "filter": name, "trajectory": place, "cell": cell, "settings": len(own), "scale": scale_words(setting.scale),
                    "multiple": multiple_words(setting.multiple), "at_edge": edges(setting, cell), "objective": finite(best["objective"]),
                    "n": results.settings.sizes["tuning_runs"], "failed": int(best["failed"]),
                })  # fmt: skip
    return framed(made)


def tuning(results: Results) -> pd.DataFrame:
    """Every evaluated setting once, and the cells that chose it."""
    made = []
    for name in FILTERS:
        for place in TRAJECTORIES:
            table = results.table(job_name(name))
            table = table[table["trajectory"] == place]
            chosen = table[table["chosen"]]
            for found in table[table["cell"] != "st"].itertuples(index=False):  # the cell st is a part of st-gate
                if name == "ukf" and found.scale >= CHAOTIC_SCALE:
                    continue
                words = {"scale": scale_words(found.scale), "multiple": multiple_words(found.multiple)}
                by = [
                    each.cell for each in chosen.itertuples(index=False)
                    if (scale_words(each.scale), multiple_words(each.multiple)) == tuple(words.values())
                ]  # fmt: skip
                made.append({
                    "filter": name, "trajectory": place, **words,
                    "objective": finite(found.objective),
                    "chosen_by": ", ".join(by),
                    "n": results.settings.sizes["tuning_runs"], "failed": int(found.failed),
                })  # fmt: skip
    return framed(made)


def statistic_rows(results: Results, name: str, place: str, source: str) -> list[dict]:
    """Means of a filter's or the mechanisation's errors over the tuning runs of a trajectory, state by state."""
    arrays, pooled = results.arrays(job_name(name)), getattr(learned_from(results, name, place), source)
    by_run = arrays[f"{place}.{source}.mean"]
    taken = np.sqrt(printed_variances(pooled.mean, place))
    per_radian = dict(zip(STATES, (*radii(place), np.nan, np.nan, np.nan, np.nan, 1.0), strict=True))
    made = []
    for i, (state, unit) in enumerate(zip(STATES, STATE_UNITS, strict=True)):
        radians = pooled.mean[i] / per_radian[state]
        square, change = (np.sqrt(values[i]) for values in (pooled.mean_square, pooled.increment))
        cells = {"rms": square, "increment": change, "taken": taken[i]}
        made.append(
            {"state": state, "unit": unit, "mean": finite(shown(pooled.mean[i], unit))}
            | {"mean_rad": "" if np.isnan(per_radian[state]) else finite(radians), "negative": "negative" if pooled.mean[i] < 0 else ""}
            | {key: finite(shown(value, unit)) for key, value in cells.items()}
            | {"negative_runs": int((by_run[:, i] < 0).sum()), "negatives": int((pooled.mean < 0).sum()), "n": len(by_run)}
        )  # fmt: skip
    return made


def self_tuning(results: Results) -> pd.DataFrame:
    """What (12) and (13) give: signed means, and what they would be as variances."""
    made = []
    for place in TRAJECTORIES:
        sources = [("RISS only", "(12)", FILTERS[0], "mechanisation"), *((name, "(13)", name, "filtered") for name in FILTERS)]
        for words, equation, name, source in sources:
            labels = {"trajectory": place, "of": words, "equation": equation}
            made += [labels | row for row in statistic_rows(results, name, place, source)]
    return framed(made)


def diverged(results: Results, at: Where, over: Where) -> str:
    """Whether every run, some runs or none fail or have more than `DIVERGED` times the other's horizontal error."""
    own, other = (np.where(found["failed"], np.inf, found["horizontal"]) for found in (rows(results, each) for each in (at, over)))
    beyond = np.isinf(own) | (own > DIVERGED * other)
    return "every run" if beyond.all() else "some runs" if beyond.any() else "no run"


def literal(results: Results) -> pd.DataFrame:
    """Levels of self-tuning without a scale, beside the data sheet's variances."""
    made, alpha = [], results.settings.options["alpha"]
    for labels in labels_of(results.table("literal"), ("trajectory", "level", "filter", "alpha")):
        at = where("literal", **labels)
        over = where("literal", trajectory=labels["trajectory"], level="ds", filter=labels["filter"], alpha=alpha)
        row = labels | mean_cells(results, "mean", at, "horizontal") | quantile_cells(results, at, "horizontal")
        row |= mean_cells(results, "height", at, "height") | compared(results, at, over)
        if labels["filter"] == "ukf" and labels["level"] in CHAOTIC:
            row |= dict.fromkeys(set(row) - {*labels, *COMPARED_TALLY}, "")
        made.append(row | {"diverged": diverged(results, at, over)})
    return framed(made)


def leakage_pairs(place: str) -> list[tuple[dict, Where, Where]]:
    """Labels, numerator and denominator of every comparison of `leakage` on a trajectory."""
    made = []
    for name in FILTERS:
        for cell in CELLS:
            tuned, own = variant_name(name, cell), {"trajectory": place, "filter": name, "cell": cell}
            other = next(each for each in TRAJECTORIES if each != place)
            made.append(
                (
                    own | {"settings": f"{other.upper()}-frozen", "over": f"{place.upper()}-frozen"},
                    variant(tuned, place, other),
                    variant(tuned, place, place),
                )
            )
            if name in IN_SAMPLE:
                leaked = where("in-sample", trajectory=place, filter=name, cell=cell)
                made += [
                    (own | {"settings": "in sample", "over": f"{frozen.upper()}-frozen"}, leaked, variant(tuned, place, frozen))
                    for frozen in TRAJECTORIES
                ]
        if name in IN_SAMPLE:
            own = {"trajectory": place, "filter": name, "cell": "st", "over": "data sheet"}
            leaked = where("in-sample", trajectory=place, filter=name, cell="st")
            made.append((own | {"settings": "in sample"}, leaked, variant(name, place)))
            made += [
                (own | {"settings": f"{frozen.upper()}-frozen"}, variant(variant_name(name, "st"), place, frozen), variant(name, place))
                for frozen in TRAJECTORIES
            ]
    return made  # fmt: skip


def leakage(results: Results) -> pd.DataFrame:
    """Settings with the truth of the evaluated run, of the same trajectory and of the other, against each other."""
    made = []
    for place in TRAJECTORIES:
        for labels, above, below in leakage_pairs(place):
            head = {key: labels[key] for key in ("trajectory", "filter", "cell", "settings", "over")}
            made += [head | {"measure": NAMES[measure]} | compared(results, above, below, measure) for measure in LEAKED]
    return framed(made)


TUNING = tuple(map(job_name, FILTERS))

TUNING_TABLES: tuple[Table, ...] = (
    make(
        "extra-budget", "Tuning: one budget for every filter", budgets,
        (keys("filter", "trajectory", "cell"), counts("settings"), texts("scale", "multiple", "at_edge"), numbers("objective"),
         counts("n", "failed")),
        TUNING,
        "settings: evaluated. scale: of self-tuned Q; multiple: of the thresholds of (24). at_edge: knobs whose chosen value is the first "
        "or last of its grid, so that a better one may lie beyond; an infinite multiple, no gate, is an edge too. objective: mean over "
        f"runs of the mean log RMSE over the seven channels (SI, rad). {TUNING_RUNS}", "tuning_runs",
    ),
    make(
        "extra-tuning", "Tuning: every evaluated setting", tuning,
        (keys("filter", "trajectory", "scale", "multiple"), numbers("objective"), texts("chosen_by"),
         counts("n", "failed")), TUNING,
        "objective as in extra-budget; failed where a run failed. chosen_by: cells of the factorial that have this setting; without a gate "
        f"the cell st chooses among the settings of st-gate. Evaluated, but not shown: the UKF from a scale of {CHAOTIC_SCALE:g} "
        f"on, where rounding decides. {TUNING_RUNS}", "tuning_runs",
    ),
    make(
        "extra-self-tuning", "What (12) and (13) give", self_tuning,
        (
            keys("trajectory", "of", "equation", "state"), texts("unit"), numbers("mean"), numbers("mean_rad", kind="optional", unit="rad"),
            texts("negative"), numbers("rms", "increment", "taken"), counts("negative_runs", "negatives", "n"),
        ),
        TUNING,
        f"mean: signed, over drives and runs, metres and degrees; mean_rad: the same in rad. negatives: how many of the {REFERENCED} are "
        "negative, which no variance is; negative_runs: in how many runs this one is. rms, increment: root mean square of the error and of "
        "its change over a second. taken: standard deviation that the printed mean amounts to when its absolute value, lat/lon and azimuth "
        f"in rad, is taken for a variance. RISS only: the mechanisation; others: filters with the data sheet's "
        f"variances. {TUNING_RUNS}", "tuning_runs",
    ),
    make(
        "extra-literal", "Levels of self-tuning without a scale", literal,
        (
            keys("trajectory", "level", "filter", "alpha"), numbers(*interval_names("mean"), "median", "q90", kind="optional", unit="m"),
            numbers(*interval_names("height"), kind="optional", unit="m"), numbers(*COMPARED, kind="optional"),
            texts("diverged"), counts(*COMPARED_TALLY),
        ),
        ("literal",),
        "ds: data sheet; st-printed: absolute signed means, lat/lon in rad, as variances; st-ms: mean squares; st-inc: increments over a "
        f"second. Statistics of T1's tuning runs, no gate. mean, median, q90: horizontal error; height: altitude. {MEAN}. ratio: "
        f"horizontal, to ds of the same filter. {RATIO} diverged: runs that fail or have more than {DIVERGED:g} times the error with ds. "
        f"Of the UKF with st-printed and st-ms only that is said: rounding decides its errors. {SIDE_RUNS}",
        "side_runs",
    ),
    make(
        "extra-leakage", "What leakage is worth", leakage,
        (keys("trajectory", "filter", "cell", "settings", "over", "measure"), numbers(*COMPARED), counts(*COMPARED_TALLY)),
        ("in-sample", *FACTORIAL),
        "settings over others of the same filter and cell: in sample (Q, P0, scale and multiple from the truth of the evaluated run), "
        f"frozen on the tuning runs of T1 or T2, data sheet (no gate). {RATIO} better: share of the runs that settings win. "
        f"In sample fewer runs: see n. {RUNS}",
    ),
)  # fmt: skip
"""Tables of tuning, in the order of the report."""
