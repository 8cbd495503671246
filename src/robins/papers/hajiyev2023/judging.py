"""What every claim's rule needs: the least number of runs, the ledger's rows, and rules for claims that name a value."""

from collections.abc import Mapping

import numpy as np

from robins.evaluate.intervals import RatioSummary
from robins.evaluate.ledger import OVERALL, Row, finite_or_failed
from robins.evaluate.verdicts import Verdict, combine

MINIMUM = 1000
"""Runs below which no claim is judged (brief, section 3.2)."""
PARTLY = "Partly: "
"""How a reason begins where parts of one branch disagree; the house's word for that is ``depends on assumption``."""
LATERAL_TWICE = "The lateral states give the same numbers in both branches, so each of them counts twice."
MATERIAL = 0.05
"""Relative change below which a ratio counts as no change (the brief's bounds 0.95 and 1.05)."""


def ends(low: float, high: float) -> tuple[float | str, float | str]:
    """Both ends of an interval, or nothing when it is not finite."""
    return (float(low), float(high)) if np.isfinite([low, high]).all() else ("", "")


def ratio_row(claim_id: str, quantity: str, condition: str, summary: RatioSummary, variant: str, verdict: str, reason: str, **more) -> Row:
    """A row of the ledger for a paired ratio, with the interval that decides."""
    interval = ends(summary.verdict_low, summary.verdict_high) if summary.survivors else ("", "")
    ours = finite_or_failed(summary.estimate)
    return Row(claim_id, quantity, condition, ours, *interval, summary.n, variant, verdict, reason, unit="1", **more)


def without_interval(claim_id: str, quantity: str, n: int, variant: str, verdict: str, reason: str, condition=OVERALL, location="") -> Row:
    """A row that holds a verdict and its reason, no estimate of its own."""
    return Row(claim_id, quantity, condition, "", "", "", n, variant, verdict, reason, location=location)


def partly(verdicts: Mapping[str, str]) -> bool:
    """Whether parts of the same branch disagree, so that no choice of branch settles it; names are ``branch, part``."""
    branches: dict[str, set[str]] = {}
    for name, word in verdicts.items():
        branches.setdefault(name.split(", ")[0], set()).add(word)
    return any(len(words) > 1 for words in branches.values())


def combine_many(verdicts: Mapping[str, str]) -> tuple[Verdict, str]:
    """`combine` for many parts: the reason counts the verdicts and names the parts of all but the commonest.

    It begins with "Partly" where parts of one branch disagree: the verdict then depends on the part, not on an assumption.
    """
    verdict, _ = combine(verdicts)
    parts = {word: [name for name, found in verdicts.items() if found == word] for word in dict.fromkeys(verdicts.values())}
    commonest, *rest = sorted(parts, key=lambda word: -len(parts[word]))
    told = [f"{len(parts[commonest])} of {len(verdicts)} {commonest}"]
    told += [f"{len(parts[word])} {word} ({'; '.join(parts[word])})" for word in rest]
    return verdict, f"{PARTLY * (verdict == Verdict.DEPENDS and partly(verdicts))}{', '.join(told)}."


def equality_rule(low: float, high: float, value: float, n: int) -> tuple[Verdict, str]:
    """Judge an identity: ``refuted`` when the 95 % interval leaves out `value`, ``replicated`` when it holds it."""
    if n < MINIMUM:
        return Verdict.TOO_SMALL, f"{n} runs; the rule asks for at least {MINIMUM}."
    if low <= value <= high:
        return Verdict.REPLICATED, f"The 95 % interval {low:.4g} to {high:.4g} ({n} runs) holds {value:g}."
    return Verdict.REFUTED, f"The 95 % interval {low:.4g} to {high:.4g} ({n} runs) leaves out {value:g}."


def no_change_rule(low: float, high: float, n: int) -> tuple[Verdict, str]:
    """Judge that a ratio is 1 for practical purposes: its interval inside, outside or across 1 +- `MATERIAL`."""
    if n < MINIMUM:
        return Verdict.TOO_SMALL, f"{n} runs; the rule asks for at least {MINIMUM}."
    band = f"{1 - MATERIAL:g} to {1 + MATERIAL:g}"
    found = f"The 95 % interval {low:.4g} to {high:.4g} ({n} runs)"
    if low >= 1 - MATERIAL and high <= 1 + MATERIAL:
        return Verdict.REPLICATED, f"{found} lies inside {band}, which counts as no change."
    if high < 1 - MATERIAL or low > 1 + MATERIAL:
        return Verdict.NOT_REPLICATED, f"{found} lies outside {band}, which would count as no change."
    return Verdict.INCONCLUSIVE, f"{found} crosses an end of {band}, which would count as no change."
