"""The paper's Tables I to III: its words with our evidence, and its errors with ours beside."""

import numpy as np
import pandas as pd

from robins.evaluate.verdicts import Verdict
from robins.papers.columns import LINEAR, counts, keys, make, numbers, texts
from robins.papers.ghouneem2024.claims_settings import (
    frozen_setting,
    in_sample_setting,
    printed,
    printed_name,
    printed_ratio,
    ratio_name,
)
from robins.papers.ghouneem2024.comparisons import Where, ratio_of, variant
from robins.papers.ghouneem2024.ensemble import FIRST_RUN
from robins.papers.ghouneem2024.filters import FILTERS
from robins.papers.ghouneem2024.judging import NAMES, together
from robins.papers.ghouneem2024.runs import CHANNELS
from robins.papers.ghouneem2024.studies import DATA_SHEET, FIRST_SIDE_RUN
from robins.papers.ghouneem2024.table_parts import (
    FILTER_WORDS,
    MEAN,
    RATIO,
    RUNS,
    interval_names,
    largest_difference,
    mean_cells,
    percent,
    ratio_cells,
    tally,
    unit_of,
)
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.tune import SETTINGS
from robins.papers.ghouneem2024.variants import BASELINES, CONTROL, NEW
from robins.papers.protocol import Results, Table

UKF = "ukf"
EKFS = {"ekf_pm": BASELINES[1], "ekf_pi": BASELINES[0], "ekf_f": CONTROL}
"""Columns of Tables II and III, and the variants that they show."""


def on_both(words) -> str:
    """``words(place)`` for each trajectory, for a sentence."""
    return ", ".join(f"{words(place)} ({place.upper()})" for place in TRAJECTORIES)


def horizontal(results: Results, above: Where, below: Where) -> str:
    """A ratio of horizontal errors for a sentence."""
    return f"{ratio_of(results, above, below, 'horizontal').estimate:.4g}"


def state_evidence(results: Results) -> tuple[str, int]:
    """Error state or whole state: what changes with the model, the filter being an EKF all along."""
    found = [
        on_both(lambda place, name=name: horizontal(results, variant(CONTROL, place), variant(name, place))) + f" times that of {name}"
        for name in BASELINES
    ]
    words = f"A choice of model, not of filter: ekf-f is an EKF on the whole state. Its horizontal error is {' and '.join(found)}."
    return words, results.settings.sizes["runs"]


def transform_evidence(results: Results) -> tuple[str, int]:
    """What the unscented transform adds where the model is the same."""
    ratio = on_both(lambda place: horizontal(results, variant(UKF, place), variant(CONTROL, place)))
    most = on_both(lambda place: largest_difference(results, variant(UKF, place), variant(CONTROL, place), ("horizontal",)) + " %")
    words = f"With the same model the UKF's horizontal error is {ratio} times that of ekf-f; the largest difference in a run is {most}."
    return words, results.settings.sizes["runs"]


def cost_evidence(results: Results) -> tuple[str, int]:
    """Run times from the committed record."""
    found = results.table("cost")
    if found.empty:
        return "No benchmark record is at hand.", 0
    row = found.iloc[0]
    words = f"A step of the UKF takes {row['ratio']:.4g} times as long ({row['least']:.4g} to {row['greatest']:.4g} in single rounds)."
    return words, int(row["rounds"])


def tuning_evidence(results: Results) -> tuple[str, int]:
    """What the additional parameters do."""
    table = results.table("unscented")
    alone = table[(table["weights"] == "corrected") & table["redrawn"]].pivot(
        index=["trajectory", "run"], columns="alpha", values="horizontal"
    )
    spread = percent(np.nanmax(alone.max(axis=1) / alone.min(axis=1) - 1.0))
    printed_ones = table[table["weights"] == "printed"].groupby("alpha")["failed"].agg(["sum", "size"])
    failing = ", ".join(f"{row['sum']} of {row['size']} at {alpha:g}" for alpha, row in printed_ones.iterrows())
    words = (
        f"One budget of {len(SETTINGS)} settings of Q and gate for every filter. alpha from {alone.columns.min():g} to "
        f"{alone.columns.max():g} changes a run's horizontal error by at most {spread} %; with W0c as printed runs fail by alpha: "
        f"{failing}."
    )
    return words, len(alone)


def convergence_evidence(results: Results) -> tuple[str, int]:
    """How many runs settle from a wrong azimuth, by filter."""
    table = results.table("initialisation")
    table = table[(table["alpha"] == results.settings.options["alpha"]) & (table["prior"] == DATA_SHEET)]
    found = []
    for name in FILTERS:
        own = table[table["filter"] == name]
        settled = int((np.isfinite(own["settled"]) & ~own["failed"]).sum())
        found.append(f"{name} {settled} of {len(own)}")
    largest = np.degrees(table["azimuth_error"].max())
    words = f"Clean fixes, first azimuth wrong by 0 to {largest:.0f} deg, P0 of the data sheet: runs that settle within 5 deg: "
    return words + ", ".join(found) + ".", table["run"].nunique()


FEATURES = (
    ("navigation state", "error of the navigation state", "whole navigation state", state_evidence),
    ("nonlinear RISS", "linearised to first order, which costs accuracy", "kept nonlinear, for accuracy", transform_evidence),
    ("computation", "simple", "complex", cost_evidence),
    ("tuning", "error covariances, which decide the performance", "error covariances, and what places the sigma points", tuning_evidence),
    ("convergence", "may diverge by linearising", "helped by sigma points", convergence_evidence),
)  # fmt: skip
"""Rows of Table I in our own words, and the evidence for each."""


def table_1(results: Results) -> pd.DataFrame:
    """Table I: what the paper says of both filters, and what was found."""
    made = []
    for feature, ekf, ukf, evidence in FEATURES:
        words, n = evidence(results)
        made.append({"feature": feature, "ekf": ekf, "ukf": ukf, "evidence": words, "n": n})
    return pd.DataFrame(made)


def verdict(results: Results, place: str, channel: str) -> tuple[str, str]:
    """Claim of a channel and the headline's verdict on its ratio against both readings of the EKF, from the ledger."""
    quantity = results.published["quantity"] == printed_name(place, channel, "EKF")
    claim_id = results.published.loc[quantity, "claim_id"].iloc[0].split(";")[-1]
    ledger = results.ledger
    own = (ledger["claim_id"] == claim_id) & (ledger["quantity"] == ratio_name(place, channel))
    found = ledger.loc[own & (ledger["condition"] == frozen_setting(place).words), "verdict"]
    return claim_id, str(together(Verdict(word) for word in found))


def errors_table(results: Results, place: str) -> pd.DataFrame:
    """Table II or III: published errors and ratios with ours."""
    headline, in_sample = frozen_setting(place), in_sample_setting(place)
    made = []
    for channel in CHANNELS:
        claim_id, word = verdict(results, place, channel)
        row = {"channel": NAMES[channel], "unit": unit_of(channel)}
        row |= {f"published_{name}": printed(results, place, channel, kind) for name, kind in (("ekf", "EKF"), ("new", "New-Algorithm"))}
        row["published_ratio"] = printed_ratio(results, place, channel)
        shown = {name: headline.baseline(variant_of) for name, variant_of in EKFS.items()}
        shown |= {"new": headline.new, "in_sample": in_sample.new}
        for name, at in shown.items():
            row |= mean_cells(results, name, at, channel)
        for name in ("ekf_pi", "ekf_pm"):
            row |= ratio_cells(headline.compare(results, EKFS[name], channel), f"ratio_{name}")
        own = tally(results, headline.new)
        row |= {"n": own["n"], "in_sample_n": tally(results, in_sample.new)["n"]}
        row |= {f"{name}_failed": tally(results, at)["failed"] for name, at in shown.items()}
        made.append(row | {"claim": claim_id, "verdict": word})
    return pd.DataFrame(made)


def table_2(results: Results) -> pd.DataFrame:
    """Table II: the first trajectory."""
    return errors_table(results, "t1")


def table_3(results: Results) -> pd.DataFrame:
    """Table III: the second trajectory."""
    return errors_table(results, "t2")


SHOWN = (*EKFS, "new", "in_sample")
ERROR_COLUMNS = (
    keys("channel"), texts("unit"), numbers("published_ekf", "published_new", "published_ratio", relative=LINEAR),
    numbers(*interval_names(*SHOWN, "ratio_ekf_pi", "ratio_ekf_pm")), counts("n", "in_sample_n", *(f"{name}_failed" for name in SHOWN)),
    texts("claim"), texts("verdict", kind="prose"),
)  # fmt: skip
ERROR_NEEDS = (NEW, *EKFS.values(), "in-sample", "claims")
ERROR_CAPTION = (
    "RMSE over the whole drive at 20 Hz, azimuth wrapped; the paper's second row Longitude is read as altitude (E17). Published levels "
    "need the paper's data and cannot be tested; the environment was chosen so that one EKF has about the published error (D1). "
    f"{FILTER_WORDS} EKFs: data sheet's variances, no gate. new: ukf-st-gate, T1-frozen, out of sample. in_sample: every run tuned with "
    f"its own truth, fewer runs. {MEAN}. ratio: new over ekf-pi and over ekf-pm. {RATIO} verdict: of the claim's ratio against both "
    f"EKFs, from the claim ledger. {RUNS}"
)

PUBLISHED_TABLES: tuple[Table, ...] = (
    make(
        "table-1", "EKF and UKF for RISS, with our evidence", table_1,
        (keys("feature"), texts("ekf", "ukf"), texts("evidence", kind="prose"), counts("n")),
        (UKF, *EKFS.values(), "cost", "unscented", "initialisation"),
        "ekf, ukf: what the paper's Table I says, in our words. evidence: what was found; ratios are paired geometric means. Rows with a "
        f"state or a model: runs {FIRST_RUN} to {FIRST_RUN - 1} + n on each trajectory; tuning counts runs of both trajectories and "
        f"convergence has n runs on each of them, from {FIRST_SIDE_RUN} on; computation: n rounds of a committed benchmark. {FILTER_WORDS}",
        location="Table I",
    ),
    make("table-2", "RMSE on trajectory 1", table_2, ERROR_COLUMNS, ERROR_NEEDS, ERROR_CAPTION, location="Table II"),
    make("table-3", "RMSE on trajectory 2", table_3, ERROR_COLUMNS, ERROR_NEEDS, ERROR_CAPTION, location="Table III"),
)  # fmt: skip
"""Tables I to III."""
