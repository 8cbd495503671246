"""What every claim's rule needs: the conditions of comparison, the rule for an improvement, and rows of the ledger.

The brief (section 3.2) calls an improvement whose interval contains 0 "not replicated", as it does one below 0. The house has a
word of its own for the first, ``inconclusive``, and it wins here; the reason always says which of the two it was.
`improvement_rule` is the only place where that is decided.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from robins.evaluate.ensembles import Improvement
from robins.evaluate.ledger import FAILED, OVERALL, Row
from robins.evaluate.published import rows_of
from robins.evaluate.verdicts import FAILURE_LIMIT, ON_CLAIMED_SIDE, Verdict, combine
from robins.papers.imani2026.comparisons import PAIR, PRINTED_PAIR, adjusted, improvements, of_channel, sweep_improvements
from robins.papers.imani2026.drive import CHANNELS
from robins.papers.imani2026.sensors import RATE_HZ
from robins.papers.imani2026.studies import outlier_cases
from robins.papers.protocol import Results

MINIMUM = MappingProxyType({"runs": 100, "sweep_runs": 20, "fast_runs": 5})
"""Runs below which a row says ``n too small``: the headline's, a sweep's, and those above the headline's rate (the numbers of the
standard ensemble). Intervals and p values of fewer than fifty runs are made for few: five can never exclude chance."""
SIGNIFICANCE = 0.05
"""Largest p value, adjusted by Holm over the twelve channels, with which an interval off 0 counts as off 0."""
NAMES = MappingProxyType({
    "v_e": "V_e", "v_n": "V_n", "v_u": "V_u", "a_e": "a_e", "a_n": "a_n", "a_u": "a_u",
    "w_e": "omega_e", "w_n": "omega_n", "w_u": "omega_u", "roll": "roll", "pitch": "pitch", "yaw": "yaw",
})  # fmt: skip
"""The channels as the paper's tables call them."""
STUDIES = ("outliers", "grades", "rates")
"""Studies whose rows the claims about the paper's comparison judge."""


class Case(NamedTuple):
    """A condition under which two filters are compared.

    Attributes
    ----------
    words : str
        The ledger's condition.
    pair : tuple of str
        Numerator and denominator: variants, or filters of a study.
    formulation, against : str
        Of a variant's job.
    study, where : str, mapping
        A study and its labels, instead of these two.
    size : str
        Entry of `MINIMUM`.
    """

    words: str
    pair: tuple[str, str] = PAIR
    formulation: str = "F1"
    against: str = "truth"
    study: str = ""
    where: Mapping = MappingProxyType({})
    size: str = "runs"

    @property
    def name(self) -> str:
        """``numerator/denominator``."""
        return "/".join(self.pair)

    def compare(self, results: Results, metric: str) -> Improvement:
        """The improvement in a metric, all twelve channels."""
        if self.study:
            return sweep_improvements(results, self.study, self.where, *self.pair, metric)
        return improvements(results, *self.pair, self.formulation, self.against, metric)


HEADLINE = Case("F1")
"""Tuned filters in F1 against the truth: 10 Hz, zero-mean normal-inverse-Gaussian gyro noise, no outliers added."""
OTHERS = (
    Case("F0", formulation="F0"),
    Case("F2", formulation="F2"),
    Case("F1, against the reference", against="reference"),
    Case("F1, weights on R", ("mk-norm", "ci-seq")),
    Case("F1, corrected CI-RKF", ("mk-norm-gain", "ci-corr")),
    Case("F1, conventional settings", ("mk-norm-gain-nominal", "ci-seq-nominal")),
    Case("F1, as printed", PRINTED_PAIR),
    Case("F0, as printed", PRINTED_PAIR, formulation="F0"),
)
"""One assumption changed at a time; rows beside the headline's that do not enter the overall verdict."""
VARIANT_NEEDS = tuple(dict.fromkeys(name for case in (HEADLINE, *OTHERS) for name in case.pair))


def sweep_cases(results: Results, pair: tuple[str, str] = PAIR) -> list[Case]:
    """The conditions of the outlier sweep, the sensor grades and the rates."""
    return [*outlier_sweep(pair), *grade_sweep(pair), *rate_sweep(results, pair)]


def outlier_sweep(pair: tuple[str, str] = PAIR) -> list[Case]:
    """Noise laws, sides and rates of outliers, with the settings tuned without any; at 2 % two-sided tuned again as well."""
    cases = []
    for labels in outlier_cases():
        words = f"F1, {labels['law']}, no outliers added"
        if labels["rate"] > 0:
            words = f"F1, {labels['law']}, {labels['rate']:.0%} {labels['sided']} outliers"
        cases.append(Case(words, pair, study="outliers", where={**labels, "tuned": "headline"}, size="sweep_runs"))
    labels = {"law": "nig-zero-mean", "sided": "two-sided", "rate": 0.02, "tuned": "outliers"}
    words = "F1, nig-zero-mean, 2% two-sided outliers, tuned again"
    return [*cases, Case(words, pair, study="outliers", where=labels, size="sweep_runs")]


def grade_sweep(pair: tuple[str, str] = PAIR) -> list[Case]:
    """Sensor grades."""
    grades = ("vehicle", "atomic-ideal")
    return [Case(f"F1, {grade} sensors", pair, study="grades", where={"grade": grade}, size="sweep_runs") for grade in grades]


def rate_sweep(results: Results, pair: tuple[str, str] = PAIR) -> list[Case]:
    """Sampling rates, with the noise of a sample or its density kept."""
    return [
        Case(f"F1, {rate_hz} Hz, {noise.replace('-', ' ')}", pair, study="rates", where={"rate_hz": rate_hz, "noise": noise},
             size="fast_runs" if rate_hz > RATE_HZ else "sweep_runs")
        for rate_hz in results.settings.options["rates_hz"]
        for noise in ("equal-sample", "equal-psd")
    ]  # fmt: skip


def side_of_zero(found: Improvement, p: float) -> str:
    """Where a channel's interval lies: ``above`` or ``below`` 0, or ``neither``, also where Holm's p value is too large."""
    if p > SIGNIFICANCE or found.low <= 0 <= found.high:
        return "neither"
    return "above" if found.low > 0 else "below"


def improvement_rule(
    found: Improvement, p: float, minimum: int, threshold: float | None = None, best: Verdict = Verdict.REPLICATED
) -> tuple[Verdict, str]:
    """Judge an improvement of one channel.

    * fewer than `minimum` runs: ``n too small``;
    * fewer than two runs survive in both filters: ``not replicated``;
    * the 95 % interval contains 0, or lies off 0 only before Holm's adjustment: ``inconclusive``;
    * it lies below 0: ``not replicated``;
    * above 0, and either filter fails in more than 5 % of the runs, or the interval ends below `threshold`: ``direction only``;
    * above 0 otherwise: `best`.

    An interval that contains both 0 and the threshold supports neither: 0 is looked at first.

    Parameters
    ----------
    found : Improvement
        Of one channel.
    p : float
        Its p value adjusted by Holm over the twelve channels.
    minimum : int
    threshold : float, optional
        Lower end of the published range, a fraction; the range ends at 1, which nothing passes.
    best : Verdict
        The word for an interval on the claimed side where there is no threshold.
    """
    if found.n < minimum:
        return Verdict.TOO_SMALL, f"{found.n} runs; the rule asks for at least {minimum}."
    lost = lost_runs(found)
    if found.survivors < 2:
        return Verdict.NOT_REPLICATED, f"Fewer than two runs survive in both filters, so there is no improvement.{lost}"
    text = (
        f"Improvement {percent(found.estimate)} (95 % interval {percent(found.low)} to {percent(found.high)}, {found.n} runs, "
        f"Holm p {p:.2g})"
    )
    side = side_of_zero(found, p)
    if side == "neither":
        contains = found.low <= 0 <= found.high
        why = "the interval contains 0" if contains else "it lies off 0 only before Holm's adjustment, so it counts as containing 0"
        undecidable = 2 * len(CHANNELS) > SIGNIFICANCE * 2**found.n  # the smallest p of so few runs, by exchanges, after Holm
        few = f" Holm over twelve channels cannot decide with {found.n} runs." if undecidable else ""
        short = f" and ends below {percent(threshold)}" if threshold is not None and found.high < threshold else ""
        return Verdict.INCONCLUSIVE, f"{text}; {why}{short}.{few}{lost}"
    if side == "below":
        return Verdict.NOT_REPLICATED, f"{text}; the interval lies below 0.{lost}"
    if max(found.numerator_failed, found.denominator_failed) > FAILURE_LIMIT * found.n:
        limit = f"A filter that fails in more than {FAILURE_LIMIT:.0%} of the runs is never replicated."
        return Verdict.DIRECTION_ONLY, f"{text}; the interval lies above 0.{lost} {limit}"
    if threshold is None:
        return best, f"{text}; the interval lies above 0.{lost}"
    reached = found.high >= threshold
    where = "reaches" if reached else "ends below"
    reason = f"{text}; the interval lies above 0 and {where} {percent(threshold)}.{lost}"
    return (Verdict.REPLICATED if reached else Verdict.DIRECTION_ONLY), reason


def percent(fraction: float) -> str:
    """A fraction in per cent, four digits: 99 and 99.9 must not look alike."""
    return f"{100 * fraction:.4g} %"


def lost_runs(found: Improvement) -> str:
    """A sentence about failed runs, empty when none failed."""
    if not (found.numerator_failed or found.denominator_failed):
        return ""
    return (
        f" Failed runs count as losses: the numerator's filter failed in {found.numerator_failed}, the denominator's in "
        f"{found.denominator_failed} of {found.n}."
    )


class Cell(NamedTuple):
    """One channel and metric of a case, judged."""

    channel: str
    metric: str
    found: Improvement
    verdict: Verdict
    reason: str

    @property
    def name(self) -> str:
        """``channel metric`` for a sentence."""
        return f"{NAMES[self.channel]} {self.metric}"


def cells_of(
    results: Results, case: Case, channels: Iterable[str], metrics: Iterable[str] = ("rmse",), threshold: float | None = None,
    best: Verdict = Verdict.REPLICATED,
) -> list[Cell]:  # fmt: skip
    """Cells judged by `improvement_rule`; Holm over the twelve channels of each metric, whichever are asked for."""
    cells = []
    for metric in metrics:
        found = case.compare(results, metric)
        p_values = adjusted(found)
        for channel in channels:
            one = of_channel(found, channel)
            verdict, reason = improvement_rule(one, p_values[CHANNELS.index(channel)], MINIMUM[case.size], threshold, best)
            cells.append(Cell(channel, metric, one, verdict, reason))
    return cells


def conjunction(verdicts: Sequence[Verdict]) -> Verdict:
    """One word for a claim that something holds everywhere: a single contradiction denies it, a single doubt leaves it open."""
    words = set(verdicts)
    for word in (Verdict.TOO_SMALL, Verdict.NOT_REPLICATED, Verdict.INCONCLUSIVE):
        if word in words:
            return word
    return Verdict.REPLICATED if words == {Verdict.REPLICATED} else Verdict.DIRECTION_ONLY


def majority(verdicts: Sequence[Verdict]) -> Verdict:
    """One word for a claim that something holds in most: open while the doubtful ones could make a majority."""
    if Verdict.TOO_SMALL in verdicts:
        return Verdict.TOO_SMALL
    above = sum(word in ON_CLAIMED_SIDE for word in verdicts)
    if 2 * above > len(verdicts):
        return Verdict.DIRECTION_ONLY
    open_ones = sum(word == Verdict.INCONCLUSIVE for word in verdicts)
    return Verdict.INCONCLUSIVE if 2 * (above + open_ones) > len(verdicts) else Verdict.NOT_REPLICATED


def tally(cells: Sequence[Cell]) -> str:
    """A sentence that counts the cells on each side of 0 and names all but the commonest kind."""
    if any(cell.verdict == Verdict.TOO_SMALL for cell in cells):
        return f"{cells[0].found.n} runs are too few for a verdict."
    kinds: dict[str, list[str]] = {"above 0": [], "containing 0 or off it only before Holm": [], "below 0 or without surviving runs": []}
    for cell in cells:
        kind = 0 if cell.verdict in ON_CLAIMED_SIDE else 1 if cell.verdict == Verdict.INCONCLUSIVE else 2
        kinds[list(kinds)[kind]].append(cell.name)
    commonest = max(kinds, key=lambda kind: len(kinds[kind]))
    told = [f"{len(names)} {kind}" + (f" ({', '.join(names)})" if names and kind != commonest else "") for kind, names in kinds.items()]
    return f"Of {len(cells)} intervals {', '.join(told)}.{lost_runs(cells[0].found)}"


def cells_row(
    claim_id: str, quantity: str, case: Case, cells: Sequence[Cell], together: Callable = conjunction, condition: str = "", note: str = ""
) -> Row:  # fmt: skip
    """One row for several cells; for a single one with its numbers."""
    condition = condition or case.words
    if len(cells) == 1:
        return improvement_row(claim_id, quantity, condition, case, cells[0], note)
    above = sum(cell.verdict in ON_CLAIMED_SIDE for cell in cells)
    ours = f"{above} of {len(cells)} improve" if cells[0].found.n >= MINIMUM[case.size] else ""
    verdict = together([cell.verdict for cell in cells])
    return Row(claim_id, quantity, condition, ours, "", "", cells[0].found.n, case.name, verdict, f"{note}{tally(cells)}")


def improvement_row(claim_id: str, quantity: str, condition: str, case: Case, cell: Cell, note: str = "", **more) -> Row:
    """A row with an improvement in per cent; one without an interval has the word ``failed``."""
    found = cell.found
    numbers = (FAILED, "", "")
    if found.survivors > 1:
        numbers = tuple(100 * float(value) for value in (found.estimate, found.low, found.high))
    return Row(claim_id, quantity, condition, *numbers, found.n, case.name, cell.verdict, f"{note}{cell.reason}", unit="%", **more)


def without_interval(claim_id: str, quantity: str, n: int, variant: str, verdict: str, reason: str, condition=OVERALL, ours="") -> Row:
    """A row that holds a verdict and its reason, no estimate with an interval."""
    return Row(claim_id, quantity, condition, ours, "", "", n, variant, verdict, reason)


def combine_many(verdicts: Mapping[str, str]) -> tuple[Verdict, str]:
    """`robins.evaluate.verdicts.combine`, with a reason that counts and names the parts of all but the commonest verdict."""
    verdict, _ = combine(verdicts)
    parts = {word: [name for name, found in verdicts.items() if found == word] for word in dict.fromkeys(verdicts.values())}
    commonest, *rest = sorted(parts, key=lambda word: -len(parts[word]))
    told = [f"{len(parts[commonest])} of {len(verdicts)} {commonest}"]
    told += [f"{len(parts[word])} {word} ({'; '.join(parts[word])})" for word in rest]
    return verdict, f"{', '.join(told)}."


def ends(low: float, high: float) -> tuple[float | str, float | str]:
    """Both ends of an interval, or nothing when it is not finite."""
    return (float(low), float(high)) if np.isfinite([low, high]).all() else ("", "")


def printed_end(results: Results, claim_id: str, column: str) -> float:
    """An end of the range that the paper prints for a claim, in per cent: `column` is ``value`` or ``value_high``."""
    (text,) = {text for text in rows_of(results.published, claim_id)[column] if text}
    return float(text)
