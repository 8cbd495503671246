"""Every claim of the paper and the rule that judges it (brief, section 4.3).

A branch is judged by itself and branches are never averaged; the row ``overall`` says whether they agree. Rows beside
the paper's own case (no fault, other filters, other estimates) are supporting: they are judged by direction alone,
since the paper prints no number for them, and do not enter the overall verdict unless the rule says so.

The claims about the theory are in `claims_theory`, those about compensation in `claims_compensation`.
"""

from collections.abc import Iterable, Mapping
from functools import partial

from robins.evaluate.intervals import mean_interval
from robins.evaluate.ledger import Row
from robins.evaluate.verdicts import HOUSE_WORD, ON_CLAIMED_SIDE, Verdict, combine, ratio_rule
from robins.navigation.aircraft import STATES
from robins.papers.hajiyev2023.claims_compensation import COMPENSATION_NEEDS, judge_compensation
from robins.papers.hajiyev2023.claims_theory import (
    CONVERGENCE_NEEDS,
    INNOVATION_NEEDS,
    judge_convergence,
    judge_innovation,
    judge_scale_factors,
    judge_whiteness,
)
from robins.papers.hajiyev2023.comparisons import (
    ADAPTED,
    AMDKF,
    FAULTY,
    MDKF,
    Pair,
    direction_rule,
    harm_ratio,
    labelled,
    published_ratio,
    published_rmse,
    ratio,
    scores,
    unit,
)
from robins.papers.hajiyev2023.judging import MINIMUM, PARTLY, ratio_row, without_interval
from robins.papers.hajiyev2023.scenario import BRANCHES
from robins.papers.protocol import Claim, Results

RATIO_CLAIMS = {state: (f"C{i + 1}", "better" if i < 4 else "worse") for i, state in enumerate(STATES)}
"""Claim id and claimed side of each state: the four longitudinal ones better, the four lateral ones worse."""
AFFECTED = ("u", "w")
"""States that the paper calls highly affected by the faulty channels."""

SUPPORTING = (
    (ADAPTED, ("healthy",), "without a fault"),
    (Pair("amdkf-gated", MDKF), ("fault", "healthy"), "with adaptation only where the innovations exceed their 99.9 % quantile"),
    (Pair("amdkf-scalar-trace", MDKF), ("fault",), "with one scale factor for all channels, from traces"),
    (Pair("amdkf-scalar-mean", MDKF), ("fault",), "with one scale factor for all channels, the mean of ratios"),
    (Pair("abh", "bh"), ("fault", "healthy"), "with the corrected filter"),
    (Pair("abh", "bh", "filtered"), ("fault",), "with the corrected filter, no look-ahead"),
    (Pair("aakf", "akf"), ("fault", "healthy"), "with the augmented filter"),
    (Pair("aakf", "akf", "filtered"), ("fault",), "with the augmented filter, no look-ahead"),
)
"""Pairs beside the paper's own, the conditions in which they are judged, and what the reason calls them."""

RATIO_NEEDS = tuple(dict.fromkeys(name for pair in (ADAPTED, *(row[0] for row in SUPPORTING)) for name in pair.needs))

UNPUBLISHED = "A, B, G, H, Q_w, Q_v, A_n, B_n, Q_U, the sampling time, M, the inputs, the initial values, the flight condition and the seed"


def judge_ratio(results: Results, state: str) -> list[Row]:
    """C1-C8: is the AMDKF's error of a state smaller (or larger) than the MDKF's, and as much as printed?"""
    claim_id, side = RATIO_CLAIMS[state]
    rows, verdicts = [], {}
    for branch in BRANCHES:
        summary = ratio(results, ADAPTED, branch, "fault", state)
        verdicts[branch], reason = ratio_rule(summary, side, published_ratio(results, state), MINIMUM)
        rows.append(
            ratio_row(
                claim_id,
                f"RMSE ratio, {state}",
                f"{branch}, fault",
                summary,
                ADAPTED.name,
                verdicts[branch],
                reason,
                published=published_ratio(results, state),
                location="Table 1",
            )  # fmt: skip
        )
    for pair, conditions, words in SUPPORTING:
        for branch in BRANCHES:
            rows += [supporting_row(results, state, pair, branch, condition, words) for condition in conditions]
    verdict, reason = combine(verdicts)
    if verdict == Verdict.DEPENDS:
        reason = f"Depends on the units in which Table 1 is read. {reason}"
    numbers = "; ".join(f"{row.condition}: {row.ours:.3g}" if not isinstance(row.ours, str) else row.condition for row in rows[:2])
    reason = f"{reason} Geometric mean ratio, {numbers}; the paper's one run has {published_ratio(results, state):.3g}."
    return [*rows, without_interval(claim_id, f"RMSE ratio, {state}", rows[0].n, ADAPTED.name, verdict, reason)]


def supporting_row(results: Results, state: str, pair: Pair, branch: str, condition: str, words: str) -> Row:
    """A case beside the paper's own, judged by direction."""
    claim_id, side = RATIO_CLAIMS[state]
    summary = ratio(results, pair, branch, condition, state)
    verdict, reason = direction_rule(summary, side, MINIMUM)
    where = f"{branch}, {condition}" + ("" if pair.denominator == MDKF else f", {pair.estimate}")
    return ratio_row(claim_id, f"RMSE ratio, {state}", where, summary, pair.name, verdict, f"Supporting case, {words}. {reason}")


def together(verdicts: Iterable[str]) -> Verdict:
    """One word for a claim about several states at once: all, none, or partly."""
    words = {Verdict(word) for word in verdicts}
    if Verdict.TOO_SMALL in words:
        return Verdict.TOO_SMALL
    if words <= ON_CLAIMED_SIDE:
        return Verdict.REPLICATED if words == {Verdict.REPLICATED} else Verdict.DIRECTION_ONLY
    if words & ON_CLAIMED_SIDE:
        return HOUSE_WORD["partly"]
    return Verdict.NOT_REPLICATED if Verdict.NOT_REPLICATED in words else Verdict.INCONCLUSIVE


def state_verdicts(results: Results, states: Iterable[str], branch: str) -> dict[str, Verdict]:
    """The verdicts of the ratio claims of these states in a branch."""

    def verdict(state: str) -> Verdict:
        summary = ratio(results, ADAPTED, branch, "fault", state)
        return ratio_rule(summary, RATIO_CLAIMS[state][1], published_ratio(results, state), MINIMUM)[0]

    return {state: verdict(state) for state in states}


def listing(verdicts: Mapping[str, str]) -> str:
    """``name: verdict`` for a sentence."""
    return "; ".join(f"{name}: {verdict}" for name, verdict in verdicts.items())


def judge_faulty_channels(results: Results) -> list[Row]:
    """C12: is the AMDKF more accurate in the faulty channels, and in those that they affect?"""
    rows, faulty, everything, told = [], {}, {}, []
    n = results.settings.sizes["runs"]
    for branch in BRANCHES:
        found = state_verdicts(results, (*FAULTY, *AFFECTED), branch)
        faulty[branch] = together(found[state] for state in FAULTY)
        everything[branch] = together(found.values())
        told.append(f"{branch} ({listing(found)})")
        for states, words, verdict in (
            (FAULTY, "faulty channels q and theta", faulty[branch]),
            (AFFECTED, "affected states u and w", together(found[state] for state in AFFECTED)),
        ):
            told_part = listing({state: found[state] for state in states})
            reason = f"{PARTLY * (verdict == Verdict.DEPENDS)}C1-C4 as judged ({told_part})."
            rows.append(without_interval("C12", words, n, ADAPTED.name, verdict, reason, f"{branch}, fault"))
        for state in FAULTY:
            summary = harm_ratio(results, ADAPTED, branch, state)
            verdict, reason = direction_rule(summary, "better", MINIMUM, Verdict.REPLICATED)
            reason = f"Does the fault multiply the AMDKF's error by less than the MDKF's? {reason}"
            rows.append(ratio_row("C12", f"harm by the fault, {state}", branch, summary, ADAPTED.name, verdict, reason))
    verdict, _ = combine(everything)
    states = "The states or the branches disagree" if verdict == Verdict.DEPENDS else "All states and both branches together"
    mixed = Verdict.DEPENDS in everything.values()
    reason = f"{PARTLY * mixed}{states}: {', '.join(told)}. The faulty channels together: {listing(faulty)}."
    return [*rows, without_interval("C12", "faulty and affected channels", n, ADAPTED.name, verdict, reason)]


def judge_levels(results: Results) -> list[Row]:
    """C14: the levels of Table 1. Ours stand beside them and prove nothing, because the levels come from unpublished inputs."""
    rows = []
    for branch in BRANCHES:
        for state in STATES:
            for kind, variant in (("MDKF", MDKF), ("AMDKF", AMDKF)):
                rows.append(level_row(results, branch, state, kind, variant))
    reason = f"Levels follow from inputs that the paper does not print: {UNPUBLISHED}. One noise realisation is printed."
    return [*rows, without_interval("C14", "RMSE levels", rows[0].n, ADAPTED.name, Verdict.UNTESTABLE, reason, location="Table 1")]


def level_row(results: Results, branch: str, state: str, kind: str, variant: str) -> Row:
    """Our mean RMSE beside the printed one, in the unit in which the branch reads it."""
    found = scores(results, variant, branch, "fault")
    values = labelled(found.rmse[:, STATES.index(state)], state, branch)[~found.failed]
    printed = published_rmse(results, state, kind)
    shared = {"published": printed, "unit": unit(state, branch), "location": "Table 1"}
    quantity, where = f"RMSE {state} {kind}", f"{branch}, fault"
    if len(values) < 2:
        reason = "Fewer than two runs survive, and the inputs behind the level are unpublished."
        return Row("C14", quantity, where, "failed", "", "", len(found.failed), variant, Verdict.UNTESTABLE, reason, **shared)
    mean = mean_interval(values)
    reason = (
        f"Our mean is {mean.estimate / printed:.3g} times the printed number, over {mean.n} surviving runs of a substitute aircraft with "
        "calibrated noise; the inputs behind the printed level are unpublished."
    )
    ours = float(mean.estimate), float(mean.low), float(mean.high)
    return Row("C14", quantity, where, *ours, len(found.failed), variant, Verdict.UNTESTABLE, reason, **shared)


def judge_autonomy(results: Results) -> list[Row]:
    """C15: long autonomous flight without hardware redundancy. Nothing in a 20 s linear simulation can say."""
    reasons = {
        "long autonomous use without external sources (MDKF)": "a flight of hours and the growth of the position error, which is no state",
        "INS usable for extended periods in flight": "a flight of hours; the paper and this study simulate 200 steps of a linear model",
        "no hardware redundancy needed": "a redundant set of sensors to compare with, and faults other than larger noise",
        "no external navigation resources needed": "position and velocity in a navigation frame, and an external aid to compare with",
    }
    rows = [
        without_interval("C15", quantity, 0, ADAPTED.name, Verdict.UNTESTABLE, f"Missing: {missing}.", "as stated")
        for quantity, missing in reasons.items()
    ]
    reason = (
        "Neither the paper nor this study simulates more than 200 steps of a linear model; a long flight, its position error, redundant "
        "sensors and external aids are missing."
    )
    return [*rows, without_interval("C15", "autonomous navigation", 0, ADAPTED.name, Verdict.UNTESTABLE, reason)]


def _claim(claim_id: str, statement: str, judge, needs: Iterable[str], minimum: int = MINIMUM) -> Claim:
    module = getattr(judge, "func", judge).__module__
    return Claim(claim_id, statement, judge, tuple(needs), (module,), "runs", minimum)


CLAIMS: tuple[Claim, ...] = (
    *(
        _claim(claim_id, f"The AMDKF estimates {state} {side} than the MDKF.", partial(judge_ratio, state=state), RATIO_NEEDS)
        for state, (claim_id, side) in RATIO_CLAIMS.items()
    ),
    _claim("C9", "The differenced measurement noise is white.", judge_whiteness, ("theory",)),
    _claim("C10", "The innovation is zero-mean Gaussian with covariance (18).", judge_innovation, INNOVATION_NEEDS),
    _claim("C11", "A fault raises the matching scale factor and lowers the gain.", judge_scale_factors, (AMDKF,)),
    _claim("C12", "The AMDKF is more accurate in the faulty channels and in those that they affect.", judge_faulty_channels, ADAPTED.needs),
    _claim("C13", "MDKF and AMDKF compensate the errors of the INS.", judge_compensation, COMPENSATION_NEEDS),
    _claim("C14", "RMSE of Table 1.", judge_levels, ADAPTED.needs, 0),
    _claim("C15", "Long autonomous flight without redundant hardware.", judge_autonomy, (), 0),
    _claim("C16", "The filter has converged when the score begins, at k = 80.", judge_convergence, CONVERGENCE_NEEDS),
)
"""Every claim, in the paper's order."""
