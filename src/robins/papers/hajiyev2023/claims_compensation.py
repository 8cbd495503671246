"""C13: do MDKF and AMDKF compensate the errors of the INS?

Compensated means: better than the Kalman filter that ignores them (CKF), and better than the one that adds their
variance to R (CKF, inflated). The augmented filter (AKF) is the standard answer and stands beside them without entering
the verdict. Estimates of x(k) use z(0..k+1) throughout, so the printed filters' look-ahead favours none.
"""

from robins.evaluate.intervals import mean_interval
from robins.evaluate.ledger import Row
from robins.evaluate.verdicts import Verdict, combine
from robins.navigation.aircraft import STATES
from robins.papers.hajiyev2023.comparisons import AMDKF, LONGITUDINAL, MDKF, Pair, direction_rule, fault_ratio, ratio, scores
from robins.papers.hajiyev2023.judging import LATERAL_TWICE, MINIMUM, PARTLY, no_change_rule, partly, ratio_row, without_interval
from robins.papers.hajiyev2023.scenario import BRANCHES, CONDITIONS
from robins.papers.protocol import Results

UNCOMPENSATED = ("ckf", "ckf-inflated")
REFERENCE = "akf"
COMPENSATION_NEEDS = (MDKF, AMDKF, *UNCOMPENSATED, REFERENCE)


def judge_compensation(results: Results) -> list[Row]:
    """The plain filter's consistency, every ratio to it, to the inflated and to the augmented one, and the effect of the fault."""
    rows = [unsuitable_row(results, branch) for branch in BRANCHES]
    verdicts = {}
    for numerator, denominator, branch, condition in _comparisons():
        for state in STATES:
            row = compensation_row(results, Pair(numerator, denominator), branch, condition, state)
            rows.append(row)
            if denominator in UNCOMPENSATED and condition == "fault":
                verdicts[f"{branch}, {row.variant}, {state}"] = row.verdict
    rows += [unaffected_row(results, branch, state) for branch in BRANCHES for state in LONGITUDINAL]
    n = results.settings.sizes["runs"]
    reason = "The paper does not say against what the errors are small, and the axes of its figures cannot be read."
    rows.append(without_interval("C13", "state estimate errors relatively minimal", n, AMDKF, Verdict.UNTESTABLE, reason, "as stated"))
    return [*rows, without_interval("C13", "compensation of INS errors", n, f"{AMDKF}, {MDKF}", *overall(verdicts))]


def _comparisons() -> list[tuple[str, str, str, str]]:
    return [
        (numerator, denominator, branch, condition)
        for numerator in (MDKF, AMDKF)
        for denominator in (*UNCOMPENSATED, REFERENCE)
        for branch in BRANCHES
        for condition in CONDITIONS
        if numerator == MDKF or condition == "fault"
    ]


def overall(verdicts: dict[str, Verdict]) -> tuple[Verdict, str]:
    """The verdict on compensation from those of every branch, pair and state with the fault."""
    verdict, _ = combine(verdicts)
    worse = [name for name, word in verdicts.items() if word == Verdict.NOT_REPLICATED]
    better = sum(word in (Verdict.REPLICATED, Verdict.DIRECTION_ONLY) for word in verdicts.values())
    states: dict[str, list[str]] = {}
    for where, state in (name.rsplit(", ", 1) for name in worse):
        states.setdefault(where, []).append(state)
    mixed = verdict == Verdict.DEPENDS and partly(verdicts)
    reason = (
        f"{PARTLY * mixed}With the fault, {better} of {len(verdicts)} comparisons of MDKF and AMDKF with the plain and the inflated Kalman "
        f"filter find the differencing filter better and {len(worse)} find it worse"
    )
    named = "; ".join(f"{where}: {' '.join(names)}" for where, names in states.items())
    return verdict, f"{reason}{f' ({named})' if worse else ''}. {LATERAL_TWICE}"


def unsuitable_row(results: Results, branch: str) -> Row:
    """Is the plain Kalman filter unsuitable? Its NIS without a fault: 8 if its covariance were honest."""
    found = scores(results, "ckf", branch, "healthy")
    n, values = len(found.failed), found.nis_settled[~found.failed]
    where, quantity = f"{branch}, healthy", "mean NIS of the plain Kalman filter, k >= 30"
    if len(values) < 2:
        return Row("C13", quantity, where, "failed", "", "", n, "ckf", Verdict.REPLICATED, "Fewer than two runs survive.", unit="1")
    mean = mean_interval(values)
    low, high = float(mean.low), float(mean.high)
    verdict = Verdict.REPLICATED if low > 8 else Verdict.NOT_REPLICATED if high < 8 else Verdict.INCONCLUSIVE
    if n < MINIMUM:
        verdict = Verdict.TOO_SMALL
    reason = f"An honest filter has 8; the plain one, which ignores lambda, has {mean.estimate:.3g} ({low:.3g} to {high:.3g})."
    return Row("C13", quantity, where, float(mean.estimate), low, high, n, "ckf", verdict, reason, unit="1")


def compensation_row(results: Results, pair: Pair, branch: str, condition: str, state: str) -> Row:
    """One paired ratio; below 1 the differencing filter is better."""
    summary = ratio(results, pair, branch, condition, state)
    verdict, reason = direction_rule(summary, "better", MINIMUM, Verdict.REPLICATED)
    if pair.denominator == REFERENCE:
        reason = f"Beside the augmented filter, which models lambda; not part of the overall verdict. {reason}"
    return ratio_row("C13", f"RMSE ratio, {state}", f"{branch}, {condition}", summary, pair.name, verdict, reason)


def unaffected_row(results: Results, branch: str, state: str) -> Row:
    """Is the AMDKF's longitudinal estimate unaffected by the fault? Its RMSE with the fault over that without."""
    summary = fault_ratio(results, AMDKF, "rmse", branch, state)
    verdict, reason = no_change_rule(summary.verdict_low, summary.verdict_high, summary.n)
    reason = f"Unaffected by the fault would be a ratio of 1. {reason}"
    return ratio_row("C13", f"RMSE with the fault over without, {state}", branch, summary, AMDKF, verdict, reason)
