"""What every claim's rule needs: rules for ratios, shares and attributions, and rows of the ledger.

A ratio is the paper's method over an EKF, and a claim has to hold against both readings of the EKF (brief, section 4). The brief calls
a claim "not replicated" where neither interval lies below 1; the house has a word of its own for two intervals that contain 1,
``inconclusive``, and it wins here (`together` is where that is decided). "Baseline-dependent" is ``depends on assumption``.
"""

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType

import numpy as np

from robins.evaluate.intervals import Interval, proportion_interval
from robins.evaluate.ledger import FAILED, OVERALL, Row
from robins.evaluate.verdicts import FAILURE_LIMIT, ON_CLAIMED_SIDE, Verdict, side_of_one
from robins.papers.ghouneem2024.comparisons import GeometricRatio, Where, rows
from robins.papers.ghouneem2024.runs import CHANNELS
from robins.papers.protocol import Results

MINIMUM = MappingProxyType({"runs": 50, "side_runs": 12, "in_sample_runs": 12})
"""Runs below which a row says ``n too small``: the headline's, a study's and those in sample (the numbers of the standard ensemble)."""
FACTOR = 1.5
"""How far a published ratio may be from ours and still count as the same size."""
NEARLY = 0.05
"""Relative change that still counts as unchanged."""
SOONER = 1.0
"""Seconds by which convergence has to differ to count."""
NAMES = MappingProxyType(dict(zip(
    (*CHANNELS, "horizontal"),
    ("azimuth", "east velocity", "north velocity", "up velocity", "latitude", "longitude", "altitude", "horizontal"), strict=True,
)))  # fmt: skip
"""What readers call the measures."""
STRENGTH = (
    Verdict.TOO_SMALL, Verdict.NOT_REPLICATED, Verdict.INCONCLUSIVE, Verdict.DEPENDS, Verdict.DIRECTION_ONLY, Verdict.REPLICATED,
)  # fmt: skip
"""From the weakest word to the strongest."""


def too_small(n: int, minimum: int) -> str:
    """A sentence when there are fewer than `minimum` runs, else nothing."""
    return f"{n} runs; the rule asks for at least {minimum}." if n < minimum else ""


def lost_runs(found: GeometricRatio) -> str:
    """A sentence about failed runs, empty when none failed."""
    if not (found.numerator_failed or found.denominator_failed):
        return ""
    return (
        f" Failed runs count as losses: the numerator's filter failed in {found.numerator_failed}, the denominator's in "
        f"{found.denominator_failed} of {found.n}."
    )


def unreliable(found: GeometricRatio) -> bool:
    """Whether either filter fails in more than the allowed share of the runs."""
    return max(found.numerator_failed, found.denominator_failed) > FAILURE_LIMIT * found.n


def numbers_of(found: GeometricRatio) -> str:
    """The ratio and its interval for a sentence."""
    return f"Ratio {found.estimate:.4g} (95 % interval {found.low:.4g} to {found.high:.4g}, {found.n} runs)"


def ratio_rule(
    found: GeometricRatio, minimum: int, published: float | None = None, best: Verdict = Verdict.REPLICATED
) -> tuple[Verdict, str]:  # fmt: skip
    """Judge the claim that the numerator's filter has the smaller error, against one EKF.

    * fewer than `minimum` runs: ``n too small``;
    * fewer than two runs survive in both filters: ``not replicated``;
    * the 95 % interval contains 1: ``inconclusive``; it lies above: ``not replicated``;
    * below 1, and either filter fails in more than 5 % of the runs, or the published ratio is not within `FACTOR` of ours:
      ``direction only``;
    * below 1 otherwise: `best`.

    Parameters
    ----------
    found : GeometricRatio
    minimum : int
    published : float, optional
        The paper's ratio.
    best : Verdict
        The word where the paper prints none.
    """
    if words := too_small(found.n, minimum):
        return Verdict.TOO_SMALL, words
    lost = lost_runs(found)
    if found.survivors < 2:
        return Verdict.NOT_REPLICATED, f"Fewer than two runs survive in both filters, so there is no ratio.{lost}"
    side = side_of_one(found.low, found.high)
    size, same = "", True
    if published is not None:
        apart = max(published / found.estimate, found.estimate / published)
        same = apart <= FACTOR
        size = f" The published ratio is {published:.3g}, {'within' if same else 'not within'} a factor {FACTOR:g}."
    if side == "neither":
        return Verdict.INCONCLUSIVE, f"{numbers_of(found)}; the interval contains 1.{size}{lost}"
    if side == "worse":
        return Verdict.NOT_REPLICATED, f"{numbers_of(found)}; the interval lies above 1.{size}{lost}"
    reason = f"{numbers_of(found)}; the interval lies below 1.{size}{lost}"
    if unreliable(found):
        return Verdict.DIRECTION_ONLY, f"{reason} A filter that fails in more than {FAILURE_LIMIT:.0%} of the runs is never replicated."
    if published is None:
        return best, reason
    return (Verdict.REPLICATED if same else Verdict.DIRECTION_ONLY), reason


def unchanged_rule(found: GeometricRatio, minimum: int) -> tuple[Verdict, str]:
    """Judge the claim that the ratio is 1 to within `NEARLY`: its interval inside, outside or across these bounds.

    A filter that fails in more than 5 % of the runs is never "unchanged".
    """
    if words := too_small(found.n, minimum):
        return Verdict.TOO_SMALL, words
    lost = lost_runs(found)
    if found.survivors < 2:
        return Verdict.NOT_REPLICATED, f"Fewer than two runs survive in both filters, so there is no ratio.{lost}"
    low, high = 1 - NEARLY, 1 + NEARLY
    text = f"{numbers_of(found)}; unchanged is {low:g} to {high:g}"
    if low < found.low and found.high < high and not unreliable(found):
        return Verdict.REPLICATED, f"{text}, and the interval lies inside.{lost}"
    if found.high < low or found.low > high:
        return Verdict.NOT_REPLICATED, f"{text}, and the interval lies outside.{lost}"
    why = "too many runs fail" if low < found.low and found.high < high else "the interval crosses an end"
    return Verdict.INCONCLUSIVE, f"{text}, and {why}.{lost}"


def change_rule(found: Interval, failed: int, minimum: int) -> tuple[Verdict, str]:
    """Judge the claim that a part contributes: the interval of its change of the logarithm of the error (Shapley value) lies below 0.

    `found.n` counts all runs; the `failed` ones are left out of all cells, and with more than 5 % of them nothing is replicated.
    """
    if words := too_small(found.n, minimum):
        return Verdict.TOO_SMALL, words
    lost = f" {failed} of {found.n} runs failed in a cell and are left out." if failed else ""
    if not np.isfinite([found.low, found.high]).all():
        return Verdict.NOT_REPLICATED, f"Fewer than two runs survive in all cells.{lost}"
    text = (
        f"Change of the log error {found.estimate:.3g} (95 % interval {found.low:.3g} to {found.high:.3g}, {found.n} runs), a factor "
        f"{np.exp(found.estimate):.3g}"
    )
    if found.high < 0.0:
        verdict = Verdict.REPLICATED if failed <= FAILURE_LIMIT * found.n else Verdict.DIRECTION_ONLY
        return verdict, f"{text}; the interval lies below 0.{lost}"
    if found.low > 0.0:
        return Verdict.NOT_REPLICATED, f"{text}; the interval lies above 0: the part makes the error larger.{lost}"
    return Verdict.INCONCLUSIVE, f"{text}; the interval contains 0.{lost}"


def most_rule(share: Interval, minimum: int, what: str) -> tuple[Verdict, str]:
    """Judge the claim that something holds in most runs, from its share with Wilson's interval."""
    if words := too_small(share.n, minimum):
        return Verdict.TOO_SMALL, words
    text = f"{what} in {share.estimate:.0%} of {share.n} runs (95 % interval {share.low:.0%} to {share.high:.0%})"
    if share.low > 0.5:
        return Verdict.REPLICATED, f"{text}: in most."
    if share.high < 0.5:
        return Verdict.NOT_REPLICATED, f"{text}: not in most."
    return Verdict.INCONCLUSIVE, f"{text}: the interval contains one half."


def together(verdicts: Iterable[Verdict]) -> Verdict:
    """One word for a claim that has to hold against both baselines, or on both trajectories.

    On the claimed side everywhere: the weaker of the two words for it; somewhere: ``depends on assumption``; nowhere: ``inconclusive``
    where every interval leaves it open, else ``not replicated``.
    """
    words = set(verdicts)
    if Verdict.TOO_SMALL in words:
        return Verdict.TOO_SMALL
    if words <= ON_CLAIMED_SIDE:
        return weakest(words)
    if words & {*ON_CLAIMED_SIDE, Verdict.DEPENDS}:
        return Verdict.DEPENDS
    return Verdict.INCONCLUSIVE if words == {Verdict.INCONCLUSIVE} else Verdict.NOT_REPLICATED


def weakest(verdicts: Iterable[Verdict]) -> Verdict:
    """The weakest word, for a claim about several channels or parts, all of which it needs."""
    return min(verdicts, key=STRENGTH.index)


def listing(verdicts: Mapping[str, str]) -> str:
    """``name verdict; ...`` for a sentence."""
    return "; ".join(f"{name} {verdict}" for name, verdict in verdicts.items()) + "."


def ends(low: float, high: float) -> tuple[float | str, float | str]:
    """Both ends of an interval, or nothing when it is not finite."""
    return (float(low), float(high)) if np.isfinite([low, high]).all() else ("", "")


def numeric_row(
    claim_id: str, quantity: str, condition: str, found, n: int, name: str, verdict: str, reason: str, factor: float = 1.0, **more
) -> Row:  # fmt: skip
    """A row with an estimate and its interval, both times `factor`; without a finite interval it has the word ``failed``."""
    interval = ends(factor * found.low, factor * found.high)
    ours = factor * float(found.estimate) if np.isfinite(found.estimate) and interval[0] != "" else FAILED
    return Row(claim_id, quantity, condition, ours, *(interval if ours != FAILED else ("", "")), n, name, verdict, reason, **more)


def ratio_row(claim_id: str, quantity: str, condition: str, found: GeometricRatio, name: str, verdict: str, reason: str, **more) -> Row:
    """A row with a ratio; `name` is ``numerator/denominator``."""
    return numeric_row(claim_id, quantity, condition, found, found.n, name, verdict, reason, unit="1", **more)


def words_row(claim_id: str, quantity: str, n: int, name: str, verdict: str, reason: str, condition=OVERALL, ours="", **more) -> Row:
    """A row that holds a verdict and its reason, no estimate with an interval."""
    return Row(claim_id, quantity, condition, ours, "", "", n, name, verdict, reason, **more)


def closing_row(claim_id: str, quantity: str, verdict: Verdict, reason: str, decisive: Sequence[Row], larger: bool = False) -> Row:
    """The row ``overall``: it shows the numbers of the row that speaks least for the claim, and its published number.

    `larger` says that a larger number speaks for the claim, as a share does; otherwise a smaller one, as a ratio.
    """

    def against(row: Row) -> tuple[int, float]:
        high = np.inf if row.ci_high == "" else -row.ci_high if larger else row.ci_high
        return -STRENGTH.index(Verdict(row.verdict)), high

    shown = max(decisive, key=against)
    return Row(
        claim_id, quantity, OVERALL, shown.ours, shown.ci_low, shown.ci_high, shown.n, shown.variant, verdict, reason,
        published=shown.published, unit=shown.unit,
    )  # fmt: skip


def times(results: Results, at: Where) -> np.ndarray:
    """Seconds until the azimuth has settled, by run; a failed run never settles."""
    found = rows(results, at)
    return np.where(found["failed"], np.inf, found["settled"])


def sooner(results: Results, pairs: Sequence[tuple[Where, Where]]) -> Interval:
    """Share of the runs in which the first of each pair settles sooner than the second, by more than `SOONER`, in more pairs than later."""
    score = 0
    for first, second in pairs:
        own, other = times(results, first), times(results, second)
        score = score + (own + SOONER < other).astype(int) - (other + SOONER < own)
    return proportion_interval(int(np.sum(score > 0)), len(score))
