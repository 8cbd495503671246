"""Claims about noise and statistics: the residuals' moments (C5), their tests (C6), the chi-square increment (C14)."""

from typing import NamedTuple

from scipy import stats

from robins.evaluate.ledger import Row
from robins.evaluate.verdicts import Verdict
from robins.papers.imani2026.judging import MINIMUM, without_interval
from robins.papers.imani2026.theory import NORMALITY_LEVEL, PROBABILITIES, shape_of
from robins.papers.protocol import Results

AXES = "xyz"
CONSTRUCTION = "The noise law is built to have these moments, so that no run of it can find them out."
CONVENTION = (
    "A Gaussian has skewness 0 and kurtosis 3, excess 0: right, but the paper sets the raw 3 beside an excess of 19.91. If 19.91 is raw "
    "too, the excess is 16.91."
)
REJECTED = ("Shapiro-Wilk", "Lilliefors")
MATERIAL = 0.05
"""Relative deviation of an exceedance that could be chance alone in one of many intervals: it refutes nothing."""
MAJORITY = 0.5
"""Share of runs above which a test counts as rejecting."""


class Fact(NamedTuple):
    """One row of the theory study."""

    expected: float
    value: float
    low: float
    high: float
    n: int


def fact(results: Results, quantity: str) -> Fact:
    """A row of the theory study by its quantity."""
    table = results.table("theory").set_index("quantity")
    row = table.loc[quantity]
    return Fact(*(float(row[name]) for name in Fact._fields[:-1]), int(row["n"]))


def judge_moments(results: Results) -> list[Row]:
    """C5: sample moments of run 0 beside the paper's, with the central 95 % of samples of the same law and length."""
    residuals = results.arrays("drive")["residual.gyroscope"]
    names = ("skewness", "excess kurtosis")
    rows = []
    for axis, samples in zip(AXES, residuals.T, strict=True):
        for name, value in zip(names, shape_of(samples), strict=True):
            spread = fact(results, f"sample {name}, {len(samples)} samples")
            inside = "inside" if spread.low <= value <= spread.high else "outside"
            reason = (
                f"{CONSTRUCTION} This sample is {inside} the central 95 % of {spread.n} records of {len(samples)} samples, which stands in "
                "place of an interval."
            )
            numbers = (value, spread.low, spread.high)
            rows.append(
                Row("C5", f"gyro residual {name}", f"run 0, {axis} axis", *numbers, 1, "drive", Verdict.UNTESTABLE, reason, unit="1")
            )
    for name in ("skewness", "kurtosis"):
        rows.append(without_interval("C5", f"Gaussian reference {name}", 0, "drive", Verdict.COMPATIBLE, CONVENTION, "arithmetic"))
    spreads = {name: fact(results, f"sample {name}, {len(residuals)} samples") for name in names}
    told = "; ".join(f"{name} {found.low:.3g} to {found.high:.3g}" for name, found in spreads.items())
    quantity = "accelerometer and gyroscope residual histograms heavy-tailed"
    rows.append(without_interval("C5", quantity, 1, "drive", Verdict.UNTESTABLE, CONSTRUCTION, "run 0"))
    reason = (
        f"{CONSTRUCTION} One record of {len(residuals)} samples of this law shows {told} in 95 % of cases, so that the printed pair names "
        "no law."
    )
    return [*rows, without_interval("C5", "gyro residual skewness and excess kurtosis", 1, "drive", Verdict.UNTESTABLE, reason)]


def rejection_rule(found: Fact) -> tuple[Verdict, str]:
    """Do the tests reject? If so it is no finding: the law was built not to be normal."""
    if found.n < MINIMUM["runs"]:
        return Verdict.TOO_SMALL, f"{found.n} runs; the rule asks for at least {MINIMUM['runs']}."
    text = f"p < {NORMALITY_LEVEL} in {found.value:.1%} of {found.n} runs (95 % interval {found.low:.1%} to {found.high:.1%})"
    if found.low > MAJORITY:
        return (
            Verdict.COMPATIBLE,
            f"{text}. The constructed law is far from normal, so that a rejection says nothing beyond the construction.",
        )
    if found.high < MAJORITY:
        return Verdict.NOT_REPLICATED, f"{text}: the test does not reject in most runs."
    return Verdict.INCONCLUSIVE, f"{text}: the interval contains {MAJORITY:.0%}."


def judge_normality(results: Results) -> list[Row]:
    """C6: share of runs in which normality is rejected."""
    quantities = {
        ("Shapiro-Wilk", "gyroscope"): "Shapiro-Wilk p-value, gyro",
        ("Lilliefors", "gyroscope"): "Kolmogorov-Smirnov test used, no result given",
    }
    rows = []
    for test in REJECTED:
        for name in ("gyroscope", "accelerometer", "normal noise"):
            found = fact(results, f"share of runs rejected, {test}, {name}")
            verdict, reason = rejection_rule(found)
            if name == "normal noise" and verdict != Verdict.TOO_SMALL:
                right = found.low <= NORMALITY_LEVEL <= found.high
                verdict = Verdict.COMPATIBLE if right else Verdict.INCONCLUSIVE
                reason = f"Control: rejected in {found.value:.1%} of {found.n} runs, where {NORMALITY_LEVEL:.0%} is right."
            quantity = quantities.get((test, name), f"share of runs rejected, {name}")
            condition = f"{test}, {name}"
            rows.append(
                Row("C6", quantity, condition, found.value, found.low, found.high, found.n, "drive", verdict, f"Share of runs. {reason}")
            )
    decided = rows[0]
    reason = (
        f"Gyro, first axis, Shapiro-Wilk. {decided.reason} Both tests assume independent samples. The relation sign of the paper's "
        f"p-value is missing; read as below {NORMALITY_LEVEL}."
    )
    quantity = "gyro data deviate significantly from Gaussian"
    return [*rows, without_interval("C6", quantity, decided.n, "drive", decided.verdict, reason)]


def judge_increment(results: Results) -> list[Row]:
    """C14: is (30) a chi-square variable with one degree of freedom, as (34) says? An analytic claim, with a Monte-Carlo check."""
    defined, freedom = "chi-square increment defined as difference of consecutive steps", "degrees of freedom of the increment under H0"
    rows = []
    for m in (6, 1):
        for probability in PROBABILITIES:
            threshold = float(stats.chi2.ppf(probability, 1))
            for words, kind in (("difference in time", "(30)"), ("sequential increment", "(31), control")):
                found = fact(results, f"exceedance of {threshold:.3f}, {words}, n = {m}")
                nominal = 1 - probability
                refuted = not found.low <= nominal <= found.high and abs(found.value / nominal - 1) > MATERIAL
                reason = (
                    f"Exceeds {threshold:.3f} with probability {found.value:.4g} (95 % interval {found.low:.4g} to {found.high:.4g}, "
                    f"{found.n} draws); chi-square with one degree of freedom does with {nominal:.2g}, theory for this definition says "
                    f"{found.expected:.4g}."
                )
                verdict = Verdict.REFUTED if refuted else Verdict.REPLICATED
                condition = f"{kind}, {m} channel{'s' * (m > 1)}, exceedance of {threshold:.3f}"
                rows.append(Row("C14", defined, condition, found.value, found.low, found.high, found.n, "ci-temp", verdict, reason))
    (decisive,) = [row for row in rows if row.condition.startswith("(30), 6") and "3.841" in row.condition]
    reason = (
        f"The difference of two chi-square variables has a symmetric law with variance 4n and cannot follow (34). {decisive.reason} The "
        "sequential increments of (31), which the source method means, do follow it."
    )
    return [*rows, without_interval("C14", freedom, 0, "ci-temp", decisive.verdict, reason)]
