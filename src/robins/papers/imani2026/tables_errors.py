"""Tables of errors in the headline condition: Table 5, all filters, what beats what, position, consistency, weights."""

import numpy as np
import pandas as pd

from robins.evaluate.consistency import chi_square_band
from robins.evaluate.ensembles import ensemble_level
from robins.evaluate.intervals import mean_interval
from robins.foundation.randomness import stream
from robins.papers.columns import counts, ends, finite, keys, make, numbers, texts
from robins.papers.imani2026.comparisons import (
    PAIR,
    PRINTED_PAIR,
    adjusted,
    improvements,
    level,
    of_channel,
)
from robins.papers.imani2026.drive import CHANNELS, DURATION, KEY
from robins.papers.imani2026.formulations import FORMULATIONS
from robins.papers.imani2026.scoring import AVERAGED
from robins.papers.imani2026.table_parts import (
    FORMULATIONS_CAPTION,
    HEADLINE,
    IMPROVEMENT_TOLERANCE,
    INTERVAL,
    LOSSES,
    RATIO,
    RUNS,
    SURVIVORS,
    channel_units,
    improvement_cells,
    interval_names,
    level_cells,
    not_available,
    p_value,
    ratio_cells,
)
from robins.papers.imani2026.variants import VARIANTS
from robins.papers.protocol import Column, Results, Table

MKMC, CI = PAIR
AGAINST = {"truth": CHANNELS, "interval": CHANNELS[AVERAGED], "reference": CHANNELS}
"""What estimates are compared with, and in which channels."""
PRINTED_ORDER = ("drift", "rmse", "mean", "sd")
"""The metrics in the order of the paper's Table 5."""
PAIRS = (
    PAIR, PRINTED_PAIR, ("mk-norm-gain-nominal", "ci-seq-nominal"), (CI, "ekf"), (CI, "ekf-tuned"), (MKMC, "ekf"), (MKMC, "ekf-tuned"),
    (MKMC, "no-update"), (MKMC, "ci-corr"), (MKMC, "gate"), (MKMC, "single-kernel"),
    (MKMC, "single-kernel-gain"), (MKMC, "mk-norm"), (MKMC, "mk-li"), (MKMC, "mcc1"),
    (MKMC, "huber"), ("ekf-tuned", "no-update"),
)  # fmt: skip
"""Every comparison of `extra-ratios`: the filter that may be better, and the other."""
NEES_TIMES = (30, 150, 330)
"""When the normalised errors are shown [s]: early, on the slope, at the end."""
AXES = ("east", "north", "up")
NORMALISED = {"NIS": 6, "NEES attitude": 3, "NEES biases": 6}
"""Degrees of freedom of each normalised square."""


def comparison(results: Results, formulation: str, against: str, metric: str) -> list[dict]:
    """CI-RKF, MKMC-EKF and the improvement in every channel for one metric."""
    found = improvements(results, MKMC, CI, formulation, against, metric)
    rows = []
    for (channel, unit), p in zip(channel_units(), adjusted(found), strict=True):
        row: dict = {"channel": channel, "unit": unit}
        for name, variant in (("ci", CI), ("mkmc", MKMC)):
            row |= level_cells(name, level(results, variant, formulation, against, metric, channel), unit)
        row |= improvement_cells("improvement", of_channel(found, channel)) | {"p_holm": p_value(found, p)}
        rows.append(row | {"n": found.n, "ci_failed": found.denominator_failed, "mkmc_failed": found.numerator_failed})
    return rows


LEVELS, IMPROVED = interval_names("ci", "mkmc"), interval_names("improvement")
COMPARED = (*LEVELS, *IMPROVED, "p_holm")
TALLY = ("n", "ci_failed", "mkmc_failed")


def compared_columns(prefix: str = "") -> tuple[Column, ...]:
    """Columns of `COMPARED`."""
    levels, improved = ([prefix + name for name in names] for names in (LEVELS, IMPROVED))
    return (*numbers(*levels), *numbers(*improved, absolute=IMPROVEMENT_TOLERANCE), *numbers(f"{prefix}p_holm"))


def table_5(results: Results) -> pd.DataFrame:
    """Table 5: every metric of both filters, channel by channel."""
    by_metric = {metric: comparison(results, "F1", "truth", metric) for metric in PRINTED_ORDER}
    rows = []
    for i, (channel, unit) in enumerate(channel_units()):
        row: dict = {"channel": channel, "unit": unit}
        for metric, found in by_metric.items():
            row |= {f"{metric}_{name}": found[i][name] for name in COMPARED}
        rows.append(row | {name: found[i][name] for name in TALLY})
    return pd.DataFrame(rows)


def table_5_everywhere(results: Results) -> pd.DataFrame:
    """The comparison of Table 5 in all formulations, against the truth, its interval averages, and the reference."""
    rows = []
    for formulation in FORMULATIONS:
        for against, channels in AGAINST.items():
            for metric in PRINTED_ORDER:
                labels = {"formulation": formulation, "against": against, "metric": metric}
                found = comparison(results, formulation, against, metric)
                rows += [labels | row for row in found if row["channel"] in channels]
    return pd.DataFrame(rows)


def filters(results: Results) -> pd.DataFrame:
    """RMSE of every filter in every formulation and channel."""
    rows = []
    for formulation in FORMULATIONS:
        for name in VARIANTS:
            for channel, unit in channel_units():
                found = level(results, name, formulation, "truth", "rmse", channel)
                median = np.degrees(found.median) if unit == "deg" else found.median
                rows.append({
                    "formulation": formulation, "filter": name, "channel": channel, "unit": unit, **level_cells("rmse", found, unit),
                    "median": finite(median), "n": found.n, "failed": found.failed,
                })  # fmt: skip
    return pd.DataFrame(rows)


def ratios(results: Results) -> pd.DataFrame:
    """What beats what in RMSE: `PAIRS` in every formulation and channel."""
    rows = []
    for above, below in PAIRS:
        for formulation in FORMULATIONS:
            found = improvements(results, above, below, formulation, "truth", "rmse")
            for channel, p in zip(CHANNELS, adjusted(found), strict=True):
                rows.append({
                    "filter": above, "over": below, "formulation": formulation, "channel": channel,
                    **ratio_cells(of_channel(found, channel)), "p_holm": p_value(found, p),
                    "n": found.n, "failed": found.numerator_failed, "over_failed": found.denominator_failed,
                })  # fmt: skip
    return pd.DataFrame(rows)


def position(results: Results) -> pd.DataFrame:
    """Position errors of every filter: root mean square over the drive and at its end, by axis."""
    rows = []
    for formulation in FORMULATIONS:
        for name in VARIANTS:
            arrays = results.arrays(name)
            failed = arrays[f"{formulation}.failed"]
            draws = stream(results.settings.seed, f"{KEY}/bootstrap/0/position-{name}-{formulation}")
            rms, final = (
                ensemble_level(arrays[f"{formulation}.position_{what}"], failed, power, draws, results.settings.sizes["bootstrap"])
                for what, power in (("rms", 2), ("final", 1))
            )
            for i, axis in enumerate(AXES):
                row = {"formulation": formulation, "filter": name, "axis": axis}
                for what, found in (("rms", rms), ("final", final)):
                    row |= {what: finite(found.estimate[i])} | ends(what, found.low[i], found.high[i])
                rows.append(row | {"n": found.n, "failed": found.failed})
    return pd.DataFrame(rows)


def normalised_squares(arrays: dict, formulation: str, rate_hz: int) -> list[tuple[str, int, np.ndarray, int]]:
    """Quantity, time [s], values by run, and independent values in a run, of what `consistency` shows."""
    marks = list(arrays[f"{formulation}.marks"])
    found = [("NIS", DURATION, arrays[f"{formulation}.nis"], DURATION * rate_hz)]
    for quantity, key in (("NEES attitude", "nees_attitude"), ("NEES biases", "nees_bias")):
        values = arrays[f"{formulation}.{key}"]
        found += [(quantity, time, values[:, marks.index(time * rate_hz)], 1) for time in NEES_TIMES]
    return found


def consistency(results: Results) -> pd.DataFrame:
    """Are the filters' covariances honest? Normalised squares with their intervals beside what honest filters have."""
    rows = []
    for formulation in FORMULATIONS:
        for name in VARIANTS:
            arrays = results.arrays(name)
            failed = arrays[f"{formulation}.failed"]
            for quantity, time, values, independent in normalised_squares(arrays, formulation, results.settings.options["rate_hz"]):
                kept = values[~failed]
                if len(kept) and np.isnan(kept).all():  # no update, no innovation
                    continue
                row = {"formulation": formulation, "filter": name, "quantity": quantity, "time": time}
                band = chi_square_band(NORMALISED[quantity], max(1, len(kept)) * independent)
                rows.append(row | mean_cells("mean", kept) | band_cells(band, len(kept)) | {"n": len(failed), "failed": int(failed.sum())})
    return pd.DataFrame(rows)


def mean_cells(name: str, values: np.ndarray) -> dict[str, float | str]:
    """Mean over the surviving runs with its interval, or ``failed``."""
    found = mean_interval(values) if len(values) else (np.nan,) * 3
    return {name: finite(found[0])} | ends(name, found[1], found[2])


def band_cells(band, survivors: int) -> dict[str, float | str]:
    """What an honest filter's mean lies in; ``failed`` where no run survives."""
    return {"expected": band.expected} | ends("honest", *(band[1:] if survivors else (np.nan, np.nan)))


def weights(results: Results) -> pd.DataFrame:
    """How often each sensor's channels get less than their full weight."""
    rows = []
    for formulation in FORMULATIONS:
        for name, variant in VARIANTS.items():
            if variant.family in ("ekf", "inflated", "no-update"):  # these weigh nothing
                continue
            arrays = results.arrays(name)
            failed = arrays[f"{formulation}.failed"]
            share = arrays[f"{formulation}.share_reduced"][~failed]
            for sensor, columns in (("accelerometer", slice(0, 3)), ("gyroscope", slice(3, 6))):
                rows.append({
                    "formulation": formulation, "filter": name, "sensor": sensor, **mean_cells("share", share[:, columns].mean(axis=1)),
                    "n": len(failed), "failed": int(failed.sum()),
                })  # fmt: skip
    return pd.DataFrame(rows)


ERROR_TABLES: tuple[Table, ...] = (
    make(
        "table-5", "Errors of CI-RKF and MKMC-EKF, channel by channel", table_5,
        (
            keys("channel"), texts("unit"), *(compared_columns(f"{metric}_") for metric in PRINTED_ORDER), counts(*TALLY),
        ),
        PAIR,
        f"{not_available(5)} F1 against the truth. {HEADLINE} drift: mean over the runs of the absolute error at the last epoch; rmse, sd: "
        "root mean square over the runs of (44) and (46); mean: mean of the absolute value of (45). improvement: of MKMC-EKF over CI-RKF "
        f"[%], one minus the ratio of ensemble values. Each with its {INTERVAL}, paired for improvements; p_holm: two-sided, adjusted over "
        f"the 12 channels. {LOSSES} Both filters are tuned with one budget. {RUNS}",
        location="Table 5",
    ),
    make(
        "extra-table-5", "Table 5 in every formulation, against truth and reference", table_5_everywhere,
        (keys("formulation", "against", "metric", "channel"), texts("unit"), compared_columns(), counts(*TALLY)), PAIR,
        f"{FORMULATIONS_CAPTION} against: the truth at the sample's time, its average over the sample's interval, and the reference system "
        f"with errors of its own, which stands for VITANS. {HEADLINE} Settings were tuned in F1. Metrics and intervals as in Table 5; the "
        "other reading of drift, the integral of the error, is the mean times 330 s, so its improvement is that of the mean. p_holm: over "
        f"the 12 channels of a formulation, reference and metric. {LOSSES} {RUNS}",
    ),
    make(
        "extra-filters", "RMSE of every filter", filters,
        (keys("formulation", "filter", "channel"), texts("unit"), numbers(*interval_names("rmse"), "median"), counts("n", "failed")),
        VARIANTS,
        f"Against the truth. {FORMULATIONS_CAPTION} {HEADLINE} Root mean square over the runs with its {INTERVAL}. {SURVIVORS} "
        f"What the names stand for is in extra-variants. {RUNS}",
    ),
    make(
        "extra-ratios", "What beats what", ratios,
        (
            keys("filter", "over", "formulation", "channel"), numbers(*interval_names("ratio"), "p_holm"),
            counts("n", "failed", "over_failed"),
        ),
        dict.fromkeys(name for pair in PAIRS for name in pair),
        f"ratio: RMSE of filter over that of the other, against the truth, with its paired {INTERVAL}; {RATIO}. p_holm: of no "
        f"difference, adjusted over the 12 channels of a pair and formulation. {FORMULATIONS_CAPTION} {HEADLINE} {LOSSES} Where no run "
        f"survives in both, failed. {RUNS}",
    ),
    make(
        "extra-position", "Position error of every filter", position,
        (keys("formulation", "filter", "axis"), numbers(*interval_names("rms", "final"), unit="m"), counts("n", "failed")), VARIANTS,
        "Position is unobservable (Prop2), and the paper prints no position error. rms: root mean square over drive and runs; final: mean "
        f"over the runs of the absolute error at the end. With the {INTERVAL}. {FORMULATIONS_CAPTION} {HEADLINE} {RUNS}",
    ),
    make(
        "extra-consistency", "Are the filters' covariances honest?", consistency,
        (
            keys("formulation", "filter", "quantity", "time"), numbers(*interval_names("mean")),
            numbers("expected", "honest_low", "honest_high"), counts("n", "failed"),
        ),
        VARIANTS,
        "Normalised innovation squared, mean over the drive (time: its end, s), and normalised estimation error squared of attitude "
        "and biases at three times (s). Mean over the surviving runs with its 95 % interval; expected, honest: mean and 95 % band for an "
        f"honest filter, for NIS of white innovations. A filter without updates has no NIS. {FORMULATIONS_CAPTION} {HEADLINE} {RUNS}",
    ),
    make(
        "extra-weights", "How often a weight is below one", weights,
        (keys("formulation", "filter", "sensor"), numbers(*interval_names("share")), counts("n", "failed")), VARIANTS,
        "Share of the updates in which a channel of the sensor has less than its full weight; a correntropy filter never gives more than "
        f"that. Mean over channels and surviving runs with its 95 % interval. {FORMULATIONS_CAPTION} {HEADLINE} {RUNS}",
    ),
)  # fmt: skip
"""Tables of errors, in the order of the report."""
