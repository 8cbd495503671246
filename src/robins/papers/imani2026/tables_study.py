"""Tables of the tuning and of the studies: outliers, kernel scale, sensor grades, rates, thresholds, ablations, theory."""

from collections.abc import Mapping

import pandas as pd

from robins.papers.columns import LINEAR, counts, finite, keys, make, numbers, texts
from robins.papers.imani2026.ablations import FILTERS as ABLATED
from robins.papers.imani2026.comparisons import PAIR, Filter, of_channel, sweep_improvements, sweep_level
from robins.papers.imani2026.ensemble import frozen
from robins.papers.imani2026.methods import FAMILIES, Setting
from robins.papers.imani2026.table_parts import (
    HEADLINE,
    INTERVAL,
    LOSSES,
    RATIO,
    RUNS,
    SWEPT_FILTERS,
    channel_units,
    interval_names,
    level_cells,
    ratio_cells,
    shown,
)
from robins.papers.imani2026.tune import CONDITIONS, budget
from robins.papers.imani2026.variants import VARIANTS
from robins.papers.protocol import Results, Table

CI = PAIR[1]
TUNING = {family: f"tuning-{family}" for family in FAMILIES}
CI_OF_SCALE = {"method": "ci-seq", "scale": 1.0}
"""The CI-RKF in the study of the kernel scale: conventional in F0, tuned in F1."""


def tuning(results: Results) -> pd.DataFrame:
    """Every evaluated setting of every family and condition."""
    rows = []
    for family, job in TUNING.items():
        for found in results.table(job).itertuples(index=False):
            rows.append({
                "family": family, "condition": found.condition, "noise_scale": found.noise_scale, "value": f"{found.value:.4g}",
                "parameter": found.parameter, "stage": found.stage, "objective": finite(found.objective),
                "chosen": "chosen" if found.chosen else "", "n": results.settings.sizes["tuning_runs"], "failed": int(found.failed),
            })  # fmt: skip
    return pd.DataFrame(rows)


def budgets(results: Results) -> pd.DataFrame:
    """How many settings each family was given, and what it chose."""
    evaluated = budget({family: results.table(job) for family, job in TUNING.items()})
    rows = []
    for family, knob in FAMILIES.items():
        row = {"family": family, "label": knob.label, "parameter": knob.parameter, "conventional": knob.grid[1]}
        row["settings"] = evaluated[family]
        chosen = {condition: frozen(results, family, condition) for condition in CONDITIONS}
        for condition, setting in chosen.items():
            row |= {f"{condition}_noise_scale": setting.noise_scale, f"{condition}_value": setting.value}
        table = results.table(TUNING[family])
        row |= {f"{condition}_at_edge": edges(table, condition, setting) for condition, setting in chosen.items()}
        rows.append(row)
    return pd.DataFrame(rows)


def edges(table: pd.DataFrame, condition: str, setting: Setting) -> str:
    """Which knobs of the chosen setting stand at the edge of what was evaluated, after the extension."""
    tried = table[table["condition"] == condition]
    knobs = {"R": ("noise_scale", setting.noise_scale), "own": ("value", setting.value)}
    return ", ".join(name for name, (column, value) in knobs.items() if value in (tried[column].min(), tried[column].max()))


def variants(results: Results) -> pd.DataFrame:
    """What each name stands for, and the frozen settings of those that are tuned."""
    rows = []
    for name, variant in VARIANTS.items():
        family = variant.composition.get("tuned", "")
        choices = {key: value for key, value in variant.composition.items() if key != "tuned"}
        row = {"filter": name, "label": variant.label, "choices": ", ".join(f"{key}: {value}" for key, value in choices.items())}
        row |= {"tuned": family, "noise_scale": "", "parameter": "", "value": ""}
        if family:
            setting = frozen(results, family)
            row |= {"noise_scale": setting.noise_scale, "parameter": FAMILIES[family].parameter, "value": setting.value}
        rows.append(row)
    return pd.DataFrame(rows)


def compared(results: Results, study: str, where: Mapping, of: Filter, over: Filter) -> list[dict]:
    """RMSE of a filter of a study, and its ratio to that of another, in every channel."""
    found = sweep_improvements(results, study, where, of, over, "rmse")
    rows = []
    for channel, unit in channel_units():
        rmse = sweep_level(results, study, where, of, "rmse", channel)
        rows.append({
            "channel": channel, "unit": unit, "rmse": finite(shown(rmse.estimate, unit)),
            **ratio_cells(of_channel(found, channel)),
            "n": found.n, "failed": found.numerator_failed, "ci_failed": found.denominator_failed,
        })  # fmt: skip
    return rows


def labels_of(table: pd.DataFrame, names: tuple[str, ...]) -> list[dict]:
    """The combinations of these columns, in the order of the rows."""
    return table[list(names)].drop_duplicates().to_dict("records")


def sweep(results: Results, study: str, names: tuple[str, ...]) -> pd.DataFrame:
    """Every filter of a study but the CI-RKF over the CI-RKF, at all labels `names`."""
    rows = []
    for where in labels_of(results.table(study), names):
        for name in SWEPT_FILTERS:
            if name != CI:
                rows += [where | {"filter": name} | row for row in compared(results, study, where, name, CI)]
    return pd.DataFrame(rows)


OUTLIERS, GRADES, RATES = ("law", "sided", "rate", "tuned"), ("grade",), ("rate_hz", "noise")


def outliers(results: Results) -> pd.DataFrame:
    """Ratios by noise law, side and rate of the outliers."""
    return sweep(results, "outliers", OUTLIERS)


def grades(results: Results) -> pd.DataFrame:
    """Ratios by sensor grade."""
    return sweep(results, "grades", GRADES)


def rates(results: Results) -> pd.DataFrame:
    """Ratios by sampling rate."""
    return sweep(results, "rates", RATES)


def scaled(row: Mapping) -> dict:
    """A scale as text: some are infinite."""
    return {"method": row["method"], "scale": f"{row['scale']:g}"}


def kernel_map(results: Results) -> pd.DataFrame:
    """Ratios of the kernels to the CI-RKF by rate of outliers and scale of the widths, in F1."""
    table = results.table("scale")
    table = table[(table["formulation"] == "F1") & table["method"].isin(("mk-norm", "mk-norm-gain"))]
    rows = []
    for labels in labels_of(table, ("formulation", "rate", "method", "scale")):
        where, of = ({key: labels[key] for key in pair} for pair in (("formulation", "rate"), ("method", "scale")))
        head = {"rate": labels["rate"]} | scaled(labels)
        rows += [head | row for row in compared(results, "scale", where, of, CI_OF_SCALE)]
    return pd.DataFrame(rows)


def kernel_scale(results: Results) -> pd.DataFrame:
    """RMSE over the kernel scale with its controls, without outliers."""
    table = results.table("scale")
    rows = []
    for labels in labels_of(table[table["rate"] == 0.0], ("formulation", "rate", "method", "scale")):
        where, of = ({key: labels[key] for key in pair} for pair in (("formulation", "rate"), ("method", "scale")))
        for channel, unit in channel_units():
            found = sweep_level(results, "scale", where, of, "rmse", channel)
            rows.append({
                "formulation": labels["formulation"], **scaled(labels), "channel": channel, "unit": unit,
                **level_cells("rmse", found, unit), "n": found.n, "failed": found.failed,
            })  # fmt: skip
    return pd.DataFrame(rows)


def conventional(options: Mapping) -> dict:
    """The conventional CI-RKF among the rows of the study ``grids``."""
    beta, low, high = (options[f"chi_square_{name}"] for name in ("probability", "lower", "upper"))
    return {"method": "chi-square", "setting": f"linear, beta {beta:g}, c0 {low:g}, c1 {high:g}"}


def grids(results: Results) -> pd.DataFrame:
    """Ratios of every threshold and number of kernels to the conventional CI-RKF."""
    over, rows = conventional(results.settings.options), []
    for of in labels_of(results.table("grids"), ("method", "setting")):
        rows += [of | row for row in compared(results, "grids", {}, of, over)]
    return pd.DataFrame(rows)


def ablations(results: Results) -> pd.DataFrame:
    """RMSE of three filters under each choice, and whether it changes the comparison of two of them."""
    rows = []
    ekf, ci, mkmc = ABLATED
    for where in labels_of(results.table("ablations"), ("ablation", "formulation")):
        for row in compared(results, "ablations", where, mkmc, ci):
            levels = {}
            for name, filter_name in (("ekf", ekf), ("ci", ci)):
                found = sweep_level(results, "ablations", where, filter_name, "rmse", row["channel"])
                levels[name] = finite(shown(found.estimate, row["unit"]))
            rows.append(where | row | levels)
    columns = ["ablation", "formulation", "channel", "unit", "ekf", "ci", "rmse", *interval_names("ratio"), *TALLY]
    return pd.DataFrame(rows)[columns].rename(columns={"rmse": "mkmc"})


def theory(results: Results) -> pd.DataFrame:
    """What the propositions expect, and what was found."""
    return results.table("theory")[["quantity", "expected", "value", "low", "high", "n"]]


TALLY = ("n", "failed", "ci_failed")
COMPARED = (numbers("rmse", *interval_names("ratio")), counts(*TALLY))
OVER_CI = (
    "rmse: root mean square over the surviving runs, against the truth, in F1; ratio: to that of the CI-RKF in the same rows with its "
    f"paired {INTERVAL}; {RATIO}. {LOSSES}"
)
TUNED = f"Every filter has its tuned and frozen settings. {RUNS}"
CONVENTIONAL = "Conventional settings, not tuned. Runs 0 to n - 1 of the configuration's seed."

STUDY_TABLES: tuple[Table, ...] = (
    make(
        "extra-variants", "Every filter of the study", variants,
        (keys("filter"), texts("label", "choices", "tuned"), numbers("noise_scale", kind="optional"), texts("parameter"),
         numbers("value", kind="optional")),
        TUNING.values(),
        "choices: what differs from the method's conventional settings; tuned: the family whose tuned settings a filter has, namely a "
        f"multiplier of R (noise_scale) and a parameter of its own. Tuned on runs from 1000 on in F1; {HEADLINE}", "tuning_runs",
    ),
    make(
        "extra-budget", "Tuning: the same number of settings for every family", budgets,
        (
            keys("family"), texts("label", "parameter"), numbers("conventional", relative=LINEAR), counts("settings"),
            numbers(*(f"{condition}_{name}" for condition in CONDITIONS for name in ("noise_scale", "value")), relative=LINEAR),
            texts(*(f"{condition}_at_edge" for condition in CONDITIONS)),
        ),
        TUNING.values(),
        "settings: evaluated under each condition. Chosen multiplier of R and value of the parameter in the headline condition "
        f"({HEADLINE.rstrip('.')}), frozen for all results, and retuned with 2 % two-sided outliers. F1, runs 1000 to 1000 + n - 1. "
        "at_edge: knobs (the multiplier of R; the family's own) whose chosen value is the largest or smallest that was tried, "
        "the extension included: a still better setting may lie beyond.",
        "tuning_runs",
    ),
    make(
        "extra-tuning", "Tuning: every evaluated setting", tuning,
        (
            keys("family", "condition", "noise_scale", "value"), texts("parameter", "stage"), numbers("objective"), texts("chosen"),
            counts("n", "failed"),
        ),
        TUNING.values(),
        "objective: mean over the 12 channels of the logarithm of the ensemble RMSE against the truth (SI, rad); failed where a run "
        "failed, and never chosen then. A 3 x 3 grid, then one row and one column more. F1, runs 1000 to 1000 + n - 1, which no other "
        "result uses.", "tuning_runs",
    ),
    make(
        "extra-outliers", "RMSE over that of the CI-RKF, with outliers", outliers,
        (keys(*OUTLIERS, "filter", "channel"), texts("unit"), *COMPARED), ("outliers",),
        f"rate: share of the samples of each channel; size: 15 standard deviations times U(0.5, 1.5). {OVER_CI} tuned: under which "
        f"condition, both filters alike. 10 Hz. {TUNED}", "sweep_runs",
    ),
    make(
        "extra-map", "RMSE over that of the CI-RKF by rate of outliers and kernel scale", kernel_map,
        (keys("rate", "method", "scale", "channel"), texts("unit"), *COMPARED), ("scale",),
        f"scale: multiplier of the widths; two-sided outliers, zero-mean noise, 10 Hz. {OVER_CI} R of each kernel, and the CI-RKF, as "
        f"tuned under the headline condition. {RUNS}", "sweep_runs",
    ),
    make(
        "extra-scale", "RMSE over the kernel scale, with controls", kernel_scale,
        (keys("formulation", "method", "scale", "channel"), texts("unit"), numbers(*interval_names("rmse")), counts("n", "failed")),
        ("scale",),
        "scale: multiplier of the widths (mk-norm, mk-norm-gain), width in standard deviations (single-kernel), threshold in standard "
        "deviations (gate), factor on R (ekf-r). Root mean square over the surviving runs, against the truth, with its "
        f"{INTERVAL}. F1 has fewer runs than F0: see the column n. {HEADLINE} F0: conventional settings; F1: R of the kernels and of "
        f"the gate, and the CI-RKF, as tuned under the headline condition. {RUNS}",
    ),
    make(
        "extra-grades", "RMSE over that of the CI-RKF by sensor grade", grades,
        (keys(*GRADES, "filter", "channel"), texts("unit"), *COMPARED), ("grades",),
        f"vehicle: what an atomic sensor is worth in a moving car; atomic-ideal: what it promises in the laboratory. {OVER_CI} {HEADLINE} "
        f"{TUNED}", "sweep_runs",
    ),
    make(
        "extra-rates", "RMSE over that of the CI-RKF by sampling rate", rates,
        (keys(*RATES, "filter", "channel"), texts("unit"), *COMPARED), ("rates",),
        "noise: a sample's standard deviation is kept (equal-sample) or the noise density is (equal-psd). Above 10 Hz there are fewer "
        f"runs: see the column n. {OVER_CI} {TUNED}", "sweep_runs",
    ),
    make(
        "extra-grids", "Thresholds of the CI-RKF and numbers of kernels", grids,
        (keys("method", "setting", "channel"), texts("unit"), *COMPARED), ("grids",),
        f"beta, c0, c1 and the shape of (35); kernels of equal weight. {OVER_CI} Here the CI-RKF is the conventional one, linear. "
        f"{HEADLINE} {CONVENTIONAL}", "fast_runs",
    ),
    make(
        "extra-ablations", "Readings and choices, one at a time", ablations,
        (
            keys("ablation", "formulation", "channel"), texts("unit"), numbers("ekf", "ci", "mkmc", *interval_names("ratio")),
            counts(*TALLY),
        ),
        ("ablations",),
        "ekf, ci, mkmc: RMSE of EKF, CI-RKF and MKMC-EKF, root mean square over the surviving runs, against the truth; ratio: of "
        f"MKMC-EKF to CI-RKF with its paired {INTERVAL}; {RATIO}. {LOSSES} 10 Hz. {CONVENTIONAL}", "fast_runs",
    ),
    make(
        "extra-theory", "Propositions: expected and found", theory,
        (keys("quantity"), numbers("expected", "value", "low", "high"), counts("n")), ("theory",),
        "expected: from analysis or from the brief; value: what this library's own functions give. With its 95 % interval where n draws, "
        "records or runs decide (of sample moments: median and central 95 % over n records); n = 0: nothing is random.",
    ),
)  # fmt: skip
"""Tables of tuning and studies, in the order of the report."""
