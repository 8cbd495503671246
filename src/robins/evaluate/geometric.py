"""Geometric means of errors over runs, and of paired ratios of two filters' errors, with 95 % two-sided intervals.

Errors that spread over decades have a mean that one run decides; their logarithms have not. From `BOOTSTRAP_RUNS` runs on an interval
is that of the percentiles of a bootstrap over runs; with fewer it is Student's t on the logarithms.
"""

from typing import NamedTuple

import numpy as np

from robins.evaluate.ensembles import BOOTSTRAP_RUNS, ENDS, multiplicities
from robins.evaluate.intervals import TIE, Interval, mean_interval, proportion_interval, with_losses


class GeometricMean(NamedTuple):
    """Errors of one filter over its runs.

    Attributes
    ----------
    estimate, low, high : float
        Geometric mean over the surviving runs with its interval; NaN and (0, inf) where there is none, (0, inf) where there is one.
    median, upper : float
        Median and 90 % quantile over all runs, a failed run's error being infinite.
    n, failed : int
        All runs, and those that failed.
    """

    estimate: float
    low: float
    high: float
    median: float
    upper: float
    n: int
    failed: int


class GeometricRatio(NamedTuple):
    """Paired ratio of two filters' errors, numerator over denominator.

    Attributes
    ----------
    estimate : float
        Geometric mean over the runs that survive in both; NaN where there is none.
    low, high : float
        Its interval, each failed run counted as a loss of the filter that failed (`robins.evaluate.intervals.with_losses`).
    better : Interval
        Share of all runs that the numerator's filter wins.
    n, survivors, numerator_failed, denominator_failed : int
    """

    estimate: float
    low: float
    high: float
    better: Interval
    n: int
    survivors: int
    numerator_failed: int
    denominator_failed: int


def mean_of_logs(logs: np.ndarray, generator: np.random.Generator, resamples: int) -> tuple[float, float]:
    """Interval of the mean of `logs` ``(runs,)``; infinitely wide with fewer than two runs, of no width where all are equal.

    Rounded to ten decimals for the reason given at `robins.evaluate.intervals.rounded_mean`.
    """
    if logs.size < 2:
        return -np.inf, np.inf
    if np.ptp(logs) < TIE:
        return float(logs.mean()), float(logs.mean())
    if logs.size < BOOTSTRAP_RUNS:
        found = mean_interval(logs)
        return float(found.low), float(found.high)
    means = np.round(multiplicities(generator, logs.size, resamples) @ logs / logs.size, 10)
    low, high = np.quantile(means, ENDS)
    return float(low), float(high)


def geometric_mean(values: np.ndarray, failed: np.ndarray, generator: np.random.Generator, resamples: int) -> GeometricMean:
    """Summary of positive errors ``(runs,)``; anything may stand in a run that `failed`.

    Raises
    ------
    ValueError
        There is no run, or a surviving run has an error that is not positive and finite.
    """
    kept = checked(values, failed)
    everyone = np.where(failed, np.inf, values)
    logs = np.log(kept)
    low, high = mean_of_logs(logs, generator, resamples)
    estimate = float(np.exp(logs.mean())) if logs.size else float("nan")
    median, upper = (float(np.quantile(everyone, q, method="inverted_cdf")) for q in (0.5, 0.9))
    return GeometricMean(estimate, float(np.exp(low)), float(np.exp(high)), median, upper, len(values), int(np.sum(failed)))


def geometric_ratio(
    numerator: np.ndarray, denominator: np.ndarray, lost: np.ndarray, won: np.ndarray, generator: np.random.Generator, resamples: int
) -> GeometricRatio:
    """Summary of ``numerator / denominator`` over paired runs ``(runs,)``; `lost` and `won` mark the runs in which either failed.

    Raises
    ------
    ValueError
        There is no run, or a surviving run has an error that is not positive and finite.
    """
    both = ~(lost | won)
    logs = np.log(checked(numerator, ~both)) - np.log(checked(denominator, ~both))
    logs[np.abs(logs) < TIE] = 0.0
    estimate = float(np.exp(logs.mean())) if logs.size else float("nan")
    low, high = mean_of_logs(with_losses(logs, lost, won), generator, resamples) if logs.size else (-np.inf, np.inf)
    wins = int(np.sum(logs < 0.0)) + int(np.sum(won & ~lost))
    n = len(numerator)
    return GeometricRatio(
        estimate, float(np.exp(low)), float(np.exp(high)), proportion_interval(wins, n), n, int(both.sum()), int(lost.sum()), int(won.sum())
    )


def checked(values: np.ndarray, left_out: np.ndarray) -> np.ndarray:
    """The values of the runs that are not `left_out`, positive and finite."""
    if len(values) == 0:
        raise ValueError("there is no run")
    kept = np.asarray(values, float)[~left_out]
    if not (np.isfinite(kept) & (kept > 0.0)).all():
        raise ValueError("a run that is not marked as failed has an error that is not positive and finite")
    return kept
