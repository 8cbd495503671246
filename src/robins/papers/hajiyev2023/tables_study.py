"""The tables of the study: consistency, scale factors, sweeps and the specification curve."""

import numpy as np
import pandas as pd

from robins.evaluate.intervals import proportion_interval
from robins.kalman.filter import schedule
from robins.kalman.predict import Ekf
from robins.navigation.aircraft import STATES
from robins.papers.columns import counts, finite, keys, make, numbers
from robins.papers.hajiyev2023.claims_theory import moments
from robins.papers.hajiyev2023.comparisons import AMDKF, MDKF, cases, expected_scale, kinds, matrices, scores
from robins.papers.hajiyev2023.estimators import printed
from robins.papers.hajiyev2023.scenario import BRANCHES, STEADY, baseline
from robins.papers.hajiyev2023.table_parts import SUBSTITUTE, geometric, level, patterns
from robins.papers.hajiyev2023.variants import VARIANTS
from robins.papers.protocol import Results, Table

CONSISTENT = tuple(name for name in VARIANTS if not name.endswith("-lagged"))
ADAPTING = (AMDKF, "amdkf-gated", "amdkf-scalar-trace", "amdkf-scalar-mean", "abh", "aakf")
WITHOUT_WHITE_NOISE = "healthy, no white noise"
HALF_NORMAL = 0.564
"""``sqrt(2) E[max(0, x)]`` of a standard normal x, ``1/sqrt(pi)``, as the brief rounds it (section 1.3)."""
INTERVAL = ("low", "high")


def consistency(results: Results) -> pd.DataFrame:
    """Is a filter's covariance honest, and is its innovation white?"""
    rows = []
    for name in CONSISTENT:
        for branch, condition in cases():
            found = scores(results, name, branch, condition, kinds(results, name)[0])
            row = {"filter": name, "branch": branch, "condition": condition}
            for what in ("settled", "window"):
                mean = level(getattr(found, f"nis_{what}")[~found.failed])
                row |= {f"nis_{what}": mean["mean"]} | {f"nis_{what}_{end}": mean[end] for end in INTERVAL}
            row |= by_channel(results.arrays(name), f"{branch}.{condition}")
            rows.append(row | {"n": len(found.failed), "failed": int(found.failed.sum())})
    for name in (MDKF, "bh"):
        for branch in BRANCHES:
            arrays, prefix = results.arrays("theory"), f"{branch}.{name}.no-v"
            nis = moments(arrays, prefix).nis
            row = {"filter": name, "branch": branch, "condition": WITHOUT_WHITE_NOISE, "nis_settled": nis.estimate}
            row |= {"nis_settled_low": nis.low, "nis_settled_high": nis.high} | dict.fromkeys(WINDOW_NIS, "")
            rows.append(row | by_channel(arrays, prefix) | {"n": results.settings.sizes["runs"], "failed": 0})
    return pd.DataFrame(rows)


WINDOW_NIS = ("nis_window", "nis_window_low", "nis_window_high")
CHANNEL_FIGURES = tuple(f"{what}_{state}" for what in ("lag1", "variance", "honesty") for state in STATES)


def by_channel(arrays: dict[str, np.ndarray], prefix: str) -> dict[str, float]:
    """Lag-one autocorrelation, variance over the filter's own, and rms error over the filter's own deviation, by channel."""
    honesty = np.mean(arrays[f"{prefix}.rms_error"][STEADY] / arrays[f"{prefix}.sd_mean"][STEADY], axis=0)
    values = arrays[f"{prefix}.innovation_autocorrelation"][1], arrays[f"{prefix}.innovation_variance_ratio"], honesty
    return dict(zip(CHANNEL_FIGURES, map(float, np.concatenate(values)), strict=True))


def healthy_scale(results: Results, branch: str) -> np.ndarray:
    """Scale factors that (23) gives without any fault, ``1 + 0.564 (Sigma / R) / sqrt(M)``, shape (8,) (brief, section 1.3).

    Sigma is the innovation covariance (18) of the MDKF, which depends on no data, averaged as the scale factors are.
    """
    parameters, m = baseline(branch), matrices(results, branch)
    form = printed(m, parameters)
    plan = schedule(Ekf(), form.model, form.sensor, form.P0, form.weights, form.valid, 8, False)
    sigma = np.mean(np.sum(plan.factor[STEADY] ** 2, axis=2), axis=0)
    return 1.0 + HALF_NORMAL * sigma / np.diag(form.sensor.R) / np.sqrt(parameters.window)


def scale_factors(results: Results) -> pd.DataFrame:
    """Mean scale factors by channel, with and without the fault, and what theory says of those of the AMDKF."""
    rows = []
    expected = {branch: (expected_scale(results, branch), healthy_scale(results, branch)) for branch in BRANCHES}
    for name in ADAPTING:
        for branch in BRANCHES:
            found = {condition: scores(results, name, branch, condition) for condition in ("fault", "healthy")}
            for i, state in enumerate(STATES):
                row = {"filter": name, "branch": branch, "channel": state}
                for condition, score in found.items():
                    mean = level(score.scale[~score.failed, i])
                    row |= {condition: mean["mean"]} | {f"{condition}_{end}": mean[end] for end in INTERVAL}
                with_theory = name == AMDKF
                row["fault_theory"] = expected[branch][0].get(state, "") if with_theory else ""
                row["healthy_theory"] = float(expected[branch][1][i]) if with_theory else ""
                lost = found["fault"].failed | found["healthy"].failed
                rows.append(row | {"n": len(lost), "failed": int(lost.sum())})
    return pd.DataFrame(rows)


def sweeps(results: Results) -> pd.DataFrame:
    """Every one-at-a-time setting: geometric mean ratio with its interval."""
    rows = []
    for branch in BRANCHES:
        groups = results.table(f"sweep-{branch}").groupby(["branch", "sweep", "setting", "pair", "state"], sort=False)
        for key, group in groups:
            kept = group[~group["failed"]]
            found = geometric(kept["numerator"].to_numpy(), kept["denominator"].to_numpy())
            named = dict(zip(("branch", "sweep", "setting", "pair", "state"), key, strict=True))
            rows.append({**named, "value": float(group["value"].iloc[0]), **found, "n": len(group), "failed": len(group) - len(kept)})
    return pd.DataFrame(rows)


def specification_logs(results: Results, branch: str) -> dict[str, np.ndarray]:
    """Mean log ratio of each parameter set and state, shape (sets, 8), by pair; NaN where no run of a set survives."""
    table = results.table(f"specification-{branch}")
    return {pair: group["mean_log"].to_numpy().reshape(-1, 8) for pair, group in table.groupby("pair", sort=False)}


def specification(results: Results) -> pd.DataFrame:
    """How the ratios are spread over the parameter sets, state by state."""
    rows = []
    for branch in BRANCHES:
        for pair, logs in specification_logs(results, branch).items():
            for i, state in enumerate(STATES):
                found = np.exp(logs[np.isfinite(logs[:, i]), i])
                row = {"branch": branch, "pair": pair, "state": state}
                for words, below in (("below_1", found < 1), ("below_0.95", found < 0.95), ("above_1.05", found > 1.05)):
                    share = proportion_interval(int(below.sum()), len(found))
                    row |= {words: finite(share.estimate), f"{words}_low": share.low, f"{words}_high": share.high}
                cuts = np.quantile(found, (0.1, 0.5, 0.9)) if len(found) else np.full(3, np.nan)
                row |= {name: finite(value) for name, value in zip(("q10", "q50", "q90"), cuts, strict=True)}
                rows.append(row | {"n": len(logs), "failed": len(logs) - len(found)})
    return pd.DataFrame(rows)


def specification_patterns(results: Results) -> pd.DataFrame:
    """In how many parameter sets the mean ratios have the signs of Table 1."""
    rows = []
    for branch in BRANCHES:
        for pair, logs in specification_logs(results, branch).items():
            found = logs[np.isfinite(logs).all(axis=1)]
            for name, shown in patterns(np.sign(found)).items():
                share = proportion_interval(int(shown.sum()), len(found))
                interval = finite(share.estimate), share.low, share.high
                rows.append((branch, pair, name, *interval, int(shown.sum()), len(logs), len(logs) - len(found)))
    return pd.DataFrame(rows, columns=["branch", "pair", "pattern", "share", "share_low", "share_high", "sets", "n", "failed"])


SHARES = tuple(f"{words}{end}" for words in ("below_1", "below_0.95", "above_1.05") for end in ("", "_low", "_high"))

STUDY_TABLES: tuple[Table, ...] = (
    make(
        "extra-consistency", "Are the filters' covariances honest?", consistency,
        (
            keys("filter", "branch", "condition"), numbers("nis_settled", "nis_settled_low", "nis_settled_high"),
            numbers(*WINDOW_NIS, kind="optional"), numbers(*CHANNEL_FIGURES), counts("n", "failed"),
        ),
        (*CONSISTENT, "theory"),
        f"{SUBSTITUTE} Honest: NIS 8, lag-one autocorrelation 0, variance and honesty 1. nis_settled: mean over k >= 30; "
        "nis_window: k = 80..149; 95 % intervals over the runs, or from chi-square where only the mean over the runs is kept. "
        "lag1, variance: innovations, k >= 30; honesty: rms error over the filter's own deviation, mean over k = 100..149.",
    ),
    make(
        "extra-scale-factors", "Scale factors with and without the fault", scale_factors,
        (
            keys("filter", "branch", "channel"), numbers(*(f"{c}{end}" for c in ("fault", "healthy") for end in ("", "_low", "_high"))),
            numbers("fault_theory", "healthy_theory", kind="optional"), counts("n", "failed"),
        ),
        ADAPTING,
        f"{SUBSTITUTE} Mean over k = 100..149 and the runs with its 95 % interval. Theory, for the AMDKF: 1 + (m^2 - 1) R_v / R "
        "with a fault of multiplier m; without a fault 1 + 0.564 (Sigma / R) / sqrt(M), what max(1, .) makes of the scatter of "
        "M innovations. Both take (18) as true.",
    ),
    make(
        "extra-sweeps", "Ratios when one quantity changes", sweeps,
        (
            keys("branch", "sweep", "setting", "pair", "state"), numbers("value", relative=0.0), numbers("ratio", "ci_low", "ci_high"),
            counts("n", "failed"),
        ),
        tuple(f"sweep-{branch}" for branch in BRANCHES),
        f"{SUBSTITUTE} Fault on; all else as in the baseline. Geometric mean of paired RMSE ratios with its 95 % interval over "
        "the surviving runs. The scored steps are those of the fault; steps and per-step noise stay when dt changes. sigma-v, "
        "sigma-w: factors. Ablations: the filter named in the setting stands for the AMDKF.",
        "sweep_runs",
    ),
    make(
        "extra-specification", "Ratios over random parameter sets", specification,
        (keys("branch", "pair", "state"), numbers(*SHARES), numbers("q10", "q50", "q90"), counts("n", "failed")),
        tuple(f"specification-{branch}" for branch in BRANCHES),
        f"{SUBSTITUTE} Fault on. Share of the parameter sets whose mean ratio is below 1, below 0.95, above 1.05, with Wilson's "
        "95 % interval; 10, 50 and 90 % quantiles of the sets' mean ratios. failed: sets without a surviving run. AKF/MDKF "
        "compares delayed estimates.",
        "specification_sets",
    ),
    make(
        "extra-specification-patterns", "Signs of Table 1 over random parameter sets", specification_patterns,
        (keys("branch", "pair", "pattern"), numbers("share", "share_low", "share_high"), counts("sets", "n", "failed")),
        tuple(f"specification-{branch}" for branch in BRANCHES),
        f"{SUBSTITUTE} Fault on. Share of the parameter sets whose mean ratios have the signs, with Wilson's 95 % interval.",
        "specification_sets",
    ),
)  # fmt: skip
"""Tables of the study, in the order of the report."""
