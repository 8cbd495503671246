"""Claims about navigation as such: position (C12), and that the filter copes with 1 to 10 Hz (C13)."""

import numpy as np

from robins.evaluate.ensembles import Level
from robins.evaluate.intervals import mean_interval
from robins.evaluate.ledger import FAILED, Row
from robins.evaluate.published import rows_of
from robins.evaluate.verdicts import FAILURE_LIMIT, Verdict
from robins.papers.imani2026.comparisons import PAIR, sweep_level
from robins.papers.imani2026.drive import CHANNELS
from robins.papers.imani2026.judging import MINIMUM, Case, cells_of, cells_row, combine_many, majority, rate_sweep, without_interval
from robins.papers.imani2026.variants import VARIANTS
from robins.papers.protocol import Results

POSITIONS = {"position_final": "final position error", "position_rms": "RMS position error"}
TILTS = ("roll", "pitch")
CONTINUOUS = "filter gives continuous accurate reconstruction between samples"
CLOSED = "The drive ends 5 m from where it began, so that an estimate that never moves ends well; its RMS error shows it."
UNOBSERVABLE = "Position is observed by no filter without aiding (proposition 2), and the paper prints no position number."


def judge_position(results: Results) -> list[Row]:
    """C12: final and RMS position error of every filter; nothing to compare them with."""
    rows = [position_row(results, variant, what) for variant in VARIANTS for what in POSITIONS]
    for statement in rows_of(results.published, "C12")["quantity"]:
        rows.append(without_interval("C12", statement, 0, PAIR[0], Verdict.UNTESTABLE, UNOBSERVABLE, "as stated"))
    told = "; ".join(f"{words}: {listing(rows, words)}" for words in POSITIONS.values())
    reason = f"{UNOBSERVABLE} Means over the runs in F1, {told}. {CLOSED}"
    return [*rows, without_interval("C12", "position drift", rows[0].n, PAIR[0], Verdict.UNTESTABLE, reason)]


def listing(rows: list[Row], quantity: str) -> str:
    """The position errors of the filters that matter most, for a sentence."""
    told = {row.variant: row.ours for row in rows if row.quantity == quantity and row.variant in (*PAIR, "ekf-tuned", "no-update")}
    return ", ".join(f"{name} {value}" if isinstance(value, str) else f"{name} {value:.4g} m" for name, value in told.items())


def position_row(results: Results, variant: str, what: str) -> Row:
    """Mean over the surviving runs of the length of the position error, in F1."""
    arrays = results.arrays(variant)
    failed = arrays["F1.failed"].astype(bool)
    values = np.linalg.norm(arrays[f"F1.{what}"][~failed], axis=1)
    numbers: tuple = (FAILED, "", "")
    if len(values) > 1:
        numbers = tuple(float(value) for value in mean_interval(values)[:3])
    reason = f"{UNOBSERVABLE} Over {len(values)} surviving of {len(failed)} runs."
    return Row("C12", POSITIONS[what], "F1", *numbers, len(failed), variant, Verdict.UNTESTABLE, reason, unit="m")


def true_tilts(results: Results) -> dict[str, float]:
    """RMS of the car's own roll and pitch [rad]: the error of one who takes the car for level."""
    truth = results.arrays("drive")["truth"][1:]
    return {channel: float(np.sqrt(np.mean(truth[:, CHANNELS.index(channel)] ** 2))) for channel in TILTS}


def bound_rule(found: Level, bound: float, minimum: int) -> tuple[Verdict, str]:
    """Is the attitude error finite and bounded: in (nearly) every run, and below the error of taking the car for level?"""
    if found.n < minimum:
        return Verdict.TOO_SMALL, f"{found.n} runs; the rule asks for at least {minimum}."
    if found.failed > FAILURE_LIMIT * found.n:
        return Verdict.NOT_REPLICATED, f"The filter failed in {found.failed} of {found.n} runs."
    if not np.isfinite(found.high):
        return Verdict.NOT_REPLICATED, "Fewer than two runs survive."
    text = (
        f"RMSE {found.estimate:.3g} rad (95 % interval {found.low:.3g} to {found.high:.3g}, {found.n} runs, {found.failed} failed); taking "
        f"the car for level has {bound:.3g} rad"
    )
    if found.high < bound:
        return Verdict.REPLICATED, f"{text}, which is more."
    if found.low > bound:
        return Verdict.NOT_REPLICATED, f"{text}, which is less."
    return Verdict.INCONCLUSIVE, f"{text}, which the interval contains."


def tilt_row(results: Results, case: Case, channel: str, bound: float) -> Row:
    """The MKMC-EKF's error of roll or pitch at one rate."""
    found = sweep_level(results, "rates", case.where, PAIR[0], "rmse", channel)
    verdict, reason = bound_rule(found, bound, MINIMUM[case.size])
    numbers: tuple = (found.estimate, found.low, found.high) if np.isfinite(found.high) else (FAILED, "", "")
    return Row("C13", CONTINUOUS, f"{case.words}, {channel}", *numbers, found.n, PAIR[0], verdict, reason, unit="rad")


def judge_rates(results: Results) -> list[Row]:
    """C13: roll and pitch bounded at every rate that the paper names, and what the MKMC-EKF improves there."""
    (printed,) = rows_of(results.published, "C13").query("value_high != ''").itertuples()
    lowest, highest = float(printed.value), float(printed.value_high)
    bounds, rows, verdicts = true_tilts(results), [], {}
    for case in rate_sweep(results):
        for channel in TILTS:
            row = tilt_row(results, case, channel, bounds[channel])
            rows.append(row)
            if lowest <= case.where["rate_hz"] <= highest:
                verdicts[row.condition] = row.verdict
        rows.append(cells_row("C13", "improvement of MKMC-EKF over CI-RKF by rate", case, cells_of(results, case, CHANNELS), majority))
    used = results.settings.options["rate_hz"]
    reason = f"A general statement: the paper does not give the rate of its experiment. {used:g} Hz here, with a sweep."
    rows.append(without_interval("C13", printed.quantity, 0, PAIR[0], Verdict.UNTESTABLE, reason, "set-up"))
    verdict, found = combine_many(verdicts)
    reason = (
        f"Roll and pitch of the MKMC-EKF in F1 from {lowest:g} to {highest:g} Hz: {found} Yaw and velocity are not observed at any rate."
    )
    return [*rows, without_interval("C13", CONTINUOUS, rows[0].n, PAIR[0], verdict, reason)]
