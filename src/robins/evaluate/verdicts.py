"""The closed list of verdict words, and the rules that choose between them.

A rule returns a verdict and a reason: one plain sentence or two, with the numbers that decided.
"""

from collections.abc import Mapping
from enum import StrEnum

from robins.evaluate.intervals import RatioSummary

FAILURE_LIMIT = 0.05
"""A filter that fails in a larger share of the runs is never "replicated"."""


class Verdict(StrEnum):
    """Every word that may stand in the verdict column."""

    REPLICATED = "replicated"
    DIRECTION_ONLY = "direction only"
    NOT_REPLICATED = "not replicated"
    INCONCLUSIVE = "inconclusive"
    COMPATIBLE = "compatible but uninformative"
    DEPENDS = "depends on assumption"
    REFUTED = "refuted"
    UNTESTABLE = "untestable"
    TOO_SMALL = "n too small"


ON_CLAIMED_SIDE = frozenset({Verdict.REPLICATED, Verdict.DIRECTION_ONLY})
WITHOUT_CLAIMED_SIDE = frozenset({Verdict.NOT_REPLICATED, Verdict.INCONCLUSIVE})

HOUSE_WORD: Mapping[str, Verdict] = {
    # hajiyev2023, section 4.3
    "replicated": Verdict.REPLICATED,
    "direction-only": Verdict.DIRECTION_ONLY,
    "inconclusive": Verdict.INCONCLUSIVE,
    "not replicated": Verdict.NOT_REPLICATED,
    "untestable": Verdict.UNTESTABLE,
    "depends on units": Verdict.DEPENDS,
    "partly": Verdict.DEPENDS,
    # chen2025, decision rules
    "direction only": Verdict.DIRECTION_ONLY,
    "compatible": Verdict.COMPATIBLE,
    "compatible/uninformative": Verdict.COMPATIBLE,
    "numbers untestable": Verdict.UNTESTABLE,
    # ghouneem2024, section 4
    "baseline-dependent": Verdict.DEPENDS,
    "depends on baseline": Verdict.DEPENDS,
    "supported": Verdict.REPLICATED,
    "not supported": Verdict.NOT_REPLICATED,
    # imani2026, section 3.2
    "direction replicated": Verdict.DIRECTION_ONLY,
    "not reproduced": Verdict.NOT_REPLICATED,
    "untestable as a finding": Verdict.UNTESTABLE,
    "untestable against the paper": Verdict.UNTESTABLE,
}
"""The words that the papers' study plans use, and the house's word for each."""


def ratio_rule(summary: RatioSummary, claimed_side: str, published_ratio: float, minimum: int) -> tuple[Verdict, str]:
    """Judge a claim that one filter's error is smaller ("better") or larger ("worse") than another's.

    * fewer than `minimum` runs: ``n too small``;
    * no run survives in both filters: ``not replicated``, for there is no ratio;
    * the 95 % interval of the geometric mean, failed runs counted as losses, contains 1: ``inconclusive``;
    * it lies on the other side of 1: ``not replicated``;
    * it lies on the claimed side, and the published ratio is inside the central 95 % of single-run
      ratios, and neither filter fails in more than 5 % of the runs: ``replicated``;
    * on the claimed side otherwise: ``direction only``.

    Parameters
    ----------
    summary : RatioSummary
    claimed_side : {"better", "worse"}
        What the paper says of the numerator's filter.
    published_ratio : float
    minimum : int
        Runs, failed ones included, below which no verdict is given.

    Returns
    -------
    verdict : Verdict
    reason : str
        Numbers to three digits: the exact ones stand in the ledger's own columns.
    """
    if claimed_side not in ("better", "worse"):
        raise ValueError(f'the claimed side is "better" or "worse", not {claimed_side!r}')
    if summary.n < minimum:
        return Verdict.TOO_SMALL, f"{summary.n} runs; the rule asks for at least {minimum}."
    if summary.survivors == 0:
        return Verdict.NOT_REPLICATED, f"No run survives in both filters, so there is no ratio.{failures(summary)}"

    low, high = summary.verdict_low, summary.verdict_high
    found = (
        f"The geometric mean ratio is {summary.estimate:.3g} (95 % interval {low:.3g} to {high:.3g}, "
        f"{summary.n} runs); the paper claims it {'below' if claimed_side == 'better' else 'above'} 1"
    )
    remarks = f"{failures(summary)}{bootstrap_remark(summary)}"
    side = side_of_one(low, high)
    if side == "neither":
        same = " The two filters have the same error in every run." if low == high else ""
        return Verdict.INCONCLUSIVE, f"{found} and the interval contains 1.{same}{remarks}"
    if side != claimed_side:
        return Verdict.NOT_REPLICATED, f"{found} and the interval lies on the other side.{remarks}"

    inside = summary.central_low <= published_ratio <= summary.central_high
    size = (
        f"The published ratio {published_ratio:.3g} lies {'inside' if inside else 'outside'} the central 95 % of single runs "
        f"({summary.central_low:.3g} to {summary.central_high:.3g})."
    )
    reason = f"{found} and the interval agrees. {size}{remarks}"
    if too_many_failures(summary):
        return Verdict.DIRECTION_ONLY, f"{reason} A filter that fails in more than {FAILURE_LIMIT:.0%} of the runs is never replicated."
    return (Verdict.REPLICATED if inside else Verdict.DIRECTION_ONLY), reason


def side_of_one(low: float, high: float) -> str:
    """Where an interval of ratios lies: wholly below 1 ("better"), wholly above ("worse") or "neither"."""
    if high < 1:
        return "better"
    return "worse" if low > 1 else "neither"


def too_many_failures(summary: RatioSummary) -> bool:
    """Whether either filter fails in more than the allowed share of the runs."""
    return max(summary.numerator_failed, summary.denominator_failed) > FAILURE_LIMIT * summary.n


def failures(summary: RatioSummary) -> str:
    """A sentence about failed runs, empty when none failed."""
    if not summary.failed:
        return ""
    return (
        f" Failed runs count as losses: the numerator's filter failed in {summary.numerator_failed}, "
        f"the denominator's in {summary.denominator_failed} of {summary.n}."
    )


def bootstrap_remark(summary: RatioSummary) -> str:
    """A sentence when the survivors' bootstrap interval lies otherwise with respect to 1, empty when it agrees."""
    if side_of_one(summary.bca_low, summary.bca_high) == side_of_one(summary.verdict_low, summary.verdict_high):
        return ""
    return f" The survivors' bootstrap interval ({summary.bca_low:.3g} to {summary.bca_high:.3g}) would decide otherwise."


def combine(verdicts: Mapping[str, str]) -> tuple[Verdict, str]:
    """The overall verdict from one verdict for each branch (or baseline, or channel).

    Agreement means the same word everywhere. "Replicated" in one branch and "direction only" in another is
    not agreement: both lie on the claimed side, but whether the published *size* comes out depends on the
    branch, and either word alone would hide that. The reason then says that the direction is common. "Not
    replicated" beside "inconclusive" differs too; the reason then says that the claimed direction is found in neither.
    A single "n too small" makes the whole too small.

    Raises
    ------
    ValueError
        There is no branch, or a word is not a house word.
    """
    found = {branch: Verdict(word) for branch, word in verdicts.items()}
    if not found:
        raise ValueError("there is no verdict to combine")
    listing = "; ".join(f"{branch}: {verdict}" for branch, verdict in found.items())
    words = set(found.values())
    if len(words) == 1:
        return words.pop(), f"The same verdict throughout ({listing})."
    if Verdict.TOO_SMALL in words:
        return Verdict.TOO_SMALL, f"A part has too few runs ({listing})."
    common = " The direction is the claimed one throughout; the size depends." if words <= ON_CLAIMED_SIDE else ""
    if words == WITHOUT_CLAIMED_SIDE:
        common = " The claimed direction is found in none of them."
    return Verdict.DEPENDS, f"The verdicts differ ({listing}).{common}"
