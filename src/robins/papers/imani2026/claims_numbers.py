"""Claims C1 to C3, the only ones with published numbers: by how much the MKMC-EKF's RMSE is below the CI-RKF's.

The paper prints a range for velocity, whose ends are judged apart, and one largest number each for acceleration and rate. Which
channel has which number is in Table 5, whose cells were not available; so the lower end is asked of every channel, the upper one
of the largest.
"""

from collections.abc import Iterable, Sequence

import numpy as np

from robins.evaluate.ledger import Row
from robins.papers.imani2026.comparisons import GROUPS
from robins.papers.imani2026.judging import (
    HEADLINE,
    NAMES,
    OTHERS,
    Case,
    Cell,
    cells_of,
    combine_many,
    improvement_row,
    percent,
    printed_end,
    sweep_cases,
    without_interval,
)
from robins.papers.protocol import Results

QUANTITY = "RMSE improvement of MKMC-EKF over CI-RKF, "
INTERVAL = Case("F1, against the interval average", against="interval")
UNPUBLISHED = (
    "The paper prints neither its formulation's h and u, R, c0, c1, beta, kernels, rate, duration nor its initial errors, and one run: "
    "agreement in size is agreement with a possible configuration."
)


def largest(cells: Sequence[Cell]) -> Cell:
    """The cell with the largest improvement; a channel without a surviving run has none."""
    return max(cells, key=lambda cell: cell.found.estimate if np.isfinite(cell.found.estimate) else -np.inf)


def listing(cells: Iterable[Cell]) -> str:
    """``V_e 12.3 %, ...`` for a sentence."""
    return ", ".join(
        f"{NAMES[cell.channel]} {percent(cell.found.estimate) if np.isfinite(cell.found.estimate) else 'failed'}" for cell in cells
    )


def largest_row(results: Results, claim_id: str, quantity: str, case: Case, channels: Sequence[str], upper: float, condition: str) -> Row:
    """The largest of three channels against the upper end of the published range; `upper` in per cent."""
    cells = cells_of(results, case, channels, threshold=upper / 100)
    cell = largest(cells)
    note = f"The largest of {listing(cells)} is judged, without allowance for the choice. "
    return improvement_row(claim_id, quantity, condition, case, cell, note, published_high=upper)


def judge_velocity(results: Results) -> list[Row]:
    """C1: 37 % to over 99 % in velocity."""
    lower, upper = printed_end(results, "C1", "value"), printed_end(results, "C1", "value_high")
    quantity, rows, verdicts = f"{QUANTITY}velocity", [], {}
    for case in (HEADLINE, *OTHERS, *sweep_cases(results)):
        added = [
            improvement_row("C1", quantity, f"{case.words}, {NAMES[cell.channel]}, at least {lower:g} %", case, cell, published=lower)
            for cell in cells_of(results, case, GROUPS["velocity"], threshold=lower / 100)
        ]
        condition = f"{case.words}, largest, over {upper:g} %"
        added.append(largest_row(results, "C1", quantity, case, GROUPS["velocity"], upper, condition))
        if case is HEADLINE:
            verdicts = {row.condition.removeprefix(f"{case.words}, "): row.verdict for row in added}
        rows += added
    verdict, reason = combine_many(verdicts)
    reason = f"F1, tuned filters, against the truth, by channel for the lower end and for the largest: {reason} {UNPUBLISHED}"
    return [*rows, without_interval("C1", quantity, rows[0].n, HEADLINE.name, verdict, reason)]


def judge_largest(results: Results, claim_id: str, group: str) -> list[Row]:
    """C2, C3: up to 99 % in acceleration and in angular rate."""
    quantity, upper = f"{QUANTITY}{group}", printed_end(results, claim_id, "value_high")
    channels = GROUPS[group]
    rows = [
        improvement_row(claim_id, quantity, f"{HEADLINE.words}, {NAMES[cell.channel]}", HEADLINE, cell, published_high=upper)
        for cell in cells_of(results, HEADLINE, channels, threshold=upper / 100)
    ]
    for case in (HEADLINE, INTERVAL, *OTHERS, *sweep_cases(results)):
        rows.append(largest_row(results, claim_id, quantity, case, channels, upper, f"{case.words}, largest"))
    headline = rows[len(channels)]
    floor = f" {reference_floor(results)}" if group == "angular rate" else ""
    reason = f"F1, tuned filters, against the truth. {headline.reason} {UNPUBLISHED}{floor}"
    return [*rows, without_interval(claim_id, quantity, headline.n, HEADLINE.name, headline.verdict, reason)]


def reference_floor(results: Results) -> str:
    """What the reference's own error allows (proposition 8)."""
    table = results.table("theory").set_index("quantity")["value"]
    needed = table["RMSE needed for an improvement of 99 %, 0.1 deg of white noise"]
    own = table["RMSE needed for an improvement of 99 %, this study's reference, w_u"]
    return (
        f"The paper's true rates are differentiated reference angles: with 0.1 deg of white noise in these, an improvement of 99 % needs "
        f"a CI-RKF whose RMSE is {needed:.3g} rad/s or more; with this study's reference, {own:.3g} rad/s."
    )
