"""What the wing's tables and claims share: scores by run, paired ratios, units as labelled.

A run's scores are kept by (branch, condition, estimate) as arrays, and each paired ratio is computed once for a
`Results`, since its bootstrap is what costs.
"""

from typing import NamedTuple

import numpy as np

from robins.evaluate.intervals import RatioSummary, paired_ratio
from robins.evaluate.published import published_value
from robins.evaluate.verdicts import Verdict, bootstrap_remark, failures, side_of_one, too_many_failures
from robins.foundation.randomness import stream
from robins.navigation.aircraft import ANGULAR, STATES
from robins.papers.hajiyev2023.scenario import BRANCHES, CONDITIONS, KEY, System, baseline, differenced, system
from robins.papers.memory import once
from robins.papers.protocol import Results

MDKF, AMDKF = "mdkf-printed", "amdkf-printed"
LONGITUDINAL, LATERAL = STATES[:4], STATES[4:]
FAULTY = ("q", "theta")
RATES = ("q", "p", "r")
PRINTED = ("mdkf-printed", "amdkf-printed", "amdkf-gated", "amdkf-scalar-trace", "amdkf-scalar-mean")
"""Variants whose only estimate of x(k) is the delayed one, from z(0..k+1)."""


class Pair(NamedTuple):
    """Two variants that are compared, numerator over denominator, and the kind of estimate of those that have both."""

    numerator: str
    denominator: str
    estimate: str = "delayed"

    @property
    def name(self) -> str:
        """``numerator/denominator``."""
        return f"{self.numerator}/{self.denominator}"

    @property
    def needs(self) -> tuple[str, str]:
        """The two jobs."""
        return self.numerator, self.denominator

    @property
    def kinds(self) -> tuple[str, str]:
        """The kind of estimate of each: ``delayed`` for the printed filters, which have no other."""
        return tuple("delayed" if name in PRINTED else self.estimate for name in self.needs)


ADAPTED = Pair(AMDKF, MDKF)
"""The comparison of Table 1."""


class Scores(NamedTuple):
    """Scores of a variant in one branch and condition, one kind of estimate; `robins.papers.hajiyev2023.ensemble.variant`.

    Attributes
    ----------
    rmse, scale, gain_norm, own_gain : ndarray, shape (runs, 8)
        RMSE by equation (29), SI; mean scale factor, norm of the gain's column and size of its own element over k = 100..149.
    nis_settled, nis_window : ndarray, shape (runs,)
        Mean NIS over k >= 30 and over k = 80..149.
    failed : ndarray of bool, shape (runs,)
    """

    rmse: np.ndarray
    scale: np.ndarray
    gain_norm: np.ndarray
    own_gain: np.ndarray
    nis_settled: np.ndarray
    nis_window: np.ndarray
    failed: np.ndarray


def scores(results: Results, variant: str, branch: str, condition: str, estimate: str = "delayed") -> Scores:
    """The scores of a variant; see `Scores`."""
    return once(results, ("scores", variant), lambda: _arranged(results, variant))[branch, condition, estimate]


def kinds(results: Results, variant: str) -> list[str]:
    """Which estimates a variant has: ``filtered``, ``delayed`` or both."""
    return list(results.table(variant)["estimate"].unique())


def _arranged(results: Results, variant: str) -> dict[tuple[str, str, str], Scores]:
    arranged = {}
    for key, group in results.table(variant).groupby(["branch", "condition", "estimate"], sort=False):
        group = group.sort_values("run", kind="stable")
        if not np.array_equal(group["state"].to_numpy().reshape(-1, 8), np.tile(STATES, (len(group) // 8, 1))):
            raise ValueError(f"{variant}, {', '.join(key)}: not one row for each run and state in the order of the states")
        columns = {name: group[name].to_numpy().reshape(-1, 8) for name in Scores._fields}
        for name in ("nis_settled", "nis_window", "failed"):
            columns[name] = columns[name][:, 0]
        arranged[key] = Scores(**columns)
    return arranged


def summary_of(results: Results, what: str, state: str, numerator, denominator, lost, won) -> RatioSummary:
    """`robins.evaluate.intervals.paired_ratio` of a state with a bootstrap stream named by `what` and the state."""
    generator = stream(results.settings.seed, f"{KEY}/bootstrap/{STATES.index(state)}/{what}")
    return paired_ratio(numerator, denominator, generator, results.settings.sizes["bootstrap"], lost, won)


def ratio(results: Results, pair: Pair, branch: str, condition: str, state: str) -> RatioSummary:
    """The paired ratio of the RMSE of two variants."""

    def make() -> RatioSummary:
        above, below = (scores(results, name, branch, condition, kind) for name, kind in zip(pair.needs, pair.kinds, strict=True))
        i = STATES.index(state)
        what = f"{pair.numerator}-over-{pair.denominator}-{pair.estimate}-{branch}-{condition}"
        return summary_of(results, what, state, above.rmse[:, i], below.rmse[:, i], above.failed, below.failed)

    return once(results, ("ratio", pair, branch, condition, state), make)


def fault_ratio(results: Results, variant: str, what: str, branch: str, state: str, estimate: str = "delayed") -> RatioSummary:
    """A score of one variant (a field of `Scores`) with the fault over the same without it; same runs, same noise."""

    def make() -> RatioSummary:
        above, below = (scores(results, variant, branch, condition, estimate) for condition in CONDITIONS)
        values = [getattr(side, what)[:, STATES.index(state)] for side in (above, below)]
        return summary_of(results, f"{variant}-{what}-{estimate}-{branch}-fault-over-healthy", state, *values, above.failed, below.failed)

    return once(results, ("fault", variant, what, branch, state, estimate), make)


def harm_ratio(results: Results, pair: Pair, branch: str, state: str) -> RatioSummary:
    """How much more the fault multiplies the numerator's error than the denominator's, paired by run."""
    i = STATES.index(state)
    fault, healthy = ([scores(results, name, branch, condition, pair.estimate) for name in pair.needs] for condition in CONDITIONS)
    with np.errstate(invalid="ignore", over="ignore"):  # runs that failed may hold anything
        above, below = (fault[side].rmse[:, i] / healthy[side].rmse[:, i] for side in (0, 1))
    lost, won = (fault[side].failed | healthy[side].failed for side in (0, 1))
    what = f"{pair.numerator}-over-{pair.denominator}-{pair.estimate}-{branch}-harm"
    return summary_of(results, what, state, above, below, lost, won)


def direction_rule(summary: RatioSummary, side: str, minimum: int, best: Verdict = Verdict.DIRECTION_ONLY) -> tuple[Verdict, str]:
    """The ratio rule where the paper prints no ratio: only on which side of 1 the 95 % interval lies.

    Parameters
    ----------
    summary : RatioSummary
    side : {"better", "worse"}
        "better": below 1.
    minimum : int
        Runs below which no verdict is given.
    best : Verdict
        The word for an interval on the claimed side: ``replicated`` for a claim that prints no number, ``direction only``
        for a case beside the paper's own.
    """
    if summary.n < minimum:
        return Verdict.TOO_SMALL, f"{summary.n} runs; the rule asks for at least {minimum}."
    if not summary.survivors:
        return Verdict.NOT_REPLICATED, f"No run survives in both, so there is no ratio.{failures(summary)}"
    found = (
        f"The geometric mean ratio is {summary.estimate:.4g} (95 % interval {summary.verdict_low:.4g} to {summary.verdict_high:.4g}, "
        f"{summary.n} runs); the claim asks for a ratio {'below' if side == 'better' else 'above'} 1"
    )
    remarks = f"{failures(summary)}{bootstrap_remark(summary)}"
    found_side = side_of_one(summary.verdict_low, summary.verdict_high)
    if found_side == "neither":
        return Verdict.INCONCLUSIVE, f"{found} and the interval contains 1.{remarks}"
    if found_side != side:
        return Verdict.NOT_REPLICATED, f"{found} and the interval lies on the other side.{remarks}"
    verdict = Verdict.DIRECTION_ONLY if too_many_failures(summary) else best
    return verdict, f"{found} and the interval agrees.{remarks}"


def published_rmse(results: Results, state: str, kind: str) -> float:
    """The RMSE of Table 1 in the labelled unit; `kind` is ``MDKF`` or ``AMDKF``."""
    return published_value(results.published, f"C{STATES.index(state) + 1}", f"RMSE {state} {kind}")


def published_ratio(results: Results, state: str) -> float:
    """AMDKF over MDKF in Table 1."""
    return published_rmse(results, state, "AMDKF") / published_rmse(results, state, "MDKF")


def unit(state: str, branch: str) -> str:
    """The unit in which a branch reads Table 1's numbers of a state."""
    return f"{branch}{'/s' * (state in RATES)}" if ANGULAR[STATES.index(state)] else "m/s"


def labelled(values, state: str, branch: str):
    """SI values of a state in the unit of `unit`."""
    return values / baseline(branch).unit[STATES.index(state)]


def matrices(results: Results, branch: str) -> System:
    """The baseline's matrices."""
    return system(baseline(branch), results.settings.options["plant"])


def sensor_share(results: Results, branch: str) -> np.ndarray:
    """R_v / R of each channel: the part of the differenced noise that the white noise makes, shape (8,)."""
    d = differenced(matrices(results, branch))
    return np.diag(d.R_sensor) / np.diag(d.R_process + d.R_sensor)


def expected_scale(results: Results, branch: str) -> dict[str, float]:
    """Scale factors of the faulty channels if (18) held: ``1 + (m^2 - 1) R_v / R`` for a fault of multiplier m."""
    parameters, share = baseline(branch), sensor_share(results, branch)
    multipliers = {"q": parameters.multiplier_q, "theta": parameters.multiplier_theta}
    return {state: 1.0 + (m**2 - 1.0) * share[STATES.index(state)] for state, m in multipliers.items()}


def cases() -> list[tuple[str, str]]:
    """Every (branch, condition)."""
    return [(branch, condition) for branch in BRANCHES for condition in CONDITIONS]
