"""Tables of errors: Table 1 as the paper has it with ours beside, every filter, every ratio, the signs, and one step late."""

import numpy as np
import pandas as pd

from robins.evaluate.intervals import TIE, proportion_interval
from robins.navigation.aircraft import STATES
from robins.papers.columns import counts, ends, finite, keys, make, numbers, texts
from robins.papers.hajiyev2023.comparisons import (
    ADAPTED,
    AMDKF,
    MDKF,
    Pair,
    cases,
    kinds,
    labelled,
    published_rmse,
    ratio,
    scores,
    unit,
)
from robins.papers.hajiyev2023.scenario import BRANCHES
from robins.papers.hajiyev2023.table_parts import SUBSTITUTE, level, median, patterns, survivors
from robins.papers.hajiyev2023.variants import VARIANTS
from robins.papers.protocol import Results, Table

LAGGED = {MDKF: "mdkf-lagged", AMDKF: "amdkf-lagged"}
FILTERS = tuple(name for name in VARIANTS if name not in LAGGED.values())
LEVELS = ("mean", "low", "high", "p5", "p95")

PAIRS = (
    ADAPTED,
    Pair("amdkf-gated", MDKF),
    Pair("amdkf-scalar-trace", MDKF),
    Pair("amdkf-scalar-mean", MDKF),
    Pair("abh", "bh"),
    Pair("abh", "bh", "filtered"),
    Pair("aakf", "akf"),
    Pair("aakf", "akf", "filtered"),
    Pair("oracle", "akf"),
    Pair("oracle", "akf", "filtered"),
    Pair("akf", MDKF),
    Pair("akf", MDKF, "filtered"),
    Pair("bh", MDKF),
    Pair("bh", MDKF, "filtered"),
    Pair("abh", AMDKF),
    Pair("aakf", AMDKF),
    Pair(MDKF, "ckf"),
    Pair(MDKF, "ckf-inflated"),
    Pair(AMDKF, "ckf"),
    Pair(AMDKF, "ckf-inflated"),
)
"""Every paired ratio of `extra-ratios`."""

PATTERN_PAIRS = (ADAPTED, Pair("abh", "bh"), Pair("aakf", "akf"))


def table_1(results: Results) -> pd.DataFrame:
    """Table 1: published beside ours, state by state and branch by branch."""
    rows = []
    for branch in BRANCHES:
        found = {kind: scores(results, name, branch, "fault") for kind, name in (("mdkf", MDKF), ("amdkf", AMDKF))}
        kept = survivors(found.values())
        for i, state in enumerate(STATES):
            row = {"state": state, "branch": branch, "unit": unit(state, branch)}
            row |= {f"published_{kind}": published_rmse(results, state, kind.upper()) for kind in found}
            for kind, score in found.items():
                values = labelled(score.rmse[:, i], state, branch)
                row |= {f"{kind}_{name}": value for name, value in level(values[kept]).items()}
                row[f"{kind}_median"] = median(values, score.failed)
            row["misfit"] = row["mdkf_mean"] if isinstance(row["mdkf_mean"], str) else row["mdkf_mean"] / row["published_mdkf"]
            rows.append(row | {"n": len(kept)} | {f"{kind}_failed": int(score.failed.sum()) for kind, score in found.items()})
    return pd.DataFrame(rows)


def filters(results: Results) -> pd.DataFrame:
    """RMSE of every filter; the runs that survive in all of them."""
    rows = []
    for branch, condition in cases():
        found = {(name, kind): scores(results, name, branch, condition, kind) for name in FILTERS for kind in kinds(results, name)}
        kept = survivors(found.values())
        for (name, kind), score in found.items():
            for i, state in enumerate(STATES):
                values = labelled(score.rmse[:, i], state, branch)
                mean = {key: value for key, value in level(values[kept]).items() if key in LEVELS[:3]}
                rows.append({
                    "branch": branch, "condition": condition, "filter": name, "estimate": kind, "state": state, "unit": unit(state, branch),
                    **mean, "median": median(values, score.failed), "n": len(kept), "failed": int(score.failed.sum()),
                })  # fmt: skip
    return pd.DataFrame(rows)


def ratios(results: Results) -> pd.DataFrame:
    """Every paired ratio with both intervals."""
    rows = []
    for pair in PAIRS:
        for branch, condition in cases():
            for state in STATES:
                found = ratio(results, pair, branch, condition, state)
                share = found.share_below_one
                rows.append({
                    "numerator": pair.numerator, "numerator_estimate": pair.kinds[0],
                    "denominator": pair.denominator, "denominator_estimate": pair.kinds[1],
                    "branch": branch, "condition": condition, "state": state,
                    "ratio": finite(found.estimate), **ends("ci", found.low, found.high), **ends("bca", found.bca_low, found.bca_high),
                    "share_below_1": share.estimate, "share_low": share.low, "share_high": share.high,
                    **ends("central", found.central_low, found.central_high), "median": finite(found.median),
                    "n": found.n, "numerator_failed": found.numerator_failed, "denominator_failed": found.denominator_failed,
                })  # fmt: skip
    return pd.DataFrame(rows)


def signs(results: Results, pair: Pair, branch: str, condition: str) -> np.ndarray:
    """-1 where the numerator's filter is better, 1 where it is worse, else 0; shape (runs, 8). A failed run is worse."""
    above, below = (scores(results, name, branch, condition, kind) for name, kind in zip(pair.needs, pair.kinds, strict=True))
    logs = np.log(np.where(above.failed[:, None], 1.0, above.rmse)) - np.log(np.where(below.failed[:, None], 1.0, below.rmse))
    found = np.where(np.abs(logs) < TIE, 0.0, np.sign(logs))
    lost = above.failed.astype(float) - below.failed
    return np.where((above.failed | below.failed)[:, None], lost[:, None], found)


def sign_patterns(results: Results) -> pd.DataFrame:
    """Shares of the runs that show the signs of Table 1."""
    rows = []
    for pair in PATTERN_PAIRS:
        for branch, condition in cases():
            for name, shown in patterns(signs(results, pair, branch, condition)).items():
                share = proportion_interval(int(shown.sum()), len(shown))
                rows.append((pair.name, branch, condition, name, share.estimate, share.low, share.high, int(shown.sum()), share.n))
    return pd.DataFrame(rows, columns=["pair", "branch", "condition", "pattern", "share", "share_low", "share_high", "runs", "n"])


def lagged(results: Results) -> pd.DataFrame:
    """Could the authors' program have been one step late? Its RMSE beside the printed filter's and the published one."""
    rows = []
    for name, late in LAGGED.items():
        kind = "MDKF" if name == MDKF else "AMDKF"
        for branch in BRANCHES:
            found = scores(results, name, branch, "fault"), scores(results, late, branch, "fault", "filtered")
            kept = survivors(found)
            for i, state in enumerate(STATES):
                printed = published_rmse(results, state, kind)
                row = {"filter": kind, "branch": branch, "state": state, "unit": unit(state, branch), "published": printed}
                for words, score in zip(("on_time", "late"), found, strict=True):
                    values = labelled(score.rmse[:, i], state, branch)
                    numbers = level(values[kept])
                    row |= {f"{words}_{key}": numbers[key] for key in LEVELS[:3]}
                    row[f"{words}_over_published"] = numbers["mean"] if isinstance(numbers["mean"], str) else numbers["mean"] / printed
                row["nearer"] = nearer(row["on_time_over_published"], row["late_over_published"])
                rows.append(row | {"n": len(kept), "failed": int((~kept).sum())})
    return pd.DataFrame(rows)


def nearer(on_time: float | str, late: float | str) -> str:
    """Which of two factors is nearer to 1 on a logarithmic scale."""
    if isinstance(on_time, str) or isinstance(late, str):
        return "neither"
    return "late" if abs(np.log(late)) < abs(np.log(on_time)) else "on time"


ERROR_TABLES: tuple[Table, ...] = (
    make(
        "table-1", "RMSE of the state estimates with the fault: published and ours", table_1,
        (
            keys("state", "branch"), texts("unit"), numbers("published_mdkf", "published_amdkf", relative=0.0),
            *(numbers(*(f"{kind}_{name}" for name in (*LEVELS, "median"))) for kind in ("mdkf", "amdkf")),
            numbers("misfit"), counts("n", "mdkf_failed", "amdkf_failed"),
        ),
        (MDKF, AMDKF),
        f"{SUBSTITUTE} Published: one run. Ours: mean with its 95 % interval, 5 % and 95 % quantiles over the runs that survive "
        "in both filters; the median counts a failed run as infinite. Each branch reads the published angles in its own unit. "
        "misfit: our mean over the published MDKF. Levels are calibrated on the MDKF column, which no set of parameters fits "
        "jointly; they are untestable. RMSE by equation (29): 71 squares over 70.",
        location="Table 1",
    ),
    make(
        "extra-filters", "RMSE of every filter", filters,
        (
            keys("branch", "condition", "filter", "estimate", "state"), texts("unit"), numbers("mean", "low", "high", "median"),
            counts("n", "failed"),
        ),
        FILTERS,
        f"{SUBSTITUTE} Mean with its 95 % interval over the runs that survive in every filter; the median over all runs counts a"
        " failed run as infinite. filtered: x(k) from z(0..k); delayed: from z(0..k+1), the only estimate that the printed "
        "filters have. RMSE by equation (29).",
    ),
    make(
        "extra-ratios", "Paired error ratios", ratios,
        (
            keys("numerator", "numerator_estimate", "denominator", "denominator_estimate", "branch", "condition", "state"),
            numbers("ratio", "ci_low", "ci_high", "bca_low", "bca_high", "share_below_1", "share_low", "share_high"),
            numbers("central_low", "central_high", "median"), counts("n", "numerator_failed", "denominator_failed"),
        ),
        FILTERS,
        f"{SUBSTITUTE} Geometric mean of the runs' RMSE ratios with its 95 % interval, normal on the logarithm and by BCa "
        "bootstrap; share of the runs below 1 with Wilson's interval; central 95 % of single runs. Both filters see the same "
        "noise. Rows that compare a filtered with a delayed estimate favour the delayed one.",
    ),
    make(
        "extra-sign-patterns", "How often a run shows the signs of Table 1", sign_patterns,
        (keys("pair", "branch", "condition", "pattern"), numbers("share", "share_low", "share_high"), counts("runs", "n")),
        dict.fromkeys(name for pair in PATTERN_PAIRS for name in pair.needs),
        f"{SUBSTITUTE} Delayed estimates. Share of the runs with Wilson's 95 % interval.",
    ),
    make(
        "extra-lagged", "RMSE if the measurement were processed one step late", lagged,
        (
            keys("filter", "branch", "state"), texts("unit"), numbers("published", relative=0.0),
            *(numbers(*(f"{words}_{name}" for name in LEVELS[:3]), f"{words}_over_published") for words in ("on_time", "late")),
            texts("nearer", kind="prose"), counts("n", "failed"),
        ),
        (*LAGGED, *LAGGED.values()),
        f"{SUBSTITUTE} A diagnostic (A2 of the register): mu(k-1) taken as a measurement of x(k). Means over the runs that survive in "
        "both; nearer: which mean is nearer to the published number in proportion. Never a main result.",
    ),
)  # fmt: skip
"""Tables of errors, in the order of the report."""
