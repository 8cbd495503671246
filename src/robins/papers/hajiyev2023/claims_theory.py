"""The claims about the filters' inner workings: whiteness (C9), statement 1 (C10), scale factors (C11), convergence (C16)."""

from typing import NamedTuple

import numpy as np
from scipy import stats

from robins.evaluate.intervals import LEVEL, Interval, Z, mean_interval
from robins.evaluate.ledger import Row
from robins.evaluate.verdicts import Verdict
from robins.navigation.aircraft import STATES
from robins.papers.hajiyev2023.comparisons import AMDKF, FAULTY, MDKF, direction_rule, expected_scale, fault_ratio, scores
from robins.papers.hajiyev2023.judging import (
    LATERAL_TWICE,
    MINIMUM,
    combine_many,
    ends,
    equality_rule,
    no_change_rule,
    ratio_row,
    without_interval,
)
from robins.papers.hajiyev2023.scenario import BRANCHES, SETTLED, baseline
from robins.papers.protocol import Results

CHANNELS = len(STATES)
LAG_TOLERANCE = 0.01
"""How near to theory the lag-one autocorrelation has to be (brief, T5)."""
SCALE_TOLERANCE = 0.08
"""How near to theory the scale factors have to be (brief, T12)."""
INNOVATION_NEEDS = (MDKF, "akf", "theory")
CONVERGENCE_NEEDS = (MDKF,)
CORRECTION = (
    "The half-widths of the autocorrelations count the products at each lag since a run of the reporting seeds; before, they counted "
    "those at lag 0, which are more, and refuted one control."
)
"""What the ledger has to disclose: the interval was mended after the reporting seeds had been seen."""


class Moments(NamedTuple):
    """What an ensemble of innovations says; ``deviation`` is the channel farthest from the predicted variance.

    Attributes
    ----------
    nis : Interval
        Mean NIS.
    variance, variance_half : ndarray, shape (8,)
        Sample variance over predicted variance, and the half-width of its family-wise 95 % interval.
    correlation : ndarray, shape (20, 8)
        Autocorrelation at lags 1 to 20.
    correlation_half : ndarray, shape (20, 1)
        Half-width of the family-wise 95 % interval around 0 at each lag, from the products that the lag has.
    """

    nis: Interval
    variance: np.ndarray
    variance_half: np.ndarray
    correlation: np.ndarray
    correlation_half: np.ndarray


def family_quantile(tests: int) -> float:
    """The normal quantile of two-sided 95 % intervals that hold together for so many tests (Bonferroni)."""
    return float(stats.norm.ppf(1 - (1 - LEVEL) / (2 * tests)))


def moments(arrays: dict, prefix: str, nis_of_runs: np.ndarray | None = None) -> Moments:
    """Moments of the settled innovations from the arrays ``<prefix>.<what>`` of a job.

    Without the NIS of each run its interval is that of a chi-square mean, widened by the innovations' own
    autocorrelation: the squares of a Gaussian series with autocorrelation r are correlated by r^2.
    """
    count, *products = arrays[f"{prefix}.innovation_count"].astype(float)
    correlation = arrays[f"{prefix}.innovation_autocorrelation"][1:]
    widening = 1 + 2 * np.sum(correlation**2, axis=0)
    variance = arrays[f"{prefix}.innovation_variance_ratio"]
    half = family_quantile(CHANNELS) * variance * np.sqrt(2 / count * widening)
    if nis_of_runs is None:
        mean = float(np.nanmean(arrays[f"{prefix}.nis_mean"][SETTLED:]))
        reach = Z * mean * np.sqrt(2 / (CHANNELS * count) * np.mean(widening))
        nis = Interval(mean, mean - reach, mean + reach, int(count))
    else:
        nis = mean_interval(nis_of_runs)
    return Moments(nis, variance, half, correlation, family_quantile(correlation.size) / np.sqrt(products)[:, None])


def judge_whiteness(results: Results) -> list[Row]:
    """C9: is xi white? Its autocorrelation at lag one against 0, and against -A_n Q_v / R of theory (E1)."""
    rows, verdicts = [], {}
    for line in results.table("theory").itertuples():
        verdict, reason = equality_rule(line.low, line.high, 0.0, line.n)
        near = abs(line.value - line.theory) <= LAG_TOLERANCE
        reason = (
            f"White noise has none. {reason} Theory (E1) says {line.theory:.3g}; ours is {'within' if near else 'not within'} "
            f"{LAG_TOLERANCE:g} of it."
        )
        quantity, numbers = f"lag-one autocorrelation of xi, {line.channel}", (line.value, *ends(line.low, line.high))
        rows.append(
            Row("C9", quantity, line.branch, *numbers, line.n, MDKF, verdict, reason, published=0.0, unit="1", location="eqs (8)-(10)")
        )
        verdicts[f"{line.branch}, {line.channel}"] = verdict
    verdict, found = combine_many(verdicts)
    proof = (
        "xi(k) and xi(k-1) share v(k), so E[xi(k) xi^T(k-1)] = -A_n Q_v, which is 0 only without white measurement noise (E1). Equation "
        "(9) tests the mean and equation (10) the same-time covariance; neither is whiteness."
    )
    reason = f"{proof} Measured, by branch and channel: {found} {LATERAL_TWICE}"
    return [*rows, without_interval("C9", "whiteness of xi", rows[0].n, MDKF, verdict, reason)]


def judge_innovation(results: Results) -> list[Row]:
    """C10: does the innovation have covariance (18)? NIS against 8, variances against (18), and whiteness."""
    rows, verdicts, controls = [], {}, []
    n = results.settings.sizes["runs"]
    for branch in BRANCHES:
        for variant, prefix, where in (
            (MDKF, f"{branch}.healthy", "healthy"),
            (MDKF, f"{branch}.{MDKF}.no-v", "healthy, no white noise"),
            ("akf", f"{branch}.healthy", "healthy, control"),
            ("bh", f"{branch}.bh.no-v", "healthy, no white noise, control"),
        ):
            found = _moments_of(results, variant, prefix, branch)
            added = innovation_rows(found, variant, f"{branch}, {where}", n)
            rows += added
            if "control" in where:
                controls += [row.verdict for row in added]
            else:
                verdicts[f"{branch}, {where}"] = _worst(row.verdict for row in added[:2])
    verdict, found = combine_many(verdicts)
    nis = "; ".join(f"{row.condition}: {row.ours:.3g}" for row in rows if row.quantity.startswith("mean NIS") and row.variant == MDKF)
    reason = (
        f"{found} Equation (18) holds C, which the prediction error at k cannot know of (E2), and assumes xi white (E1). Mean NIS of "
        f"the MDKF ({nis}) should be 8. The mean is zero, as that of any linear filter with zero-mean noise. Controls, for which theory "
        f"promises all of it (AKF; BH without white noise): {controls.count(Verdict.REPLICATED)} of {len(controls)} tests are passed; each "
        f"is at the 95 % level, so that {len(controls)} independent ones of right filters would show a false alarm with probability "
        f"{1 - LEVEL ** len(controls):.2f}. {CORRECTION}"
    )
    return [*rows, without_interval("C10", "statement 1", n, MDKF, verdict, reason, location="sec 4, Statement 1")]


def _moments_of(results: Results, variant: str, prefix: str, branch: str) -> Moments:
    if ".no-v" in prefix:
        return moments(results.arrays("theory"), prefix)
    found = scores(results, variant, branch, "healthy")
    return moments(results.arrays(variant), prefix, found.nis_settled[~found.failed])


def _worst(verdicts) -> Verdict:
    words = list(verdicts)
    return next((word for word in (Verdict.TOO_SMALL, Verdict.REFUTED) if word in words), Verdict.REPLICATED)


def innovation_rows(found: Moments, variant: str, where: str, n: int) -> list[Row]:
    """NIS, the variance farthest from (18), and the largest autocorrelation of one ensemble of innovations."""
    control = "Control: this filter's innovation is white with its own covariance in theory. " if "control" in where else ""
    low, high = float(found.nis.low), float(found.nis.high)
    verdict, reason = equality_rule(low, high, CHANNELS, n)
    rows = [
        Row("C10", "mean NIS, k >= 30", where, float(found.nis.estimate), *ends(low, high), n, variant, verdict, control + reason, unit="1")
    ]

    i = int(np.argmax(np.abs(found.variance - 1) / found.variance_half))
    low, high = float(found.variance[i] - found.variance_half[i]), float(found.variance[i] + found.variance_half[i])
    verdict, reason = equality_rule(low, high, 1.0, n)
    reason = (
        f"{control}The channel farthest from its prediction is {STATES[i]}. {reason} The interval allows for eight channels. Variances "
        "only: the covariances between channels are not tested here."
    )
    quantity = "innovation variance over the filter's own"
    rows.append(Row("C10", quantity, where, float(found.variance[i]), *ends(low, high), n, variant, verdict, reason, unit="1"))

    lag, i = np.unravel_index(np.argmax(np.abs(found.correlation) / found.correlation_half), found.correlation.shape)
    value, half = float(found.correlation[lag, i]), float(found.correlation_half[lag, 0])
    low, high = value - half, value + half
    verdict, reason = equality_rule(low, high, 0.0, n)
    reason = (
        f"{control}The largest of lags 1 to 20, each over its half-width, is at lag {lag + 1} of {STATES[i]}. {reason} The interval "
        "allows for 160 of them. Whiteness is not stated for the innovation, but the gain (14) is optimal only with it."
    )
    rows.append(Row("C10", "largest autocorrelation", where, value, *ends(low, high), n, variant, verdict, reason, unit="1"))
    return rows


def judge_scale_factors(results: Results) -> list[Row]:
    """C11: do the scale factors of the faulty channels rise, and do their gains fall?"""
    rows, verdicts = [], {}
    for branch in BRANCHES:
        added = [row for state in FAULTY for row in (scale_row(results, branch, state), growth_row(results, branch, state))]
        own = {state: own_gain_row(results, branch, state) for state in FAULTY}
        gains = [gain_row(results, branch, state, own[state]) for state in FAULTY]
        others = others_row(results, branch)
        rows += [*added, *gains, *own.values(), others]
        for row in (*added[1::2], *gains, others):
            verdicts[f"{branch}, {row.quantity}"] = row.verdict
    verdict, reason = combine_many(verdicts)
    return [*rows, without_interval("C11", "scale factors and gains", rows[0].n, AMDKF, verdict, reason)]


def scale_row(results: Results, branch: str, state: str) -> Row:
    """The mean scale factor of a faulty channel beside what a fault alone would give if (18) held."""
    fault, healthy = (scores(results, AMDKF, branch, condition) for condition in ("fault", "healthy"))
    i, n = STATES.index(state), len(fault.failed)
    values, sound = fault.scale[~fault.failed, i], healthy.scale[~healthy.failed, i]
    quantity, where = f"scale factor of {state}, k = 100..149", f"{branch}, fault"
    if min(len(values), len(sound)) < 2:
        return Row("C11", quantity, where, "failed", "", "", n, AMDKF, Verdict.NOT_REPLICATED, "Fewer than two runs survive.")
    mean, expected = mean_interval(values), expected_scale(results, branch)[state]
    near, raised = abs(mean.estimate / expected - 1) <= SCALE_TOLERANCE, bool(mean.low > np.mean(sound))
    verdict = Verdict.NOT_REPLICATED if not raised else Verdict.REPLICATED if near else Verdict.DIRECTION_ONLY
    if n < MINIMUM:
        verdict = Verdict.TOO_SMALL
    reason = (
        f"1 + (m^2 - 1) R_v / R gives {expected:.3g}; ours, {mean.estimate:.3g}, is {'within' if near else 'not within'} "
        f"{SCALE_TOLERANCE:.0%} of it. Without a fault it is {np.mean(sound):.3g}, and the interval "
        f"{'lies above that' if raised else 'does not lie above that, so the factor does not rise'}."
    )
    numbers = float(mean.estimate), float(mean.low), float(mean.high)
    return Row("C11", quantity, where, *numbers, n, AMDKF, verdict, reason, unit="1")


def growth_row(results: Results, branch: str, state: str) -> Row:
    """A channel's scale factor with the fault over that without."""
    summary = fault_ratio(results, AMDKF, "scale", branch, state)
    verdict, reason = direction_rule(summary, "worse", MINIMUM, Verdict.REPLICATED)
    return ratio_row("C11", f"growth of the scale factor of {state}", branch, summary, AMDKF, verdict, reason)


def own_gain_row(results: Results, branch: str, state: str) -> Row:
    """The own element of a faulty channel's gain, from its measurement to its state, with the fault over that without."""
    summary = fault_ratio(results, AMDKF, "own_gain", branch, state)
    verdict, reason = direction_rule(summary, "better", MINIMUM)
    reason = (
        f"Supporting case, added after a run of the reporting seeds: the size of the gain's element from channel {state} to state {state}. "
        f"{reason}"
    )
    return ratio_row("C11", f"own gain of channel {state}, fault over healthy", branch, summary, AMDKF, verdict, reason)


def gain_row(results: Results, branch: str, state: str, own: Row) -> Row:
    """The norm of a faulty channel's column of the gain with the fault over that without; `own` stands beside it."""
    summary = fault_ratio(results, AMDKF, "gain_norm", branch, state)
    verdict, reason = direction_rule(summary, "better", MINIMUM, Verdict.REPLICATED)
    beside = own.ours if isinstance(own.ours, str) else f"{own.ours:.3g}"
    reason = (
        f"Euclidean norm of the gain's column in SI units and radians: it adds m/s and rad, so that the rows of u and w can decide it; "
        f"the channel's own element has {beside} ({own.verdict}). {reason}"
    )
    return ratio_row("C11", f"gain of channel {state}, fault over healthy", branch, summary, AMDKF, verdict, reason)


def others_row(results: Results, branch: str) -> Row:
    """The other channel whose scale factor grows most: does the matching element rise, and not another?"""
    others = {state: fault_ratio(results, AMDKF, "scale", branch, state) for state in STATES if state not in FAULTY}
    state = max(others, key=lambda name: others[name].estimate)
    largest, least = others[state], min(fault_ratio(results, AMDKF, "scale", branch, name).verdict_low for name in FAULTY)
    verdict = Verdict.REPLICATED if largest.verdict_high < least else Verdict.NOT_REPLICATED
    if largest.n < MINIMUM:
        verdict = Verdict.TOO_SMALL
    reason = (
        f"Of the six other channels {state} grows most, by {largest.estimate:.3g} (95 % interval {largest.verdict_low:.3g} to "
        f"{largest.verdict_high:.3g}); the faulty ones grow by at least {least:.3g}."
    )
    return ratio_row("C11", "largest growth among the other channels", branch, largest, AMDKF, verdict, reason)


def judge_convergence(results: Results) -> list[Row]:
    """C16: has the MDKF converged at k = 80? Its own deviation and its error then, over those at k = 150 and at the end."""
    parameters = baseline(BRANCHES[0])
    start, late, end = parameters.fault_start, parameters.fault_start + parameters.fault_length, parameters.steps - 1
    n = results.settings.sizes["runs"]
    rows, verdicts = [], {}
    for branch in BRANCHES:
        arrays = {what: results.arrays(MDKF)[f"{branch}.healthy.{what}"] for what in ("sd_mean", "rms_error")}
        for i, state in enumerate(STATES):
            added = [convergence_row(what, arrays[what][:, i], state, branch, start, then, n) for then in (late, end) for what in arrays]
            words = {row.verdict for row in added}
            verdicts[f"{branch}, {state}"] = Verdict.NOT_REPLICATED if Verdict.NOT_REPLICATED in words else added[0].verdict
            rows += added
    verdict, found = combine_many(verdicts)
    reason = (
        f"By branch and state: {found} Replicated: the filter's own deviation at k = {start} is within 5 % of that at k = {late} and at "
        f"k = {end}, and the error over the runs does not contradict it. {LATERAL_TWICE}"
    )
    return [*rows, without_interval("C16", "convergence by k = 80", n, MDKF, verdict, reason)]


def convergence_row(what: str, values: np.ndarray, state: str, branch: str, start: int, then: int, n: int) -> Row:
    """One quantity, shape (N+1,), at the start of the score over its value later."""
    ratio = float(values[start] / values[then])
    if what == "sd_mean":  # the MDKF's covariance depends on no data: nothing is sampled
        words, reach, note = "own deviation", 1.0, "The filter's covariance is the same in every run."
    else:  # log of a sample deviation: variance 1 / 2n; two of them, taken as independent
        words, reach = "rms error", float(np.exp(Z / np.sqrt(n)))
        note = "The interval takes the errors at the two epochs as independent, which is wide."
    verdict, reason = no_change_rule(ratio / reach, ratio * reach, n)
    condition = f"{branch}, healthy, k = {start} over k = {then}"
    return Row(
        "C16", f"{words} of {state}", condition, ratio, *ends(ratio / reach, ratio * reach), n, MDKF, verdict, f"{reason} {note}", unit="1"
    )
