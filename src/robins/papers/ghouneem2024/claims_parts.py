"""What the gain comes from: self-tuning (C11), the gate (C13), the three parts jointly (C19).

The change of the logarithm of the horizontal error from an EKF to the paper's method is attributed to filter, self-tuning and gate by
Shapley values, from both readings of the EKF and on both trajectories (T1-frozen settings, out of sample).
"""

from functools import partial

import numpy as np

from robins.evaluate.ledger import Row
from robins.evaluate.verdicts import ON_CLAIMED_SIDE, Verdict
from robins.papers.ghouneem2024.claims_settings import (
    SETTING_NEEDS,
    against_both,
    channel_verdict,
    frozen_setting,
    other_settings,
    printed_ratio,
    ratio_name,
)
from robins.papers.ghouneem2024.comparisons import (
    HEADLINE,
    PARTS,
    Where,
    attribution,
    ratio_of,
    rows,
    values,
    variant,
    where,
)  # fmt: skip
from robins.papers.ghouneem2024.filters import FILTERS
from robins.papers.ghouneem2024.judging import (
    MINIMUM,
    NAMES,
    change_rule,
    closing_row,
    listing,
    most_rule,
    numeric_row,
    ratio_row,
    ratio_rule,
    sooner,
    together,
    too_small,
    weakest,
    words_row,
)
from robins.papers.ghouneem2024.self_tuning import REFERENCED
from robins.papers.ghouneem2024.studies import CAUSES
from robins.papers.ghouneem2024.trajectories import TRAJECTORIES
from robins.papers.ghouneem2024.tune import job_name, learned_from
from robins.papers.ghouneem2024.variants import BASELINES, CONTROL, FACTORIAL, NEW, variant_name
from robins.papers.protocol import Results

PART_NEEDS = tuple(name for name, row in FACTORIAL.items() if row.family in (*BASELINES, "ukf"))
TUNING_NEEDS = (*PART_NEEDS, CONTROL, variant_name(CONTROL, "st"), "literal", job_name("ukf"))
GATE_NEEDS = (*PART_NEEDS, CONTROL, variant_name(CONTROL, "gate"), "cause")
JOINT_NEEDS = (*PART_NEEDS, *SETTING_NEEDS)
LITERAL = ("st-printed", "st-ms")
DIVERGED = 30.0
"""A run whose horizontal error is as many times that with the data sheet's variances has diverged."""
MUCH_WORSE = 2.0
GATED = (8.0, 2.0, 0.5)
"""Multiples of the thresholds in the study of causes."""
Together = tuple[Verdict, list[Row]]


def part_rows(results: Results, claim_id: str, quantity: str, part: str, measure: str = "horizontal", frozen: str = HEADLINE) -> Together:
    """A part's Shapley value on both trajectories from both EKFs, and one word for all four."""
    made = []
    for place in TRAJECTORIES:
        for baseline in BASELINES:
            found = attribution(results, baseline, place, frozen, measure)
            change = found.total if part == "all" else found.parts[part]
            verdict, reason = change_rule(change, found.failed, MINIMUM["runs"])
            what = "whole change" if part == "all" else f"Shapley value of {part}"
            condition = f"{place.upper()}, {frozen.upper()}-frozen, {what}, log of the {NAMES[measure]} error"
            made.append(numeric_row(claim_id, quantity, condition, change, change.n, f"{NEW}/{baseline}", verdict, reason, unit="1"))
    return together(row.verdict for row in made), made


def told(made: list[Row]) -> str:
    """``T1 against ekf-pi verdict (numbers); ...`` for a sentence."""
    parts = []
    for row in made:
        numbers = f" ({row.ours:.3g}, {row.ci_low:.3g} to {row.ci_high:.3g})" if row.ci_low != "" else ""
        parts.append(f"{row.condition[:2]} from {row.variant.split('/')[1]} {row.verdict}{numbers}")
    return "; ".join(parts) + "."


def factorial_rows(results: Results, claim_id: str, quantity: str, cell: str) -> list[Row]:
    """Horizontal error with a cell over that with the data sheet's variances and no gate, by filter, trajectory and frozen settings."""
    made = []
    for place in TRAJECTORIES:
        for frozen in TRAJECTORIES:
            for name in FILTERS:
                above, below = variant(variant_name(name, cell), place, frozen), variant(name, place)
                found = ratio_of(results, above, below, "horizontal")
                verdict, reason = ratio_rule(found, MINIMUM["runs"])
                reason = f"Horizontal error with over without. {reason} {much_worse(results, above, below)}"
                condition = f"{place.upper()}, {frozen.upper()}-frozen, {cell} alone"
                made.append(ratio_row(claim_id, quantity, condition, found, f"{above.job}/{name}", verdict, reason))
    return made


def much_worse(results: Results, above: Where, below: Where) -> str:
    """In how many runs the first is more than twice as bad, and its longest run of rejected fixes."""
    (own, lost), (other, other_lost) = (values(results, at, "horizontal") for at in (above, below))
    survived = ~(lost | other_lost)
    worse = int(np.sum(lost & ~other_lost) + np.sum(own[survived] > MUCH_WORSE * other[survived]))
    longest = int(rows(results, above)["longest_rejection"].max())
    rejected = f"; at most {longest} fixes rejected in a row" if longest else ""
    return f"More than {MUCH_WORSE:g} times worse in {worse} of {len(own)} runs{rejected}."


def judge_self_tuning(results: Results) -> list[Row]:
    """C11: self-tuning makes the error smaller, out of sample; convergence and the literal levels beside it."""
    benefit = "self-tuning benefit"
    verdict, made = part_rows(results, "C11", benefit, "self-tuning")
    height, height_rows = part_rows(results, "C11", benefit, "self-tuning", "height")
    _, other = part_rows(results, "C11", benefit, "self-tuning", frozen="t2")
    literal = literal_rows(results)
    diverging = "; ".join(f"{row.condition} {row.ours}" for row in literal if row.ours != "no run")
    extra = [*height_rows, *other, *factorial_rows(results, "C11", benefit, "st"), *convergence_rows(results)]
    reason = (
        f"Shapley value of self-tuning on the log of the horizontal error, T1-frozen, out of sample: {told(made)} Altitude: {height}: "
        f"{told(height_rows)} Runs that diverge with literal levels, no scale: {diverging or 'none'}."
    )
    return [*made, *extra, *literal, *negative_rows(results), closing_row("C11", benefit, verdict, reason, made)]


def convergence_rows(results: Results) -> list[Row]:
    """Does the azimuth settle sooner with self-tuning than with the data sheet's variances?"""
    made = []
    for place in TRAJECTORIES:
        for name in FILTERS:
            pair = (variant(variant_name(name, "st"), place), variant(name, place))
            share = sooner(results, [pair])
            verdict, reason = most_rule(share, MINIMUM["runs"], "The azimuth settles sooner with self-tuning")
            condition, names = f"{place.upper()}, T1-frozen, frozen environment, share of runs that settle sooner", f"{name}-st/{name}"
            made.append(numeric_row("C11", "self-tuning purpose", condition, share, share.n, names, verdict, reason, unit="1"))
    return made


def literal_rows(results: Results) -> list[Row]:
    """Which runs fail or diverge with the levels of (12) and (13) that have no scale."""
    made, options = [], results.settings.options
    for place in TRAJECTORIES:
        for level in LITERAL:
            for name, alpha in (("ekf-f", options["alpha"]), ("ukf", options["alpha"]), ("ukf", 1.0)):
                at = where("literal", trajectory=place, level=level, filter=name, alpha=alpha)
                plain = where("literal", trajectory=place, level="ds", filter=name, alpha=options["alpha"])
                made.append(divergence_row(results, at, plain, f"{place.upper()}, {level}, {name}, alpha {alpha:g}"))
    return list({row.condition: row for row in made}.values())  # alpha may be 1 already


def divergence_row(results: Results, at: Where, plain: Where, condition: str) -> Row:
    """Whether every run, some runs or none fail, or have `DIVERGED` times the horizontal error with the data sheet's variances.

    Rounding decides these errors (register, A12), so that a number of runs near the limit is another one on another processor.
    """
    (own, lost), (other, other_lost) = (values(results, side, "horizontal") for side in (at, plain))
    beyond = lost | (~lost & ~other_lost & (own > DIVERGED * np.where(other_lost, np.inf, other)))
    share = "every run" if beyond.all() else "some runs" if beyond.any() else "no run"
    reason = f"Of {beyond.size} runs, {share}: failed or over {DIVERGED:g} times the horizontal error with the data sheet's variances."
    verdict = Verdict.NOT_REPLICATED if beyond.any() else Verdict.COMPATIBLE
    if words := too_small(beyond.size, MINIMUM["side_runs"]):
        verdict, reason = Verdict.TOO_SMALL, f"{words} {reason}"
    elif not beyond.any():
        reason = f"{reason} None diverges, but none does with the data sheet's either."
    return words_row("C11", "self-tuning benefit", beyond.size, at.job, verdict, reason, condition, share)


def negative_rows(results: Results) -> list[Row]:
    """How many of the signed means of (12) and (13), pooled over the tuning runs, are negative and thus no variances."""
    made, runs = [], results.settings.sizes["tuning_runs"]
    for place in TRAJECTORIES:
        learned = learned_from(results, "ukf", place)
        for number, found in (("(12), Q", learned.mechanisation), ("(13), P0", learned.filtered)):
            negative = int(np.sum(found.mean > 0.0))  # the paper subtracts the estimate from the reference
            verdict = Verdict.REFUTED if negative else Verdict.COMPATIBLE
            reason = f"{negative} of {REFERENCED} signed means over {runs} tuning runs are negative; a variance cannot be."
            condition, ours = f"{number}, {place.upper()}, signed means", f"{negative} of {REFERENCED} negative"
            made.append(words_row("C11", "fine tuning is manual", runs, job_name("ukf"), verdict, reason, condition, ours))
    return made


def judge_gate(results: Results) -> list[Row]:
    """C13: the gate makes the error smaller, out of sample; by filter and by cause beside it."""
    benefit = "gate benefit"
    verdict, made = part_rows(results, "C13", benefit, "gate")
    _, other = part_rows(results, "C13", benefit, "gate", frozen="t2")
    by_filter = factorial_rows(results, "C13", benefit, "gate")
    causes = cause_rows(results)
    alone = "; ".join(
        f"{row.condition[:2]} {row.ours:.3g} ({row.ci_low:.3g} to {row.ci_high:.3g})" for row in by_filter
        if row.variant == "ukf-gate/ukf" and ", T1-frozen" in row.condition and row.ci_low != ""
    )  # fmt: skip
    reason = (
        f"Shapley value of the gate on the log of the horizontal error, T1-frozen, out of sample: {told(made)} With T2's settings: "
        f"{told(other)} The UKF with the gate alone over the UKF: {alone or 'no ratio'}. Gate (24) by cause, of the comparisons with and "
        f"without it those whose interval lies below, and above, 1: {by_cause(causes)}."
    )
    return [*made, *other, *by_filter, *causes, closing_row("C13", benefit, verdict, reason, made)]


def by_cause(causes: list[Row]) -> str:
    """How often gate (24) makes the error smaller, and larger, by cause of the bad fixes; the gates on NIS are controls."""
    told_of = []
    for cause in CAUSES:
        own = [row for row in causes if f", only {cause}, m = " in row.condition]
        helped = sum(row.verdict in ON_CLAIMED_SIDE for row in own)
        hurt = sum(row.ci_low != "" and row.ci_low > 1.0 for row in own)
        told_of.append(f"{cause} {helped} and {hurt} of {len(own)}")
    return ", ".join(told_of)


def cause_rows(results: Results) -> list[Row]:
    """Horizontal error with a gate over that without, where only one thing goes wrong with the satellites."""
    gates = [(name, "integrity", multiple, (name, "integrity", np.inf)) for name in FILTERS for multiple in GATED]
    gates += [("physical", gate, np.inf, ("physical", "none", np.inf)) for gate in ("nis", "nis-recovery")]
    made = []
    for place in TRAJECTORIES:
        for cause in CAUSES:

            def at(name: str, gate: str, multiple: float, place: str = place, cause: str = cause) -> Where:
                return where("cause", trajectory=place, cause=cause, filter=name, gate=gate, multiple=multiple)

            for name, gate, multiple, without in gates:
                above, below = at(name, gate, multiple), at(*without)
                found = ratio_of(results, above, below, "horizontal")
                verdict, reason = ratio_rule(found, MINIMUM["side_runs"])
                words = f"m = {multiple:g}" if gate == "integrity" else gate
                condition = f"{place.upper()}, only {cause}, {words}"
                reason = f"Horizontal error with over without the gate. {reason} {much_worse(results, above, below)}"
                made.append(ratio_row("C13", "gate purpose", condition, found, f"{name}/{name}", verdict, reason))
    return made


def judge_joint(results: Results) -> list[Row]:
    """C19: each of the three parts contributes to the gain."""
    quantity, made, verdicts, reasons = "contribution of a part", [], {}, []
    for part in PARTS:
        verdicts[part], found = part_rows(results, "C19", quantity, part)
        made += found
        reasons.append(f"{part} {verdicts[part]}: {told(found)}")
        made += part_rows(results, "C19", quantity, part, frozen="t2")[1]
    _, whole = part_rows(results, "C19", quantity, "all")
    gains = gain_rows(results)
    verdict = weakest(verdicts.values())
    reason = (
        f"Shapley values on the log of the horizontal error, T1-frozen, out of sample; the claim needs all three parts, the weakest "
        f"decides. By part: {listing(verdicts)} In detail, {' '.join(reasons)} The whole change: {told(whole)}"
    )
    count = sum(word in ON_CLAIMED_SIDE for word in verdicts.values())
    ours = "" if verdict == Verdict.TOO_SMALL else f"{count} of {len(PARTS)} contribute"
    closing = words_row("C19", "attribution to three parts", whole[0].n, NEW, verdict, reason, ours=ours)
    return [*made, *whole, *gains, closing]


def gain_rows(results: Results) -> list[Row]:
    """The horizontal ratio on both trajectories beside the one that the tables give, and position channels of the first."""
    made = []
    for place in TRAJECTORIES:
        published = printed_ratio(results, place, "horizontal")
        rule = partial(ratio_rule, published=published)
        for setting in (frozen_setting(place), *other_settings(place)):
            worded = setting._replace(words=f"{place.upper()}, horizontal, {setting.words}")
            made += against_both(results, "C19", "overall gain", worded, "horizontal", rule, published)
    for channel in ("north", "east", "height"):
        verdict, found = channel_verdict(results, "t1", channel)
        numbers = "; ".join(f"{row.variant} {row.verdict}" for row in found)
        reason = f"{ratio_name('t1', channel)}, T1-frozen: {numbers}."
        made.append(words_row("C19", "Fig 4 position errors", found[0].n, NEW, verdict, reason, f"T1, {NAMES[channel]}"))
    return made
