"""The qualitative claims about all channels: Euler angles (C4), every domain (C7), final drift (C8), mean error (C9)."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from robins.evaluate.ledger import FAILED, Row
from robins.evaluate.verdicts import Verdict
from robins.papers.imani2026.comparisons import GROUPS, PAIR, Level, level
from robins.papers.imani2026.drive import CHANNELS
from robins.papers.imani2026.judging import (
    HEADLINE,
    MINIMUM,
    NAMES,
    OTHERS,
    Case,
    cells_of,
    cells_row,
    combine_many,
    improvement_row,
    sweep_cases,
    tally,
    without_interval,
)
from robins.papers.protocol import Results

REFERENCE = Case("F1, against the reference", against="reference")
ALL_METRICS = ("rmse", "mean", "drift")
"""RMSE, mean error and final drift: the measures of the paper's Table 5."""
ACCURACY = ("rmse", "sd")
"""Accuracy and stability, as the paper's figures are read."""
ANGLES, VELOCITY = GROUPS["Euler angles"], GROUPS["velocity"]

ANGLE_STATEMENTS: Mapping[str, tuple] = {
    "Euler angles (Fig. 7d): smoother and closer to the reference": (REFERENCE, ANGLES, ACCURACY),
    "roll: CI-RKF diverges slowly; drift lower with MKMC-EKF": (HEADLINE, ("roll",), ("drift",)),
    "pitch: final drift dramatically reduced": (HEADLINE, ("pitch",), ("drift",)),
    "yaw: RMSE and mean error lower": (HEADLINE, ("yaw",), ("rmse", "mean")),
}
"""The paper's sentences on Euler angles: condition, channels and metrics that they are about."""
DOMAIN_STATEMENTS: Mapping[str, tuple] = {
    "MKMC-EKF outperforms CI-RKF in accuracy and stability": (HEADLINE, CHANNELS, ACCURACY),
    "velocity: MKMC-EKF superior in all components": (HEADLINE, VELOCITY, ALL_METRICS),
    "velocity (Fig. 7a): accuracy and stability": (HEADLINE, VELOCITY, ACCURACY),
    "acceleration (Fig. 7b): vertical axis, CI-RKF oscillates": (HEADLINE, ("a_u",), ("sd",)),
    "angular rate (Fig. 7c): superior accuracy and robustness": (HEADLINE, GROUPS["angular rate"], ACCURACY),
    "acceleration RMSE reduction significant on all axes": (HEADLINE, GROUPS["acceleration"], ("rmse",)),
    "angular rate RMSE and mean reduced on all axes": (HEADLINE, GROUPS["angular rate"], ("rmse", "mean")),
}
"""The same for the domains."""
MEAN_STATEMENTS: Mapping[str, tuple] = {
    "mean error V_u dramatically reduced": ("v_u",),
    "velocity mean error smaller: bias mitigation": VELOCITY,
    "mean error a_u near zero": ("a_u",),
    "mean error omega_e substantially lower": ("w_e",),
    "roll: most notable change in mean error": ("roll",),
}
"""Channels of the paper's sentences on mean errors."""
DRIFT_STATEMENTS: Mapping[str, str] = {
    "v_e": "final drift V_e: CI-RKF high, MKMC-EKF negligible",
    "v_n": "final drift V_n near-complete suppression",
    "v_u": "final drift V_u very low",
    "a_e": "final drift a_e almost negligible",
    "a_n": "final drift a_n dramatically reduced",
    "a_u": "final drift a_u very low",
    "w_e": "final drift omega_e remarkably low",
    "w_n": "final drift omega_n extremely small",
    "w_u": "final drift omega_u almost zero",
    "roll": "final drift of roll near zero",
    "pitch": "final drift of pitch near zero",
    "yaw": "final drift of yaw near zero",
}
"""The paper's sentences on final drift by channel; on the angles one at a time it has none."""
UNITS = {"velocity": "m/s", "acceleration": "m/s^2", "angular rate": "rad/s", "Euler angles": "rad"}
ONE_RUN = (
    "The paper has one run, whose final error is one draw: of two equally good filters one shows an improvement above 90 % in some of "
    "24 cells of mean error and drift with probability 0.79 (proposition 9)."
)


def judge_angles(results: Results) -> list[Row]:
    """C4: RMSE, mean error and final drift of all Euler angles lower, nine cells."""
    quantity, best = "Euler angles: final drift, RMSE, mean all reduced", Verdict.DIRECTION_ONLY
    rows = [
        cells_row("C4", words, case, cells_of(results, case, channels, metrics, best=best), condition=f"{case.words}, as stated")
        for words, (case, channels, metrics) in ANGLE_STATEMENTS.items()
    ]
    cells = cells_of(results, HEADLINE, ANGLES, ALL_METRICS, best=best)
    rows += [improvement_row("C4", quantity, f"{HEADLINE.words}, {cell.name}", HEADLINE, cell) for cell in cells]
    for case in (*OTHERS, *sweep_cases(results)):
        rows.append(cells_row("C4", quantity, case, cells_of(results, case, ANGLES, ALL_METRICS, best=best)))
    together = cells_row("C4", quantity, HEADLINE, cells)
    reason = f"F1, tuned filters, against the truth; all nine cells have to improve. {together.reason}"
    return [*rows, without_interval("C4", quantity, together.n, HEADLINE.name, together.verdict, reason)]


def judge_domains(results: Results) -> list[Row]:
    """C7: the MKMC-EKF better in all twelve channels, by RMSE, mean error and final drift."""
    quantity = "MKMC-EKF better than CI-RKF in all domains"
    rows = [
        cells_row("C7", words, case, cells_of(results, case, channels, metrics), condition=f"{case.words}, as stated")
        for words, (case, channels, metrics) in DOMAIN_STATEMENTS.items()
    ]
    rows.append(vertical_row(results))
    cells = cells_of(results, HEADLINE, CHANNELS, ALL_METRICS)
    rows += [improvement_row("C7", quantity, f"{HEADLINE.words}, {cell.name}", HEADLINE, cell) for cell in cells]
    for case in (*OTHERS, *sweep_cases(results)):
        rows.append(cells_row("C7", quantity, case, cells_of(results, case, CHANNELS, ALL_METRICS)))
    together = cells_row("C7", quantity, HEADLINE, cells)
    reason = f"F1, tuned filters, against the truth; all twelve channels have to improve in all three metrics. {together.reason}"
    return [*rows, without_interval("C7", quantity, together.n, HEADLINE.name, together.verdict, reason)]


def vertical_row(results: Results) -> Row:
    """Is the improvement of V_u larger than those of V_e and V_n?"""
    quantity, condition = "vertical velocity: gap between the filters larger than horizontally", f"{HEADLINE.words}, as stated"
    *level_cells, up = cells_of(results, HEADLINE, VELOCITY)
    n = up.found.n
    low, high = (max(getattr(cell.found, name) for cell in level_cells) for name in ("low", "high"))
    if n < MINIMUM["runs"]:
        verdict, reason = Verdict.TOO_SMALL, f"{n} runs; the rule asks for at least {MINIMUM['runs']}."
    elif up.found.low > high:
        verdict, reason = Verdict.REPLICATED, "The interval of V_u lies above those of V_e and V_n."
    elif up.found.high < low:
        verdict, reason = Verdict.NOT_REPLICATED, "The interval of V_u lies below that of V_e or V_n."
    else:
        verdict, reason = Verdict.INCONCLUSIVE, "The interval of V_u overlaps those of V_e or V_n."
    return improvement_row("C7", quantity, condition, HEADLINE, up._replace(verdict=verdict, reason=f"{reason} V_u: {up.reason}"))


def judge_means(results: Results) -> list[Row]:
    """C9: mean errors dramatically lower; how much is not printed, so no size is judged."""
    quantity, best = "mean error lower, all channels", Verdict.DIRECTION_ONLY
    rows = [
        cells_row("C9", words, HEADLINE, cells_of(results, HEADLINE, channels, ("mean",), best=best), condition="F1, as stated")
        for words, channels in MEAN_STATEMENTS.items()
    ]
    cells = cells_of(results, HEADLINE, CHANNELS, ("mean",), best=best)
    rows += [improvement_row("C9", quantity, f"{HEADLINE.words}, {NAMES[cell.channel]}", HEADLINE, cell) for cell in cells]
    for case in (*OTHERS, *sweep_cases(results)):
        rows.append(cells_row("C9", quantity, case, cells_of(results, case, CHANNELS, ("mean",), best=best)))
    verdict, found = combine_many({NAMES[cell.channel]: cell.verdict for cell in cells})
    reason = f"F1, tuned filters, against the truth, mean of the absolute mean error: {found} {tally(cells)} {ONE_RUN}"
    return [*rows, without_interval("C9", quantity, cells[0].found.n, HEADLINE.name, verdict, reason)]


class Drift(NamedTuple):
    """A filter's final error in one channel: does it lie beyond what its errors are throughout?

    A stationary error ends anywhere within its own standard deviation, an accumulated one beyond it. ``accumulates`` is ``yes``,
    ``no``, ``open`` (the interval contains the standard deviation) or ``failed``.
    """

    found: Level
    spread: float
    accumulates: str

    @property
    def text(self) -> str:
        """The numbers."""
        return f"{self.found.estimate:.3g} ({self.found.low:.3g} to {self.found.high:.3g}) against {self.spread:.3g}"


def drift_of(results: Results, variant: str, channel: str) -> Drift:
    """`Drift` of a variant in F1."""
    found = level(results, variant, "F1", "truth", "drift", channel)
    spread = level(results, variant, "F1", "truth", "sd", channel).estimate
    if not np.isfinite([spread, found.high]).all():
        return Drift(found, spread, "failed")
    return Drift(found, spread, "yes" if found.low > spread else "no" if found.high < spread else "open")


def drift_verdicts(own: Drift, other: Drift) -> tuple[Verdict, Verdict]:
    """Verdicts on "the MKMC-EKF's final error is negligible" and on "the CI-RKF's is high".

    Where neither accumulates, the smallness of the first says nothing of the filter.
    """
    if own.found.n < MINIMUM["runs"]:
        return Verdict.TOO_SMALL, Verdict.TOO_SMALL
    small = Verdict.COMPATIBLE if other.accumulates == "no" else Verdict.DIRECTION_ONLY
    words = {"yes": Verdict.NOT_REPLICATED, "no": small, "open": Verdict.INCONCLUSIVE, "failed": Verdict.NOT_REPLICATED}
    high = {"yes": Verdict.DIRECTION_ONLY, "no": Verdict.NOT_REPLICATED, "open": Verdict.INCONCLUSIVE, "failed": Verdict.NOT_REPLICATED}
    return words[own.accumulates], high[other.accumulates]


def drift_rows(results: Results, channel: str) -> list[Row]:
    """Final errors of both filters against their standard deviations."""
    unit = next(UNITS[group] for group, channels in GROUPS.items() if channel in channels)
    drifts = [drift_of(results, name, channel) for name in PAIR]
    statements = ("the MKMC-EKF's final error is negligible", "the CI-RKF's is high")
    rows = []
    for name, drift, verdict, words in zip(PAIR, drifts, drift_verdicts(*drifts), statements, strict=True):
        numbers = (FAILED, "", "") if drift.accumulates == "failed" else (drift.found.estimate, drift.found.low, drift.found.high)
        outcome = {"yes": "it accumulates", "no": "nothing accumulates", "open": "the interval contains the latter"}
        found = f"{drift.text}: {outcome[drift.accumulates]}" if drift.accumulates in outcome else "fewer than two runs survive"
        reason = f"Claimed: {words}. Mean absolute final error against the standard deviation along the run: {found}."
        if verdict == Verdict.COMPATIBLE:
            reason = f"{reason} Nothing accumulates in the CI-RKF either, so a small final error says nothing."
        rows.append(Row("C8", DRIFT_STATEMENTS[channel], f"F1, {name}", *numbers, drift.found.n, name, verdict, reason, unit=unit))
    return rows


def judge_drift(results: Results) -> list[Row]:
    """C8: final drift near zero with the MKMC-EKF in every channel."""
    rows = [row for channel in CHANNELS for row in drift_rows(results, channel)]
    verdicts = {NAMES[channel]: row.verdict for channel, row in zip(CHANNELS, rows[::2], strict=True)}
    reduced, best = "drift reduced in all Euler angles", Verdict.DIRECTION_ONLY
    for words, channels in ((reduced, ANGLES), ("velocity final drift reduced on all axes", VELOCITY)):
        rows.append(cells_row("C8", words, HEADLINE, cells_of(results, HEADLINE, channels, ("drift",), best=best)))
    quantity = "final drift near zero, all channels"
    for case in (HEADLINE, *OTHERS, *sweep_cases(results)):
        cells = cells_of(results, case, CHANNELS, ("drift",), best=best)
        rows.append(cells_row("C8", "final drift reduced, all channels", case, cells))
    rows.append(without_interval("C8", "final drift of the paper's run", 0, HEADLINE.name, Verdict.UNTESTABLE, ONE_RUN, "one run"))
    verdict, found = combine_many(verdicts)
    reason = (
        f"By channel: {found} Acceleration and rate of a car at rest are noise, in which nothing can accumulate; velocity is observed by "
        f"no filter without aiding, so none can bound its error (proposition 2). {ONE_RUN}"
    )
    return [*rows, without_interval("C8", quantity, rows[0].n, HEADLINE.name, verdict, reason)]
