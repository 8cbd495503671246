"""What the example publishes: its table, its figure, and the rules that judge its claims."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure as Drawing

from robins.evaluate.intervals import mean_interval, paired_ratio
from robins.evaluate.ledger import FAILED, OVERALL, Row
from robins.evaluate.published import published_value
from robins.evaluate.verdicts import Verdict, ratio_rule
from robins.foundation.randomness import stream
from robins.papers.protocol import Column, Results
from robins.publish import style
from robins_example.scenario import KEY, Parameters

NAMES = ("ekf", "inflated", "cauchy")
FAMILIES = dict(zip(NAMES, ("classical", "inflated", "huber"), strict=True))
MINIMUM = 20
"""Runs below which no verdict is given."""

COLUMNS = (
    Column("filter", "key"),
    *(Column(name, "number", "m", relative=1e-6) for name in ("rmse", "rmse_low", "rmse_high")),
    Column("n", "count"),
    Column("failed", "count"),
)


def errors_table(results: Results) -> pd.DataFrame:
    """Mean RMSE of every filter with its interval, over the runs that survive in all filters."""
    failed = np.array([results.table(name)["failed"] for name in NAMES])
    survived = ~failed.any(axis=0)
    rows = []
    for name, lost in zip(NAMES, failed, strict=True):
        mean = mean_interval(results.table(name)["rmse"][survived])[:3] if survived.sum() > 1 else (FAILED,) * 3
        rows.append((name, *mean, int(survived.sum()), int(lost.sum())))
    return pd.DataFrame(rows, columns=[column.name for column in COLUMNS])


def draw_errors(results: Results) -> Drawing:
    """RMS error of the position over time."""
    drawing = Drawing()
    axes = drawing.add_subplot(xlabel="time (s)", ylabel="RMS error of the position (m)", yscale="log")
    for name in NAMES:
        error = results.arrays(name).get("rms_error", np.array([]))
        axes.plot(np.arange(len(error)) * Parameters().dt, error, label=name, **style.family(FAMILIES[name]), markevery=20)
    axes.legend()
    return drawing


def judge_ratio(results: Results, claim_id: str, other: str) -> list[Row]:
    """Is the Cauchy filter better than the `other`, and by as much as the paper says? Failed runs count as losses."""
    cauchy, reference = results.table("cauchy"), results.table(other)
    generator = stream(results.settings.seed, f"{KEY}/bootstrap/0/{other}")
    bootstrap = results.settings.sizes["bootstrap"]
    summary = paired_ratio(cauchy["rmse"], reference["rmse"], generator, bootstrap, cauchy["failed"], reference["failed"])
    quantity = f"RMSE cauchy / {other}"
    verdict, reason = ratio_rule(summary, "better", published_value(results.published, claim_id, quantity), MINIMUM)
    interval = summary.verdict_low, summary.verdict_high
    return [Row(claim_id, quantity, OVERALL, summary.estimate, *interval, summary.n, "cauchy", verdict, reason)]


def judge_real_time(results: Results) -> list[Row]:
    """A claim that nobody can test is answered all the same, with what is missing."""
    reason = "The paper does not say which computer the vehicle carries."
    return [Row("C3", "run time", OVERALL, "", "", "", 0, "cauchy", Verdict.UNTESTABLE, reason)]
