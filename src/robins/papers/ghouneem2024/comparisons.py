"""What the wing's tables, figures and claims share: scores by run, geometric means, paired ratios, and the attribution to three parts.

A row of a table of scores is found by its labels: every column in front of ``run``.
"""

from collections.abc import Mapping
from itertools import combinations
from math import factorial
from typing import NamedTuple

import numpy as np
import pandas as pd

from robins.evaluate.geometric import GeometricMean, GeometricRatio, geometric_mean, geometric_ratio, mean_of_logs
from robins.evaluate.intervals import Interval
from robins.foundation.randomness import stream
from robins.papers.ghouneem2024.trajectories import KEY
from robins.papers.ghouneem2024.variants import VARIANTS, variant_name
from robins.papers.memory import once
from robins.papers.protocol import Results

__all__ = [
    "HEADLINE", "PARTS", "GeometricMean", "GeometricRatio", "Where", "attribution", "cell", "mean_of", "ratio_of", "rows", "values",
    "variant", "where",
]  # fmt: skip

HEADLINE = "t1"
"""Whose tuning runs give the settings of the headline."""
PARTS = ("filter", "self-tuning", "gate")


class Where(NamedTuple):
    """Rows of a job's table: the job, and the labels that choose them."""

    job: str
    labels: tuple[tuple[str, object], ...]

    @property
    def words(self) -> str:
        """As a part of a stream's name."""
        return "-".join([self.job, *(f"{value:g}" if isinstance(value, float) else str(value) for _, value in self.labels)])


def where(job: str, **labels) -> Where:
    """Rows of the table of `job` with these labels."""
    return Where(job, tuple(sorted(labels.items())))


def variant(name: str, place: str, frozen: str = HEADLINE) -> Where:
    """A variant on a trajectory; `frozen` is the trajectory whose settings it has, where it has tuned ones."""
    tuned = VARIANTS[name].composition.get("cell", "none") != "none"
    return where(name, trajectory=place, frozen=frozen if tuned else "none")


def rows(results: Results, at: Where) -> pd.DataFrame:
    """The rows, one for each run, runs in order.

    Raises
    ------
    LookupError
        There is none.
    """

    def make() -> pd.DataFrame:
        table = results.table(at.job)
        chosen = np.ones(len(table), bool)
        for name, value in at.labels:
            chosen &= (table[name] == value).to_numpy()
        if not chosen.any():
            raise LookupError(f"{at.job} has no row with {dict(at.labels)}")
        return table[chosen].sort_values("run")

    return once(results, ("rows", at), make)


def values(results: Results, at: Where, measure: str) -> tuple[np.ndarray, np.ndarray]:
    """A measure by run, and which runs failed."""
    found = rows(results, at)
    return found[measure].to_numpy(float), found["failed"].to_numpy(bool)


def resampling(results: Results, what: str) -> np.random.Generator:
    """The bootstrap's stream for one comparison."""
    return stream(results.settings.seed, f"{KEY}/bootstrap/0/{what}")


def mean_of(results: Results, at: Where, measure: str) -> GeometricMean:
    """Geometric mean of a measure over the runs, with its interval."""

    def make() -> GeometricMean:
        return geometric_mean(*values(results, at, measure), resampling(results, at.words), results.settings.sizes["bootstrap"])

    return once(results, ("mean", at, measure), make)


def ratio_of(results: Results, numerator: Where, denominator: Where, measure: str) -> GeometricRatio:
    """Paired ratio of a measure; only runs that both have are compared (a study in sample has fewer)."""

    def make() -> GeometricRatio:
        above, below = (rows(results, at).set_index("run") for at in (numerator, denominator))
        common = above.index.intersection(below.index)
        above, below = above.loc[common], below.loc[common]
        generator = resampling(results, f"{numerator.words}-over-{denominator.words}")
        return geometric_ratio(
            above[measure].to_numpy(float), below[measure].to_numpy(float), above["failed"].to_numpy(bool), below["failed"].to_numpy(bool),
            generator, results.settings.sizes["bootstrap"],
        )  # fmt: skip

    return once(results, ("ratio", numerator, denominator, measure), make)


def cell(filter_name: str, self_tuning: bool, gate: bool) -> str:
    """The variant in a cell of the factorial."""
    name = {(False, False): "none", (False, True): "gate", (True, False): "st", (True, True): "st-gate"}[self_tuning, gate]
    return variant_name(filter_name, name)


def logs(results: Results, baseline: str, place: str, frozen: str, measure: str) -> tuple[dict[frozenset, np.ndarray], int, int]:
    """Logarithms of a measure in the eight cells between a baseline and the UKF, by the set of parts that are new.

    Runs that fail in a cell are left out of all; their number, and that of all runs, is returned too.
    """
    found, lost = {}, None
    for size in range(len(PARTS) + 1):
        for parts in combinations(PARTS, size):
            name = cell("ukf" if "filter" in parts else baseline, "self-tuning" in parts, "gate" in parts)
            measured, failed = values(results, variant(name, place, frozen), measure)
            found[frozenset(parts)] = measured
            lost = failed if lost is None else lost | failed
    return {parts: np.log(measured[~lost]) for parts, measured in found.items()}, int(lost.sum()), lost.size


class Attribution(NamedTuple):
    """What each part adds to the logarithm of a measure, from the baseline to the new method.

    Attributes
    ----------
    parts : dict of str to Interval
        Shapley value of each of `PARTS`; below zero where the part makes the error smaller.
    total : Interval
        Their sum: the whole change of the logarithm.
    failed : int
        Runs left out because they failed in a cell.
    """

    parts: dict[str, Interval]
    total: Interval
    failed: int


def shapley(cells: Mapping[frozenset, np.ndarray], part: str) -> np.ndarray:
    """Shapley value of a part in every run: its mean effect over all orders in which the parts may be added."""
    others = [name for name in PARTS if name != part]
    total = 0.0
    for size in range(len(others) + 1):
        weight = factorial(size) * factorial(len(others) - size) / factorial(len(PARTS))
        for chosen in combinations(others, size):
            total = total + weight * (cells[frozenset({*chosen, part})] - cells[frozenset(chosen)])
    return total


def attribution(results: Results, baseline: str, place: str, frozen: str = HEADLINE, measure: str = "horizontal") -> Attribution:
    """The change from a baseline (data sheet's variances, no gate) to the new method, attributed to its three parts."""

    def make() -> Attribution:
        cells, failed, n = logs(results, baseline, place, frozen, measure)

        def interval(change: np.ndarray, what: str) -> Interval:
            generator = resampling(results, f"shapley-{baseline}-{place}-{frozen}-{measure}-{what}")
            low, high = mean_of_logs(change, generator, results.settings.sizes["bootstrap"])
            return Interval(float(change.mean()) if change.size else float("nan"), low, high, n)

        parts = {part: interval(shapley(cells, part), part) for part in PARTS}
        return Attribution(parts, interval(cells[frozenset(PARTS)] - cells[frozenset()], "total"), failed)

    return once(results, ("attribution", baseline, place, frozen, measure), make)


def anova_shares(results: Results, baseline: str, place: str, frozen: str = HEADLINE, measure: str = "horizontal") -> dict[str, float]:
    """Share of the sum of squares that each factor, interaction and the runs have in the eight cells: ANOVA of the log measure."""
    from statsmodels.formula.api import ols  # a second of imports, for one table
    from statsmodels.stats.anova import anova_lm

    cells, _, _ = logs(results, baseline, place, frozen, measure)
    frame = pd.concat(
        [
            pd.DataFrame({"y": y, "run": np.arange(y.size), "new_filter": "filter" in parts, "tuned": "self-tuning" in parts,
                          "gated": "gate" in parts})
            for parts, y in cells.items()
        ]
    )  # fmt: skip
    if frame["run"].nunique() < 2:
        return {}
    squares = anova_lm(ols("y ~ C(run) + C(new_filter) * C(tuned) * C(gated)", frame).fit(), typ=2)["sum_sq"]
    names = {"C(run)": "run", "C(new_filter)": "filter", "C(tuned)": "self-tuning", "C(gated)": "gate", "Residual": "residual"}

    def label(term: str) -> str:
        return " x ".join(names[part] for part in term.split(":"))

    return {label(term): float(value / squares.sum()) for term, value in squares.items()}
