"""Intervals around what an ensemble says. All are 95 % and two-sided.

References
----------
.. [1] E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209: the score interval of a proportion.
.. [2] B. Efron, J. Am. Stat. Assoc. 82 (1987) 171: the bias-corrected and accelerated (BCa) bootstrap.
"""

import functools
from typing import NamedTuple

import numpy as np
from scipy import stats

from robins.foundation.randomness import stream

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


class Level(NamedTuple):
    """An ensemble value of one filter's error, with its 95 % percentile bootstrap interval.

    Attributes
    ----------
    estimate, low, high : float or ndarray
        Over the surviving runs; NaN where there is none, (0, inf) with fewer than two.
    n, failed : int
        All runs, and those that failed.
    median : float or ndarray
        Median of the absolute error over all runs, a failed run's being infinite.
    """

    estimate: float | np.ndarray
    low: float | np.ndarray
    high: float | np.ndarray
    n: int
    failed: int
    median: float | np.ndarray


class Improvement(NamedTuple):
    """By how much a filter's ensemble error (numerator) is smaller than another's: ``1 - numerator / denominator``, a fraction.

    Attributes
    ----------
    estimate, low, high : float or ndarray
        With its 95 % interval over paired runs (`ensemble_improvement`), failed runs counted as losses (`with_stand_ins`); NaN
        where no run survives in both filters, an infinite interval with fewer than two.
    p : float or ndarray
        Two-sided p value of no improvement.
    n : int
        All runs, failed or not.
    numerator_failed, denominator_failed, survivors : int
        Runs that failed in either filter, and that survive in both.
    """

    estimate: float | np.ndarray
    low: float | np.ndarray
    high: float | np.ndarray
    p: float | np.ndarray
    n: int
    numerator_failed: int
    denominator_failed: int
    survivors: int


def multiplicities(generator: np.random.Generator, runs: int, resamples: int) -> np.ndarray:
    """How often each run stands in each bootstrap resample, shape (resamples, runs); the rows sum to `runs`."""
    drawn = generator.integers(0, runs, (resamples, runs)) + runs * np.arange(resamples)[:, None]
    return np.bincount(drawn.ravel(), minlength=resamples * runs).reshape(resamples, runs).astype(float)


def ensemble_value(values: np.ndarray, power: int) -> np.ndarray:
    """Mean of the absolute values over the runs (`power` 1) or their root mean square (2); `values` of shape (runs, channels)."""
    return np.mean(np.abs(values) ** power, axis=0) ** (1.0 / power)


def ensemble_level(values: np.ndarray, failed: np.ndarray, power: int, generator: np.random.Generator, resamples: int) -> Level:
    """Ensemble value of each channel with its bootstrap interval.

    Parameters
    ----------
    values : ndarray, shape (runs, channels)
        Errors; anything in a run that failed.
    failed : ndarray of bool, shape (runs,)
    power : {1, 2}
        See `ensemble_value`.
    """
    kept = np.abs(values[~failed])
    channels = values.shape[1]
    median = np.median(np.where(failed[:, None], np.inf, np.abs(values)), axis=0)
    low, high = np.zeros(channels), np.full(channels, np.inf)
    if len(kept) == 0:
        return Level(np.full(channels, np.nan), low, high, len(values), int(failed.sum()), median)
    if len(kept) > 1:
        counts = multiplicities(generator, len(kept), resamples)
        low, high = np.quantile((counts @ kept**power / len(kept)) ** (1.0 / power), [(1 - LEVEL) / 2, (1 + LEVEL) / 2], axis=0)
    return Level(ensemble_value(kept, power), low, high, len(values), int(failed.sum()), median)


BOOTSTRAP_RUNS = 50
"""Runs from which on percentiles of resamples are an interval."""

SWAPS = 4096
"""Random choices of `swaps`."""


def ensemble_improvement(
    numerator: np.ndarray,
    denominator: np.ndarray,
    numerator_failed: np.ndarray,
    denominator_failed: np.ndarray,
    power: int,
    counts: np.ndarray,
) -> Improvement:
    """`Improvement` of each channel from paired runs: one minus a ratio of ensemble values, not a mean of single-run ratios.

    The interval is that of a paired bootstrap; the p value is ``2 (1 + c) / (B + 1)``, at most 1, with c the smaller of the numbers
    of resamples at or below, and at or above, no improvement. With fewer than `BOOTSTRAP_RUNS` runs a bootstrap is too sure of itself
    (of twelve equal channels at least one is called different in 65 of 100 samples of five runs, after Holm): the interval then comes
    from `jackknife_logs`, p from `exchange_p`. Log ratios are rounded to ten decimals first, for the reason given at `rounded_mean`.

    Parameters
    ----------
    numerator, denominator : ndarray, shape (runs, channels)
        Errors of either sign, the same runs in both; anything in a run that failed.
    numerator_failed, denominator_failed : ndarray of bool, shape (runs,)
    power : {1, 2}
        See `ensemble_value`.
    counts : ndarray, shape (resamples, runs)
        From `multiplicities`. One matrix may serve every channel and measure of a pair.

    Raises
    ------
    ValueError
        A run that is not marked as failed has an error that is zero or not finite.
    """
    n, channels = numerator.shape
    both = ~(numerator_failed | denominator_failed)
    tally = n, int(numerator_failed.sum()), int(denominator_failed.sum()), int(both.sum())
    unknown = np.full(channels, np.nan)
    if not both.any():
        return Improvement(unknown, np.full(channels, -np.inf), np.full(channels, np.inf), np.ones(channels), *tally)
    above, below = with_stand_ins(np.abs(numerator), np.abs(denominator), numerator_failed, denominator_failed, power)
    logs = np.round(np.log(np.mean(above**power, axis=0) / np.mean(below**power, axis=0)) / power, 10)
    estimate = -np.expm1(logs) + 0.0
    if tally[-1] < 2:
        return Improvement(estimate, np.full(channels, -np.inf), np.full(channels, np.inf), np.ones(channels), *tally)
    if n < BOOTSTRAP_RUNS:
        low, high = jackknife_logs(above**power, below**power, power)
        p = exchange_p(above**power, below**power, power)
        return Improvement(estimate, -np.expm1(high) + 0.0, -np.expm1(low) + 0.0, p, *tally)
    resampled = np.round(np.log((counts @ above**power) / (counts @ below**power)) / power, 10)
    low, high = np.quantile(-np.expm1(resampled) + 0.0, [(1 - LEVEL) / 2, (1 + LEVEL) / 2], axis=0)
    rarer = np.minimum(np.sum(resampled <= 0, axis=0), np.sum(resampled >= 0, axis=0))
    return Improvement(estimate, low, high, np.minimum(1.0, 2 * (1 + rarer) / (len(counts) + 1)), *tally)


def jackknife_logs(above: np.ndarray, below: np.ndarray, power: int) -> tuple[np.ndarray, np.ndarray]:
    """Interval of log ratios of means by Student's t on the jackknife's standard error, ends of shape (channels,) each.

    Parameters
    ----------
    above, below : ndarray, shape (runs, channels)
        Errors to the `power`; at least two runs.
    """
    n = len(above)
    logs = np.round(np.log(above.mean(axis=0) / below.mean(axis=0)) / power, 10)
    without = np.log((above.sum(axis=0) - above) / (below.sum(axis=0) - below)) / power
    error = np.round(np.sqrt((n - 1) / n * np.sum(np.square(without - without.mean(axis=0)), axis=0)), 10)
    half = stats.t.ppf((1 + LEVEL) / 2, n - 1) * error
    return logs - half, logs + half


@functools.cache
def swaps(runs: int) -> np.ndarray:
    """Which runs exchange their two filters, shape (choices, runs) of 0 and 1: every choice up to ten runs, else `SWAPS` random ones.

    The first choice exchanges nothing.
    """
    if runs <= 10:
        return (np.arange(2**runs)[:, None] >> np.arange(runs) & 1).astype(float)
    chosen = stream(0, f"evaluate/swaps/{runs}/signs").integers(0, 2, (SWAPS, runs)).astype(float)
    chosen[0] = 0.0
    return chosen


def exchange_p(above: np.ndarray, below: np.ndarray, power: int) -> np.ndarray:
    """Two-sided p of log ratios of means if which filter made which error of a run were chance, shape (channels,).

    The share of `swaps` whose ratio is as far from one: exact for any law, and never below ``2 / 2^runs``.
    """
    moved = swaps(len(above)) @ (below - above)
    logs = np.abs(np.round(np.log((above.sum(axis=0) + moved) / (below.sum(axis=0) - moved)) / power, 10))
    return np.mean(logs >= logs[0], axis=0)


def with_stand_ins(numerator: np.ndarray, denominator: np.ndarray, lost: np.ndarray, won: np.ndarray, power: int):
    """Absolute errors, shape (runs, channels) each, with values in place of those of failed runs.

    A failed run's true error is infinite, which no mean survives. In its place stands the other filter's error in that run times
    the worst ratio that a survivor shows for the filter that failed, at least 1. Where both failed, both have the denominator's
    ensemble value: that run is won by neither. At least one run survives in both.
    """
    both = ~(lost | won)
    errors = np.concatenate([numerator[~lost], denominator[~won]])
    if not (np.isfinite(errors) & (errors > 0)).all():
        raise ValueError("a run that is not marked as failed has an error that is zero or not finite")
    ratios = numerator[both] / denominator[both]
    common = ensemble_value(denominator[both], power)
    above, below = numerator.copy(), denominator.copy()
    above[lost & ~won] = denominator[lost & ~won] * np.maximum(ratios.max(axis=0), 1.0)
    below[won & ~lost] = numerator[won & ~lost] / np.minimum(ratios.min(axis=0), 1.0)
    above[lost & won] = below[lost & won] = common
    return above, below


def holm(p_values) -> np.ndarray:
    """Holm's step-down adjusted p values of one family, shape (tests,), as `statsmodels.stats.multitest.multipletests` has them.

    That function collects garbage at every call, which in a process full of tables takes longer than all the rest of a claim.
    """
    p_values = np.asarray(p_values, float)
    order = np.argsort(p_values, kind="stable")
    adjusted = np.empty_like(p_values)
    adjusted[order] = np.minimum(1.0, np.maximum.accumulate(p_values[order] * np.arange(p_values.size, 0, -1)))
    return adjusted
