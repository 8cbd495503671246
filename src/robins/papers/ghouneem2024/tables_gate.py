"""Tables of the gate: on average, by cause of the bad fixes, one bad fix, one long outage."""

import numpy as np
import pandas as pd

from robins.evaluate.intervals import TIE, proportion_interval
from robins.papers.columns import counts, keys, make, numbers, texts
from robins.papers.ghouneem2024.comparisons import Where, mean_of, rows, variant, where
from robins.papers.ghouneem2024.filters import FILTERS, JUMP_LIMITS, PREDICTION_LIMITS
from robins.papers.ghouneem2024.studies import JUMP_METRES, LONG_OUTAGE
from robins.papers.ghouneem2024.table_parts import (
    COMPARED,
    COMPARED_TALLY,
    MEAN,
    PLAIN,
    RATIO,
    RUNS,
    SIDE_RUNS,
    average_cells,
    compared,
    framed,
    gate_cells,
    interval_cells,
    interval_names,
    labels_of,
    mean_cells,
    multiple_words,
)
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.tune import frozen_setting, job_name
from robins.papers.ghouneem2024.variants import VARIANTS, variant_name
from robins.papers.protocol import Results, Table

GATED = {"gate": "none", "st-gate": "st"}
"""Cells of the factorial with the gate, and the same without it."""
PHYSICAL = "ekf-f-physical"
NIS_GATED = tuple(name for name, row in VARIANTS.items() if row.composition.get("gate", "").startswith("nis"))
MUCH_WORSE = 2.0


def much_worse(results: Results, above: Where, below: Where) -> float:
    """Share of the runs in which the first filter's horizontal error is more than twice the second's, a failure being a loss."""
    own, other = (np.where(found["failed"], np.inf, found["horizontal"]) for found in (rows(results, at) for at in (above, below)))
    return float(np.mean((own > MUCH_WORSE * other) & np.isfinite(other)))


def gate_row(results: Results, above: Where, below: Where) -> dict:
    """With the gate over without it."""
    row = compared(results, above, below)
    return row | {"twofold": much_worse(results, above, below)} | gate_cells(results, above)


def gates(results: Results) -> pd.DataFrame:
    """What the gate does to every filter on average."""
    made = []
    for place in TRAJECTORIES:
        for name in FILTERS:
            for cell, without in GATED.items():
                for frozen in TRAJECTORIES:
                    multiple = multiple_words(frozen_setting(results, name, frozen, cell).multiple)
                    pair = (variant(variant_name(name, kind), place, frozen) for kind in (cell, without))
                    labels = {"trajectory": place, "filter": variant_name(name, cell), "over": variant_name(name, without)}
                    made.append(labels | {"frozen": frozen, "multiple": multiple} | gate_row(results, *pair))
        for name in NIS_GATED:
            labels = {"trajectory": place, "filter": name, "over": PHYSICAL, "frozen": "none", "multiple": ""}
            made.append(labels | gate_row(results, variant(name, place), variant(PHYSICAL, place)))
    return framed(made)


def ungated(labels: dict) -> Where:
    """The same filter under the same cause without its gate."""
    gate = "integrity" if labels["gate"] == "integrity" else "none"
    return where("cause", **(labels | {"gate": gate, "multiple": np.inf}))


def is_best(results: Results, labels: dict, multiples: list[float]) -> str:
    """``best`` where no other multiple has a smaller geometric mean."""
    if labels["gate"] != "integrity":
        return ""
    means = {multiple: mean_of(results, where("cause", **(labels | {"multiple": multiple})), "horizontal") for multiple in multiples}
    logs = {multiple: np.log(found.estimate) for multiple, found in means.items() if np.isfinite(found.estimate)}
    return "best" if logs.get(labels["multiple"], np.inf) <= min(logs.values(), default=-np.inf) + TIE else ""


def causes(results: Results) -> pd.DataFrame:
    """The gate where only one thing goes wrong."""
    table = results.table("cause")
    multiples = sorted(table.loc[table["gate"] == "integrity", "multiple"].unique())
    made = []
    for labels in labels_of(table, ("trajectory", "cause", "filter", "gate", "multiple")):
        at = where("cause", **labels)
        row = labels | {"multiple": multiple_words(labels["multiple"]) if labels["gate"] == "integrity" else "none"}
        row |= mean_cells(results, "mean", at, "horizontal") | compared(results, at, ungated(labels))
        made.append(row | gate_cells(results, at) | {"best": is_best(results, labels, multiples)})
    return framed(made)


def jumps(results: Results) -> pd.DataFrame:
    """What becomes of one bad fix, of the good one after it, and of all others."""
    made = []
    for (name, multiple), found in results.table("jump").groupby(["filter", "multiple"], sort=False):
        row = {"filter": name, "multiple": multiple_words(multiple)}
        row |= {f"{what}_limit": multiple * limits[0] for what, limits in (("prediction", PREDICTION_LIMITS), ("jump", JUMP_LIMITS))}
        for what in ("rejected_jump", "rejected_next"):
            row |= interval_cells(what, proportion_interval(int(found[what].sum()), len(found)))
        made.append(row | average_cells("false_alarms", found["false_alarms"]) | {"n": len(found)})
    return framed(made)


def outages(results: Results) -> pd.DataFrame:
    """One long outage: the tightest gate and none."""
    made = []
    for labels in labels_of(results.table("long-outage"), ("trajectory", "filter", "multiple")):
        at, without = (where("long-outage", **found) for found in (labels, labels | {"multiple": np.inf}))
        row = labels | {"multiple": multiple_words(labels["multiple"])} | mean_cells(results, "mean", at, "horizontal")
        made.append(row | compared(results, at, without) | gate_cells(results, at))
    return framed(made)


GATE_WORDS = (
    "rejected: share of the fixes, mean over the surviving runs; longest_rejection: consecutive fixes, one a second, in the worst run."
)  # fmt: skip
GATE_COLUMNS = numbers("rejected", "longest_rejection")

GATE_TABLES: tuple[Table, ...] = (
    make(
        "extra-gate", "What the gate does on average", gates,
        (
            keys("trajectory", "filter", "over", "frozen"), texts("multiple"), numbers(*COMPARED, "twofold"), GATE_COLUMNS,
            counts(*COMPARED_TALLY),
        ),
        (*dict.fromkeys(name for name in VARIANTS if VARIANTS[name].family in (*FILTERS, "physical")), *map(job_name, FILTERS)),
        f"Horizontal error with the gate over that without. {RATIO} multiple: of the thresholds of (24), tuned on the trajectory frozen; "
        "with self-tuning each side has the scale that its own cell chose. "
        f"better: share of the runs that the gated filter wins; twofold: share in which it is more than {MUCH_WORSE:g} times worse. "
        f"{GATE_WORDS} {RUNS}",
    ),
    make(
        "extra-cause", "The gate by cause of the bad fixes", causes,
        (
            keys("trajectory", "cause", "filter", "gate", "multiple"), numbers(*interval_names("mean"), unit="m"), numbers(*COMPARED),
            GATE_COLUMNS, texts("best"), counts(*COMPARED_TALLY),
        ),
        ("cause",),
        "Only misleading fixes, only multipath or only outages of the environment. multiple: of the thresholds of (24). mean: horizontal "
        f"error. {MEAN}. ratio: to the same filter without gate. {RATIO} best: no other multiple has a smaller mean. {GATE_WORDS} Data "
        f"sheet's variances; physical: ekf-f with physical Q and NIS gate. {SIDE_RUNS}", "side_runs",
    ),
    make(
        "extra-jump", "One bad fix in a clean run", jumps,
        (
            keys("filter", "multiple"), numbers("prediction_limit", "jump_limit", unit="m"),
            numbers(*interval_names("rejected_jump", "rejected_next", "false_alarms")), counts("n"),
        ),
        ("jump",),
        f"One fix of T1 is {JUMP_METRES:g} m too far north, nothing else is wrong. Limits: thresholds of (24) along north. rejected_jump, "
        "rejected_next: share of the runs in which the bad fix and the good one after it are rejected, with Wilson's 95 % interval; "
        f"false_alarms: other fixes rejected, mean over runs with Student's 95 % interval. {PLAIN.split(',')[0]}. {SIDE_RUNS}",
        "side_runs",
    ),
    make(
        "extra-long-outage", "One long outage", outages,
        (
            keys("trajectory", "filter", "multiple"), numbers(*interval_names("mean"), unit="m"), numbers(*COMPARED), GATE_COLUMNS,
            counts(*COMPARED_TALLY),
        ),
        ("long-outage",),
        f"No fix for {LONG_OUTAGE[1]:g} s from {LONG_OUTAGE[0]:g} s on, nothing else is wrong. mean: horizontal error. {MEAN}. ratio: to "
        f"the same filter without gate. {RATIO} {GATE_WORDS} A gate that rejects all fixes after the outage is locked out. {SIDE_RUNS}",
        "side_runs",
    ),
)  # fmt: skip
"""Tables of the gate, in the order of the report."""
