"""Intervals around what an ensemble says. All are 95 % and two-sided.

References
----------
.. [1] E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209: the score interval of a proportion.
.. [2] B. Efron, J. Am. Stat. Assoc. 82 (1987) 171: the bias-corrected and accelerated (BCa) bootstrap.
"""

from typing import NamedTuple

import numpy as np
from scipy import stats

LEVEL = 0.95
Z = float(stats.norm.ppf((1 + LEVEL) / 2))

TIE = 1e-9
"""Two errors whose logarithms differ by less are equal: tables regenerate no closer than this on another
machine, so a sign read from a smaller difference would be the sign of the rounding."""

BATCH_CELLS = 100_000
"""Resampled values that the bootstrap holds at once: small enough to stay in the processor's cache."""


class Interval(NamedTuple):
    """An estimate, the ends of its 95 % interval and the number of observations behind it."""

    estimate: float | np.ndarray
    low: float | np.ndarray
    high: float | np.ndarray
    n: int


class RatioSummary(NamedTuple):
    """What paired runs say about the ratio of two filters' errors (numerator over denominator).

    Attributes
    ----------
    estimate : float
        Geometric mean over the runs that survive in both filters; NaN when there is none.
    low, high : float
        Its 95 % interval, normal on the log ratio; (0, inf) with fewer than two survivors.
    bca_low, bca_high : float
        The same by the BCa bootstrap.
    verdict_low, verdict_high : float
        The normal interval with each failed run counted as a loss of the filter that failed: as the
        worst ratio any survivor shows for that filter (1 when both failed). Equal to (low, high) when
        no run failed.
    share_below_one : Interval
        Share of all runs that the numerator's filter wins, with its Wilson interval. A failed run is
        lost; one that failed in both filters is won by neither.
    central_low, central_high : float
        Central 95 % of the survivors' single-run ratios.
    median : float
        Median over all runs, a failed run's error being infinite (ratio 1 when both failed).
    n : int
        All runs, failed or not.
    survivors, numerator_failed, denominator_failed : int
        Runs that survive in both filters, and that failed in either.
    """

    estimate: float
    low: float
    high: float
    bca_low: float
    bca_high: float
    verdict_low: float
    verdict_high: float
    share_below_one: Interval
    central_low: float
    central_high: float
    median: float
    n: int
    survivors: int
    numerator_failed: int
    denominator_failed: int

    @property
    def failed(self) -> int:
        """Runs that failed in at least one of the two filters."""
        return self.n - self.survivors


def mean_interval(values: np.ndarray) -> Interval:
    """Mean over the first axis with its Student t interval.

    Parameters
    ----------
    values : ndarray, shape (runs, ...)
        Surviving runs only, all finite.

    Returns
    -------
    Interval
        Fields of shape ``values.shape[1:]``. One run has an infinitely wide interval.

    Raises
    ------
    ValueError
        There is no run, or a value is not finite.
    """
    values = np.asarray(values, dtype=float)
    runs = len(values)
    if not runs or not np.isfinite(values).all():
        raise ValueError("a mean needs at least one run and finite values: leave failed runs out")
    mean = values.mean(axis=0)
    if runs == 1:
        half = np.full_like(mean, np.inf)
    else:
        half = stats.t.ppf((1 + LEVEL) / 2, runs - 1) * values.std(axis=0, ddof=1) / np.sqrt(runs)
    return Interval(mean, mean - half, mean + half, runs)


def proportion_interval(successes: int, n: int) -> Interval:
    """Share of `successes` among `n` with Wilson's score interval [1]_; (NaN, 0, 1) when `n` is zero."""
    if not 0 <= successes <= n:
        raise ValueError(f"{successes} successes among {n}")
    if n == 0:
        return Interval(float("nan"), 0.0, 1.0, 0)
    share = successes / n
    shrink = 1 + Z**2 / n
    centre = (share + Z**2 / (2 * n)) / shrink
    half = Z * np.sqrt(share * (1 - share) / n + Z**2 / (4 * n**2)) / shrink
    # At 0 and n successes an end is exactly 0 or 1; rounding must not push it outside or inside.
    low = 0.0 if successes == 0 else float(centre - half)
    high = 1.0 if successes == n else float(centre + half)
    return Interval(share, low, high, n)


def paired_ratio(
    numerator: np.ndarray,
    denominator: np.ndarray,
    generator: np.random.Generator,
    bootstrap: int = 2000,
    numerator_failed: np.ndarray | None = None,
    denominator_failed: np.ndarray | None = None,
) -> RatioSummary:
    """Summary of ``numerator / denominator`` over paired runs.

    Parameters
    ----------
    numerator, denominator : ndarray, shape (runs,)
        One positive error measure a run, the same run in both; anything where the run failed.
    generator : numpy.random.Generator
        The bootstrap's stream. Give each comparison its own, or its interval depends on the others.
    bootstrap : int
        Number of resamples.
    numerator_failed, denominator_failed : ndarray of bool, shape (runs,), optional
        Runs that failed in each filter.

    Raises
    ------
    ValueError
        Shapes differ, there is no run, or a run that is not marked as failed has an error that is not
        positive and finite.
    """
    numerator, denominator = np.asarray(numerator, dtype=float), np.asarray(denominator, dtype=float)
    n = len(numerator)
    lost = np.zeros(n, dtype=bool) if numerator_failed is None else np.asarray(numerator_failed, dtype=bool)
    won = np.zeros(n, dtype=bool) if denominator_failed is None else np.asarray(denominator_failed, dtype=bool)
    if n == 0 or not numerator.shape == denominator.shape == lost.shape == won.shape == (n,):
        raise ValueError("paired runs need one-dimensional arrays of one length, at least one run")
    both = ~(lost | won)
    errors = np.concatenate([numerator[both], denominator[both]])
    if not (np.isfinite(errors) & (errors > 0)).all():
        raise ValueError("a run that is not marked as failed has an error that is not positive and finite")

    logs = np.log(numerator[both]) - np.log(denominator[both])
    logs[np.abs(logs) < TIE] = 0.0
    estimate, low, high = log_interval(logs)
    bca_low, bca_high = bca_log_interval(logs, generator, bootstrap)
    central = np.quantile(logs, [(1 - LEVEL) / 2, (1 + LEVEL) / 2]) if logs.size else np.full(2, np.nan)
    _, verdict_low, verdict_high = log_interval(with_losses(logs, lost, won))

    ratios = np.ones(n)
    ratios[both] = np.exp(logs)
    ratios[lost & ~won], ratios[won & ~lost] = np.inf, 0.0
    return RatioSummary(
        *np.exp([estimate, low, high, bca_low, bca_high, verdict_low, verdict_high]).tolist(),
        proportion_interval(int(np.sum(ratios < 1)), n),
        *np.exp(central).tolist(),
        float(np.median(ratios)),
        n,
        int(both.sum()),
        int(lost.sum()),
        int(won.sum()),
    )


def log_interval(logs: np.ndarray) -> tuple[float, float, float]:
    """Mean of `logs`, shape (runs,), with its normal interval; infinitely wide with fewer than two runs."""
    if logs.size < 2:
        return float(logs.mean()) if logs.size else float("nan"), float("-inf"), float("inf")
    mean, half = float(logs.mean()), Z * float(logs.std(ddof=1)) / np.sqrt(logs.size)
    if np.ptp(logs) < TIE:  # the same in every run: nothing is uncertain
        half = 0.0
    return mean, mean - half, mean + half


def rounded_mean(values: np.ndarray, axis: int = -1) -> np.ndarray:
    """Mean along `axis`, to ten decimals.

    In a small sample some resamples are permutations of it. Whether their mean lies below the sample's, which the BCa
    formula counts, would otherwise be decided by the last bit, and differ between machines.
    """
    return np.round(np.mean(values, axis=axis), 10)


def bca_log_interval(logs: np.ndarray, generator: np.random.Generator, resamples: int) -> tuple[float, float]:
    """BCa interval [2]_ of the mean of `logs`, shape (runs,); the point itself when all are equal."""
    if logs.size < 2:
        return float("-inf"), float("inf")
    if np.ptp(logs) < TIE:  # no spread, no acceleration: the BCa formula is 0/0
        return (float(logs.mean()),) * 2
    interval = stats.bootstrap(
        (logs,),
        rounded_mean,
        n_resamples=resamples,
        batch=max(1, BATCH_CELLS // logs.size),
        vectorized=True,
        confidence_level=LEVEL,
        method="BCa",
        rng=generator,
    ).confidence_interval
    return float(interval.low), float(interval.high)


def with_losses(logs: np.ndarray, lost: np.ndarray, won: np.ndarray) -> np.ndarray:
    """`logs` of the survivors, followed by one value for each failed run.

    The true log ratio of a failed run is infinite, which no mean survives. The worst ratio that was
    observed for the filter that failed (never on its winning side of 1) stands in for it.
    """
    worst = max(logs.max(initial=0.0), 0.0)
    best = min(logs.min(initial=0.0), 0.0)
    only_numerator, only_denominator = np.sum(lost & ~won), np.sum(won & ~lost)
    neither = np.sum(lost & won)
    return np.concatenate([logs, np.full(only_numerator, worst), np.full(only_denominator, best), np.zeros(neither)])
