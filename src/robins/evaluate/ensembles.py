"""Ensemble values of an error and their ratios between two filters, channel by channel, with 95 % two-sided intervals.

An improvement is one minus a ratio of ensemble values over the same runs, not a mean of single-run ratios. From `BOOTSTRAP_RUNS` runs
on intervals are percentiles of a bootstrap over runs. With fewer a bootstrap is too sure of itself: intervals are then Student's t on
the standard error of a jackknife of the logarithm, and p values count exchanges of the two filters.
"""

import functools
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy import stats

from robins.evaluate.intervals import LEVEL
from robins.foundation.randomness import stream

BOOTSTRAP_RUNS = 50
"""Runs from which on percentiles of resamples are an interval."""
SWAPS = 4096
"""Random choices of `swaps`."""
ENDS = ((1 - LEVEL) / 2, (1 + LEVEL) / 2)


class Level(NamedTuple):
    """An ensemble value of one filter's error, with its 95 % interval.

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
    """Ensemble value of each channel with its interval.

    Parameters
    ----------
    values : ndarray, shape (runs, channels)
        Errors; anything in a run that failed.
    failed : ndarray of bool, shape (runs,)
    power : {1, 2}
        See `ensemble_value`.
    """
    kept = np.abs(values[~failed]) ** power
    channels = values.shape[1]
    median = np.median(np.where(failed[:, None], np.inf, np.abs(values)), axis=0)
    low, high = np.zeros(channels), np.full(channels, np.inf)
    if len(kept) == 0:
        return Level(np.full(channels, np.nan), low, high, len(values), int(failed.sum()), median)
    if len(kept) > 1:
        nothing = ~kept.any(axis=0)  # an error that is zero in every run has no logarithm
        ends = log_ends(np.where(nothing, 1.0, kept), None, power, lambda: multiplicities(generator, len(kept), resamples))
        low, high = np.where(nothing, 0.0, np.exp(ends))
    return Level(np.mean(kept, axis=0) ** (1.0 / power), low, high, len(values), int(failed.sum()), median)


def log_ends(above, below, power: int, counts: Callable, reduce: Callable = lambda logs: logs) -> tuple[np.ndarray, np.ndarray]:
    """Both ends of the interval of ``reduce(log of ensemble value)``, or of ``reduce(log of their ratio)``.

    Parameters
    ----------
    above, below : ndarray, shape (runs, channels)
        Errors to the `power`, of at least two runs; `below` None for the value itself.
    power : {1, 2}
    counts : callable
        Returns `multiplicities`; asked only from `BOOTSTRAP_RUNS` runs on.
    reduce : callable
        From logarithms (..., channels) to what is asked of them, such as means over groups of channels.

    Returns
    -------
    ndarray, ndarray
        Rounded to ten decimals for the reason given at `robins.evaluate.intervals.rounded_mean`.
    """

    def logs(totals: np.ndarray, others: np.ndarray | float) -> np.ndarray:
        return reduce(np.round(np.log(totals / others) / power, 10))

    n = len(above)
    total, other = above.sum(axis=0), n if below is None else below.sum(axis=0)
    if n < BOOTSTRAP_RUNS:
        without = logs(total - above, n - 1 if below is None else other - below)
        error = np.round(np.sqrt((n - 1) / n * np.sum(np.square(without - without.mean(axis=0)), axis=0)), 10)
        half = stats.t.ppf(ENDS[1], n - 1) * error
        return logs(total, other) - half, logs(total, other) + half
    drawn = counts()
    low, high = np.quantile(logs(drawn @ above, n if below is None else drawn @ below), ENDS, axis=0)
    return low, high


def ensemble_improvement(
    numerator: np.ndarray,
    denominator: np.ndarray,
    numerator_failed: np.ndarray,
    denominator_failed: np.ndarray,
    power: int,
    counts: np.ndarray,
) -> Improvement:
    """`Improvement` of each channel from paired runs: one minus a ratio of ensemble values, not a mean of single-run ratios.

    Interval and p value are `log_ends` and `resampled_p`, or `exchange_p` for few runs.

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
    above, below = above**power, below**power
    logs = np.round(np.log(np.mean(above, axis=0) / np.mean(below, axis=0)) / power, 10)
    estimate = -np.expm1(logs) + 0.0
    if tally[-1] < 2:
        return Improvement(estimate, np.full(channels, -np.inf), np.full(channels, np.inf), np.ones(channels), *tally)
    low, high = log_ends(above, below, power, lambda: counts)
    p = exchange_p(above, below, power) if n < BOOTSTRAP_RUNS else resampled_p(above, below, power, counts)
    return Improvement(estimate, -np.expm1(high) + 0.0, -np.expm1(low) + 0.0, p, *tally)


def resampled_p(above: np.ndarray, below: np.ndarray, power: int, counts: np.ndarray) -> np.ndarray:
    """``2 (1 + c) / (B + 1)``, at most 1, with c the smaller of the numbers of resamples at or below, and at or above, no improvement."""
    resampled = np.round(np.log((counts @ above) / (counts @ below)) / power, 10)
    rarer = np.minimum(np.sum(resampled <= 0, axis=0), np.sum(resampled >= 0, axis=0))
    return np.minimum(1.0, 2 * (1 + rarer) / (len(counts) + 1))


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
